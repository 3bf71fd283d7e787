// No force: ends the run where two particles are closer than their core, for other pair styles that
// would go on, or end with an error that names nobody.

#include "pair_skin_core.h"

#include "atom.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

PairSkinCore::PairSkinCore(LAMMPS *lmp) :
    PairSkinBase(lmp, "skin/core", 1.0,
             {{"core", FRACTION}, {"contact length", NOT_NEGATIVE}, {"first core", NOT_NEGATIVE}})
{
}

/* ----------------------------------------------------------------------
   at once: the next sub-style may not survive it
------------------------------------------------------------------------- */

void PairSkinCore::compute(int eflag, int vflag)
{
  PairSkinBase::compute(eflag, vflag);
  check_overlap();
}

/* ---------------------------------------------------------------------- */

double PairSkinCore::pull(const std::vector<SkinAtomPair> &pairs, const double * /*coeffs*/)
{
  double least = INFINITY;
  for (const auto &[i, j] : pairs) {
    const double *const x = atom->x[i], *const y = atom->x[j];
    const double dx = x[0] - y[0], dy = x[1] - y[1], dz = x[2] - y[2];
    least = std::min(least, dx * dx + dy * dy + dz * dz);
  }
  return least;
}

/* ---------------------------------------------------------------------- */

double PairSkinCore::add_energies(const std::vector<SkinAtomPair> & /*pairs*/,
                                  const double * /*coeffs*/) const
{
  return 0.0;
}

/* ---------------------------------------------------------------------- */

double PairSkinCore::slope(double /*rsq*/, const double * /*coeffs*/) const
{
  return 0.0;
}

/* ---------------------------------------------------------------------- */

double PairSkinCore::energy(double /*rsq*/, const double * /*coeffs*/) const
{
  return 0.0;
}

/* ---------------------------------------------------------------------- */

double PairSkinCore::range(const double *coeffs) const
{
  return std::max(coeffs[0], coeffs[2]) * coeffs[1];
}

/* ---------------------------------------------------------------------- */

double PairSkinCore::closest(const double *coeffs) const
{
  return (update->setupflag ? coeffs[2] : coeffs[0]) * coeffs[1];
}
