// Link of a membrane: repulsive below d2, harmonic to x = 1, then a line that a singularity at
// x = 1 + d2 ends, x = distance / contact length.

#include "bond_skin_stretch.h"

#include "skin_quad.h"
#include "skin_remedy.h"
#include "skin_vector.h"

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

/* ----------------------------------------------------------------------
   -dE/dr / r of links with these squared lengths; adds to beyond what are at their singular length
   or beyond, or of no length
------------------------------------------------------------------------- */

template <class T> SKIN_INLINE T slope_of(const T &rsq, const double *coeff, T &beyond)
{
  const double d2 = coeff[3], per_contact = 1.0 / coeff[1], per_d2 = 1.0 / d2;
  const double stiffness = coeff[0] * per_contact;
  const double spring = coeff[4] * coeff[2] * per_d2 * per_d2;
  const T zero = {}, one = zero + 1.0, rest = zero + d2;
  const T r = root(rsq), s = r * per_contact;

  // argument of phi: shrinks towards both ends, 1 in between, where phi has no slope

  const T above = larger<T>(s - 1.0, zero);
  const T between = smaller<T>(larger<T>(s, rest), one) - d2;
  const T argument = (smaller<T>(s, rest) - above) * per_d2;

  // one division for both 1 / argument and 1 / r

  const T reciprocal = 1.0 / (argument * r);
  const T inverse = reciprocal * r;
  const T inv3 = inverse * inverse * inverse, inv6 = inv3 * inv3;
  const T wall = (inv6 - inv6 * inv6) * inverse * per_d2;

  beyond += argument > zero ? zero : one;
  return -stiffness * (spring * between + (above > zero ? -wall : wall)) *
      (reciprocal * argument);
}

/* ----------------------------------------------------------------------
   forces on the second end by the first, which is this much away
------------------------------------------------------------------------- */

template <class T>
SKIN_INLINE SkinPoint<T> force_of(const SkinPoint<T> &d, const double *coeff, T &beyond)
{
  return slope_of<T>(dot(d, d), coeff, beyond) * d;
}

/* ----------------------------------------------------------------------
   forces of the three links of one triangle, or of four
------------------------------------------------------------------------- */

template <class T>
SKIN_INLINE void pull(const SkinThreeLinks *triangle, const double *x, const double *coeff,
                      double *f, T &beyond)
{
  const int *a = triangle->data(), *b = a + 1, *c = a + 2;
  const SkinPoint<T> xa = load<T>(x, a, 3), xb = load<T>(x, b, 3), xc = load<T>(x, c, 3);
  const SkinPoint<T> fab = force_of(xb - xa, coeff, beyond);
  const SkinPoint<T> fbc = force_of(xc - xb, coeff, beyond);
  const SkinPoint<T> fca = force_of(xa - xc, coeff, beyond);
  add(f, a, 3, fca - fab);
  add(f, b, 3, fab - fbc);
  add(f, c, 3, fbc - fca);
}

/* ----------------------------------------------------------------------
   forces of one link, or of four
------------------------------------------------------------------------- */

template <class T>
SKIN_INLINE void pull(const SkinOneLink *link, const double *x, const double *coeff, double *f,
                      T &beyond)
{
  const int *a = link->data(), *b = a + 1;
  const SkinPoint<T> force = force_of(load<T>(x, b, 2) - load<T>(x, a, 2), coeff, beyond);
  add(f, a, 2, SkinPoint<T>{} - force);
  add(f, b, 2, force);
}

/* ----------------------------------------------------------------------
   forces of all, four at a time; returns how many links are at their singular length or beyond
------------------------------------------------------------------------- */

template <class LINKS>
SKIN_INLINE double pull_all(const std::vector<LINKS> &all, const double *x, const double *coeff,
                            double *f)
{
  constexpr int AHEAD = 16;
  const LINKS *const links = all.data();
  const int n = (int) all.size();
  SkinQuad four_beyond = {};
  double beyond = 0.0;
  int k = 0;
  for (; k + 4 <= n; k += 4) {
    const LINKS *const later = links + smaller(k + AHEAD, n - 4);
    for (int m = 0; m < 4; m++) {
      fetch(x, later[m][0]);
      fetch(f, later[m][0]);
    }
    pull(links + k, x, coeff, f, four_beyond);
  }
  for (; k < n; k++) pull(links + k, x, coeff, f, beyond);
  return beyond + sum(four_beyond);
}

SKIN_VECTOR static double pull_group(const SkinLinks::Group &group, const double *x,
                                     const double *coeff, double *f)
{
  return pull_all(group.threes, x, coeff, f) + pull_all(group.ones, x, coeff, f);
}

/* ---------------------------------------------------------------------- */

