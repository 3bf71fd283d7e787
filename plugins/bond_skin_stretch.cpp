// Links of a membrane: coefficients, files, and links that are too long. Their law stands in
// skin_stretch_forces.cpp.

#include "bond_skin_stretch.h"

#include "skin_remedy.h"
#include "skin_virial.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "force.h"
#include "memory.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

static const char *const NAMES[] = {"K", "contact length", "a2", "d2", "scale"};

/* ---------------------------------------------------------------------- */

BondSkinStretch::BondSkinStretch(LAMMPS *lmp) :
    Bond(lmp), coeffs(nullptr), links(lmp), sparing(false), broken(false)
{
  writedata = 1;
}

/* ---------------------------------------------------------------------- */

BondSkinStretch::~BondSkinStretch()
{
  if (allocated) {
    memory->destroy(setflag);
    memory->destroy(coeffs);
  }
}

/* ---------------------------------------------------------------------- */

void BondSkinStretch::compute(int eflag, int vflag)
{
  ev_init(eflag, vflag);

  if (build.is_new(neighbor)) links.build();
  if (links.all.empty()) return;

  const bool each = eflag_atom || vflag_atom;
  if (vflag_global && !each) skin_add_virial(atom, -1.0, virial);
  double beyond = 0.0;
  for (int type = 1; type <= atom->nbondtypes; type++)
    beyond += skin_stretch(links.of_type[type], atom->x[0], of_type(type), atom->f[0]);
  if (beyond > 0.0 && sparing) broken = true;
  if (beyond > 0.0 && !sparing)
    for (int n = 0; n < (int) links.all.size(); n++) overstretched(n);
  if (each) tally();
  if (vflag_global && !each) skin_add_virial(atom, 1.0, virial);
  if (eflag_global && !each)
    for (int type = 1; type <= atom->nbondtypes; type++)
      energy += skin_stretch_energies(links.of_type[type], atom->x[0], of_type(type));
}

/* ----------------------------------------------------------------------
   all that is asked for, link by link
------------------------------------------------------------------------- */

void BondSkinStretch::tally()
{
  for (const auto &[i, j, type] : links.all) {
    const double *xi = atom->x[i], *xj = atom->x[j];
    const double dx = xi[0] - xj[0], dy = xi[1] - xj[1], dz = xi[2] - xj[2];
    const double rsq = dx * dx + dy * dy + dz * dz;
    const SkinStretch c = of_type(type);
    const double fbond = skin_stretch_slope(c, rsq);
    const double e = eflag_either ? skin_stretch_energy(c, sqrt(rsq)) : 0.0;
    ev_tally(i, j, atom->nlocal, 1, e, fbond, dx, dy, dz);
  }
}

/* ---------------------------------------------------------------------- */

SkinStretch BondSkinStretch::of_type(int type) const
{
  SkinStretch c;
  for (int k = 0; k < NCOEFFS; k++) c[k] = coeffs[k][type];
  return c;
}

/* ----------------------------------------------------------------------
   second derivatives d2E/dr2 of the links of the last compute(), both rows of each: a bound for
   the stiffness of a particle along its links, summed over owned and ghost particles
------------------------------------------------------------------------- */

void BondSkinStretch::add_stiffness(double *stiffness)
{
  for (const auto &[i, j, type] : links.all) {
    const double *const xi = atom->x[i], *const xj = atom->x[j];
    const double dx = xi[0] - xj[0], dy = xi[1] - xj[1], dz = xi[2] - xj[2];
    const double r = sqrt(dx * dx + dy * dy + dz * dz);
    const double second = 2.0 * skin_stretch_curvature(of_type(type), r);
    stiffness[i] += second;
    stiffness[j] += second;
  }
}

/* ---------------------------------------------------------------------- */

void BondSkinStretch::spare_links(bool spare)
{
  sparing = spare;
  broken = false;
}

/* ----------------------------------------------------------------------
   at the current positions, also of ghosts
------------------------------------------------------------------------- */

bool BondSkinStretch::any_broken() const
{
  std::vector<double> singularsq(atom->nbondtypes + 1);
  for (int type = 1; type <= atom->nbondtypes; type++)
    singularsq[type] = singular(type) * singular(type);

  const double *const *const x = atom->x;
  bool any = false;
  for (const auto &[i, j, type] : links.all) {
    const double dx = x[i][0] - x[j][0], dy = x[i][1] - x[j][1], dz = x[i][2] - x[j][2];
    const double rsq = dx * dx + dy * dy + dz * dz;
    any |= !(rsq > 0.0 && rsq < singularsq[type]);
  }
  return any;
}

/* ---------------------------------------------------------------------- */

double BondSkinStretch::length(int n) const
{
  const double *const x = atom->x[links.all[n][0]], *const y = atom->x[links.all[n][1]];
  return std::sqrt((x[0] - y[0]) * (x[0] - y[0]) + (x[1] - y[1]) * (x[1] - y[1]) +
                   (x[2] - y[2]) * (x[2] - y[2]));
}

/* ---------------------------------------------------------------------- */

double BondSkinStretch::singular(int type) const
{
  const SkinStretch c = of_type(type);
  return c[1] * (1.0 + c[3]);
}

/* ---------------------------------------------------------------------- */

