// Link of a membrane: repulsive below d2, harmonic to x = 1, then a line that a singularity at
// x = 1 + d2 ends, x = distance / contact length.

#include "bond_skin_stretch.h"

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

/* ---------------------------------------------------------------------- */

BondSkinStretch::BondSkinStretch(LAMMPS *lmp) :
    Bond(lmp), coeffs(nullptr), built_call(-1), built_step(-1)
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
   -dE/dr / r and forces of all links of one type; returns how many are at their singular length or
   beyond, or of no length
------------------------------------------------------------------------- */

SKIN_VECTOR static int slopes_of(int n, const double *__restrict x, const int *__restrict first,
                                 const int *__restrict second, const double *coeff,
                                 double *__restrict fbond, double *__restrict fx,
                                 double *__restrict fy, double *__restrict fz)
{
  const double d2 = coeff[3], per_contact = 1.0 / coeff[1], per_d2 = 1.0 / d2;
  const double stiffness = coeff[0] * per_contact;
  const double spring = coeff[4] * coeff[2] * per_d2 * per_d2;
  int beyond = 0;

  for (int k = 0; k < n; k++) {
    const int i = 3 * first[k], j = 3 * second[k];
    const double dx = x[i] - x[j], dy = x[i + 1] - x[j + 1], dz = x[i + 2] - x[j + 2];
    const double r = sqrt(dx * dx + dy * dy + dz * dz);
    const double s = r * per_contact;

    // argument of phi: shrinks towards both ends, 1 in between, where phi has no slope

    const double above = std::max(s - 1.0, 0.0);
    const double between = std::min(std::max(s, d2), 1.0) - d2;
    const double argument = (std::min(s, d2) - above) * per_d2;

    // one division for both 1 / argument and 1 / r

    const double reciprocal = 1.0 / (argument * r);
    const double inverse = reciprocal * r;
    const double inv3 = inverse * inverse * inverse, inv6 = inv3 * inv3;
    const double wall = (inv6 - inv6 * inv6) * inverse * per_d2;

    beyond += !(argument > 0.0);
    const double slope = -stiffness * (spring * between + (above > 0.0 ? -wall : wall)) *
        (reciprocal * argument);
    fbond[k] = slope;
    fx[k] = slope * dx;
    fy[k] = slope * dy;
    fz[k] = slope * dz;
  }
  return beyond;
}

/* ---------------------------------------------------------------------- */

void BondSkinStretch::compute(int eflag, int vflag)
{
  ev_init(eflag, vflag);
  if (built_call != neighbor->ncalls || built_step != neighbor->lastcall) list_links();

  const int nlinks = (int) fbond.size();
  if (nlinks == 0) return;
  int **bondlist = neighbor->bondlist;
  const double *const x = atom->x[0];
  double *const f = atom->f[0];

  // runs of links of one type

  for (int begin = 0, end; begin < nlinks; begin = end) {
    const int type = bondlist[begin][2];
    for (end = begin + 1; end < nlinks && bondlist[end][2] == type;) end++;
    if (slopes_of(end - begin, x, &ends[0][begin], &ends[1][begin], coeffs[type], &fbond[begin],
                  &pull[0][begin], &pull[1][begin], &pull[2][begin]))
      for (int n = begin; n < end; n++) overstretched(n);
  }

  for (int n = 0; n < nlinks; n++) {
    double *fi = f + 3 * ends[0][n], *fj = f + 3 * ends[1][n];
    for (int d = 0; d < 3; d++) {
      fi[d] += pull[d][n];
      fj[d] -= pull[d][n];
    }
  }
  if (evflag) tally();
}

/* ---------------------------------------------------------------------- */

void BondSkinStretch::tally()
{
  for (int n = 0; n < (int) fbond.size(); n++) {
    const int i = ends[0][n], j = ends[1][n];
    const double *xi = atom->x[i], *xj = atom->x[j];
    const double dx = xi[0] - xj[0], dy = xi[1] - xj[1], dz = xi[2] - xj[2];
    const double r = sqrt(dx * dx + dy * dy + dz * dz);
    const double e = eflag_either ? energy_of(neighbor->bondlist[n][2], r) : 0.0;
    ev_tally(i, j, atom->nlocal, 1, e, fbond[n], dx, dy, dz);
  }
}

/* ---------------------------------------------------------------------- */

void BondSkinStretch::list_links()
{
  const int nlinks = neighbor->nbondlist;
  fbond.resize(nlinks);
  for (auto &component : pull) component.resize(nlinks);
  for (int e = 0; e < 2; e++) {
    ends[e].resize(nlinks);
    for (int n = 0; n < nlinks; n++) ends[e][n] = neighbor->bondlist[n][e];
  }
  built_call = neighbor->ncalls;
  built_step = neighbor->lastcall;
}

/* ---------------------------------------------------------------------- */