void BondSkinStretch::compute(int eflag, int vflag)
{
  ev_init(eflag, vflag);

  if (build.is_new(neighbor)) links.build();
  if (links.all.empty()) return;

  double beyond = 0.0;
  for (int type = 1; type <= atom->nbondtypes; type++)
    beyond += pull_group(links.of_type[type], atom->x[0], of_type(type).data(), atom->f[0]);
  if (beyond > 0.0 && sparing) broken = true;
  if (beyond > 0.0 && !sparing)
    for (int n = 0; n < (int) links.all.size(); n++) overstretched(n);
  if (evflag) tally();
}

/* ---------------------------------------------------------------------- */

void BondSkinStretch::tally()
{
  for (const auto &[i, j, type] : links.all) {
    const double *xi = atom->x[i], *xj = atom->x[j];
    const double dx = xi[0] - xj[0], dy = xi[1] - xj[1], dz = xi[2] - xj[2];
    const double rsq = dx * dx + dy * dy + dz * dz;
    double beyond = 0.0;
    const double fbond = slope_of<double>(rsq, of_type(type).data(), beyond);
    const double e = eflag_either ? energy_of(type, sqrt(rsq)) : 0.0;
    ev_tally(i, j, atom->nlocal, 1, e, fbond, dx, dy, dz);
  }
}

/* ---------------------------------------------------------------------- */

BondSkinStretch::Coefficients BondSkinStretch::of_type(int type) const
{
  Coefficients c;
  for (int k = 0; k < NCOEFFS; k++) c[k] = coeffs[k][type];
  return c;
}

/* ---------------------------------------------------------------------- */

double BondSkinStretch::energy_of(int type, double r) const
{
  const Coefficients c = of_type(type);
  const double a2 = c[2], d2 = c[3], s = r / c[1];

  double spring = 0.0, argument = 1.0;
  if (s < d2) {
    argument = s / d2;
  } else if (s <= 1.0) {
    spring = 0.5 * a2 * (s - d2) * (s - d2) / (d2 * d2);
  } else {
    spring = a2 * (1.0 - d2) / (d2 * d2) * (s - 0.5 * (1.0 + d2));
    argument = (1.0 + d2 - s) / d2;
  }
  const double inv6 = pow(argument, -6.0);
  return c[0] * (c[4] * spring + inv6 * inv6 / 12.0 - inv6 / 6.0);
}

/* ----------------------------------------------------------------------
   second derivatives d2E/dr2 of the links of the last compute(), both rows of each: a bound for
   the stiffness of a particle along its links, summed over owned and ghost particles
------------------------------------------------------------------------- */

void BondSkinStretch::add_stiffness(double *stiffness)
{
  for (const auto &[i, j, type] : links.all) {
    const Coefficients c = of_type(type);
    const double *const xi = atom->x[i], *const xj = atom->x[j];
    const double dx = xi[0] - xj[0], dy = xi[1] - xj[1], dz = xi[2] - xj[2];
    const double d2 = c[3], s = sqrt(dx * dx + dy * dy + dz * dz) / c[1];

    double second = c[4] * c[2];
    if (s < d2 || s > 1.0) {
      const double inverse = d2 / (s < d2 ? s : 1.0 + d2 - s), inv2 = inverse * inverse;
      const double inv8 = inv2 * inv2 * inv2 * inv2;
      second = 13.0 * inv8 * inv2 * inv2 * inv2 - 7.0 * inv8;
    }
    second *= 2.0 * c[0] / (d2 * d2 * c[1] * c[1]);
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
  for (int n = 0; n < (int) links.all.size(); n++) {
    const double r = length(n);
    if (!(r > 0.0 && r < singular(n))) return true;
  }
  return false;
}

/* ---------------------------------------------------------------------- */

double BondSkinStretch::length(int n) const
{
  const double *const x = atom->x[links.all[n][0]], *const y = atom->x[links.all[n][1]];
  return std::sqrt((x[0] - y[0]) * (x[0] - y[0]) + (x[1] - y[1]) * (x[1] - y[1]) +
                   (x[2] - y[2]) * (x[2] - y[2]));
}

/* ---------------------------------------------------------------------- */

double BondSkinStretch::singular(int n) const
{
  const Coefficients c = of_type(links.all[n][2]);
  return c[1] * (1.0 + c[3]);
}

/* ---------------------------------------------------------------------- */

void BondSkinStretch::overstretched(int n) const
{
  const double r = length(n), most = singular(n);
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
    const Coefficients c = of_type(i);
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
    Coefficients c;
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
  double beyond = 0.0;
  fforce = slope_of<double>(rsq, of_type(type).data(), beyond);
  return energy_of(type, sqrt(rsq));
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