void BondSkinStretch::overstretched(int n) const
{
  const double r = length(n), most = singular(links.all[n][2]);
  if (r > 0.0 && r < most) return;
  error->one(FLERR,
             "Bond skin/stretch: the link of atoms {} and {} has length {} on step {}, its "
             "singular length is {}{}",
             atom->tag[links.all[n][0]], atom->tag[links.all[n][1]], r, update->ntimestep, most,
             skin_remedy(update, modify, false));
}

/* ---------------------------------------------------------------------- */

void BondSkinStretch::allocate()
{
  allocated = 1;
  const int np1 = atom->nbondtypes + 1;

  memory->create(coeffs, NCOEFFS, np1, "bond:coeffs");
  memory->create(setflag, np1, "bond:setflag");
  for (int i = 0; i < np1; i++) {
    setflag[i] = 0;
    for (int k = 0; k < NCOEFFS; k++) coeffs[k][i] = 0.0;
  }
}

/* ----------------------------------------------------------------------
   set coeffs for one or more types
------------------------------------------------------------------------- */

void BondSkinStretch::coeff(int narg, char **arg)
{
  if (narg != NCOEFFS + 1)
    error->all(FLERR, "Bond style skin/stretch needs the coefficients K, contact length, a2, d2 "
               "and scale, but got {}", narg - 1);
  if (!allocated) allocate();

  int ilo, ihi;
  utils::bounds_typelabel(FLERR, arg[0], 1, atom->nbondtypes, ilo, ihi, lmp, Atom::BOND);

  double values[NCOEFFS];
  for (int k = 0; k < NCOEFFS; k++) {
    values[k] = utils::numeric(FLERR, arg[k + 1], false, lmp);
    check(k, values[k], arg[k + 1]);
  }

  for (int i = ilo; i <= ihi; i++) {
    for (int k = 0; k < NCOEFFS; k++) coeffs[k][i] = values[k];
    setflag[i] = 1;
  }
}

/* ----------------------------------------------------------------------
   whether a coefficient may have this value, which was given as this text
------------------------------------------------------------------------- */

void BondSkinStretch::check(int k, double value, const std::string &text) const
{
  const bool positive = (k == 1 || k == 3);
  if (!std::isfinite(value) || value < 0.0 || (positive && value == 0.0) ||
      (k == 3 && value >= 1.0))
    error->all(FLERR, "Bond style skin/stretch: {} = {} must be a number {}", NAMES[k], text,
               k == 3 ? "between 0 and 1" : positive ? "> 0" : ">= 0");
}

/* ---------------------------------------------------------------------- */

void BondSkinStretch::init_style()
{
  if (!force->newton_bond) error->all(FLERR, "Bond style skin/stretch needs newton on for bonds");
  build.forget();
}

/* ---------------------------------------------------------------------- */

double BondSkinStretch::equilibrium_distance(int i)
{
  return coeffs[1][i] * coeffs[3][i];
}

/* ---------------------------------------------------------------------- */

void BondSkinStretch::write_restart(FILE *fp)
{
  for (int i = 1; i <= atom->nbondtypes; i++) {
    const SkinStretch c = of_type(i);
    if (fwrite(c.data(), sizeof(double), NCOEFFS, fp) != NCOEFFS)
      error->one(FLERR, "Bond skin/stretch: cannot write to the restart file: {}",
                 utils::getsyserror());
  }
}

/* ---------------------------------------------------------------------- */

void BondSkinStretch::read_restart(FILE *fp)
{
  allocate();

  for (int i = 1; i <= atom->nbondtypes; i++) {
    SkinStretch c;
    if (comm->me == 0)
      utils::sfread(FLERR, c.data(), sizeof(double), NCOEFFS, fp, nullptr, error);
    MPI_Bcast(c.data(), NCOEFFS, MPI_DOUBLE, 0, world);
    for (int k = 0; k < NCOEFFS; k++) coeffs[k][i] = c[k];
    setflag[i] = 1;
  }
}

/* ---------------------------------------------------------------------- */

void BondSkinStretch::write_data(FILE *fp)
{
  for (int i = 1; i <= atom->nbondtypes; i++) {
    utils::print(fp, "{}", i);
    for (int k = 0; k < NCOEFFS; k++) utils::print(fp, " {:.17g}", coeffs[k][i]);
    utils::print(fp, "\n");
  }
}

/* ---------------------------------------------------------------------- */

double BondSkinStretch::single(int type, double rsq, int /*i*/, int /*j*/, double &fforce)
{
  const SkinStretch c = of_type(type);
  fforce = skin_stretch_slope(c, rsq);
  return skin_stretch_energy(c, sqrt(rsq));
}

/* ----------------------------------------------------------------------
   a coefficient by the first word of its name, for commands that change it
------------------------------------------------------------------------- */

void *BondSkinStretch::extract(const char *which, int &dim)
{
  dim = 1;
  for (int k = 0; k < NCOEFFS; k++) {
    const std::string name = NAMES[k];
    if (name.substr(0, name.find(' ')) == which) return coeffs[k];
  }
  return nullptr;
}

/* ----------------------------------------------------------------------
   after such a change; in a hybrid style other types have no coefficients here
------------------------------------------------------------------------- */

void BondSkinStretch::reinit()
{
  for (int i = 1; i <= atom->nbondtypes; i++)
    for (int k = 0; k < NCOEFFS; k++)
      if (setflag[i]) check(k, coeffs[k][i], fmt::format("{}", coeffs[k][i]));
}

/* ---------------------------------------------------------------------- */

double BondSkinStretch::memory_usage()
{
  return Bond::memory_usage() + links.memory_usage();
}