double BondSkinStretch::energy_of(int type, double r) const
{
  const double *c = coeffs[type];
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
  for (int n = 0; n < (int) fbond.size(); n++) {
    const int i = ends[0][n], j = ends[1][n];
    const double *c = coeffs[neighbor->bondlist[n][2]], *xi = atom->x[i], *xj = atom->x[j];
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

void BondSkinStretch::overstretched(int n)
{
  const int i = ends[0][n], j = ends[1][n];
  const double *c = coeffs[neighbor->bondlist[n][2]], *xi = atom->x[i], *xj = atom->x[j];
  const double r = sqrt((xi[0] - xj[0]) * (xi[0] - xj[0]) + (xi[1] - xj[1]) * (xi[1] - xj[1]) +
                        (xi[2] - xj[2]) * (xi[2] - xj[2]));
  const double singular = c[1] * (1.0 + c[3]);
  if (r > 0.0 && r < singular) return;
  error->one(FLERR,
             "Bond skin/stretch: the link of atoms {} and {} has length {} on step {}, its "
             "singular length is {}; try a smaller timestep than {}",
             atom->tag[i], atom->tag[j], r, update->ntimestep, singular, update->dt);
}

/* ---------------------------------------------------------------------- */

void BondSkinStretch::allocate()
{
  allocated = 1;
  const int np1 = atom->nbondtypes + 1;

  memory->create(coeffs, np1, NCOEFFS, "bond:coeffs");
  memory->create(setflag, np1, "bond:setflag");
  for (int i = 1; i < np1; i++) setflag[i] = 0;
}

/* ----------------------------------------------------------------------
   set coeffs for one or more types
------------------------------------------------------------------------- */

void BondSkinStretch::coeff(int narg, char **arg)
{
  static const char *const NAMES[] = {"K", "contact length", "a2", "d2", "scale"};

  if (narg != NCOEFFS + 1)
    error->all(FLERR, "Bond style skin/stretch needs the coefficients K, contact length, a2, d2 "
               "and scale, but got {}", narg - 1);
  if (!allocated) allocate();

  int ilo, ihi;
  utils::bounds_typelabel(FLERR, arg[0], 1, atom->nbondtypes, ilo, ihi, lmp, Atom::BOND);

  double values[NCOEFFS];
  for (int k = 0; k < NCOEFFS; k++) {
    values[k] = utils::numeric(FLERR, arg[k + 1], false, lmp);
    const bool positive = (k == 1 || k == 3);
    if (!std::isfinite(values[k]) || values[k] < 0.0 || (positive && values[k] == 0.0) ||
        (k == 3 && values[k] >= 1.0))
      error->all(FLERR, "Bond style skin/stretch: {} = {} must be a number {}", NAMES[k],
                 arg[k + 1], k == 3 ? "between 0 and 1" : positive ? "> 0" : ">= 0");
  }

  for (int i = ilo; i <= ihi; i++) {
    std::copy(values, values + NCOEFFS, coeffs[i]);
    setflag[i] = 1;
  }
}

/* ---------------------------------------------------------------------- */

void BondSkinStretch::init_style()
{
  if (!force->newton_bond) error->all(FLERR, "Bond style skin/stretch needs newton on for bonds");
  built_call = built_step = -1;
}

/* ---------------------------------------------------------------------- */

double BondSkinStretch::equilibrium_distance(int i)
{
  return coeffs[i][1] * coeffs[i][3];
}

/* ---------------------------------------------------------------------- */

void BondSkinStretch::write_restart(FILE *fp)
{
  const size_t n = (size_t) NCOEFFS * atom->nbondtypes;
  if (fwrite(coeffs[1], sizeof(double), n, fp) != n)
    error->one(FLERR, "Bond skin/stretch: cannot write to the restart file: {}",
               utils::getsyserror());
}

/* ---------------------------------------------------------------------- */

void BondSkinStretch::read_restart(FILE *fp)
{
  allocate();

  const int n = NCOEFFS * atom->nbondtypes;
  if (comm->me == 0)
    utils::sfread(FLERR, coeffs[1], sizeof(double), n, fp, nullptr, error);
  MPI_Bcast(coeffs[1], n, MPI_DOUBLE, 0, world);

  for (int i = 1; i <= atom->nbondtypes; i++) setflag[i] = 1;
}

/* ---------------------------------------------------------------------- */

void BondSkinStretch::write_data(FILE *fp)
{
  for (int i = 1; i <= atom->nbondtypes; i++) {
    utils::print(fp, "{}", i);
    for (int k = 0; k < NCOEFFS; k++) utils::print(fp, " {:.17g}", coeffs[i][k]);
    utils::print(fp, "\n");
  }
}

/* ---------------------------------------------------------------------- */

double BondSkinStretch::single(int type, double rsq, int /*i*/, int /*j*/, double &fforce)
{
  const double x[6] = {sqrt(rsq), 0.0, 0.0, 0.0, 0.0, 0.0};
  const int first = 0, second = 1;
  double f[3];
  slopes_of(1, x, &first, &second, coeffs[type], &fforce, &f[0], &f[1], &f[2]);
  return energy_of(type, x[0]);
}

/* ---------------------------------------------------------------------- */

double BondSkinStretch::memory_usage()
{
  return Bond::memory_usage() +
      (double) fbond.capacity() * (4 * sizeof(double) + 2 * sizeof(int));
}
