// Adhesion: K (s^2/2 - s^4/(4 w^2) - w^2/4) with s = x - 1 from 0 to w = range - 1,
// x = distance / contact length; constant below the contact length, 0 beyond the range.

#include "pair_skin_adhesion.h"

#include "skin_vector.h"

#include "atom.h"

#include <algorithm>

using namespace LAMMPS_NS;

namespace {

struct Adhesion {
  double stiffness, per_contact, width, quartic;

  explicit Adhesion(const double *c) :
      stiffness(c[0]), per_contact(1.0 / c[1]), width(c[2] - 1.0),
      quartic(width > 0.0 ? 1.0 / (width * width) : 0.0)
  {
  }

  template <class T> SKIN_METHOD T slope(const T &rsq) const
  {
    const T zero = {}, most = zero + width;
    const T r = root(rsq);
    const T s = smaller<T>(larger<T>(r * per_contact - 1.0, zero), most);
    const T slopes = s * (1.0 - quartic * s * s);
    return (s > zero) & (s < most) ? -(stiffness * per_contact) * slopes / r : zero;
  }
};

SKIN_VECTOR double pull_all(const std::vector<SkinAtomPair> &pairs, const Adhesion &potential,
                            const double *x, double *f)
{
  return skin_add_pair_forces(pairs, potential, x, f);
}

}    // namespace

/* ---------------------------------------------------------------------- */

PairSkinAdhesion::PairSkinAdhesion(LAMMPS *lmp) :
    PairSkinBase(lmp, "skin/adhesion", 0.0,
             {{"K", NOT_NEGATIVE}, {"contact length", NOT_NEGATIVE}, {"range", ONE_OR_MORE}})
{
}

/* ---------------------------------------------------------------------- */

double PairSkinAdhesion::pull(const std::vector<SkinAtomPair> &pairs, const double *coeffs)
{
  return pull_all(pairs, Adhesion(coeffs), atom->x[0], atom->f[0]);
}

/* ---------------------------------------------------------------------- */

double PairSkinAdhesion::slope(double rsq, const double *coeffs) const
{
  return Adhesion(coeffs).slope(rsq);
}

/* ---------------------------------------------------------------------- */

double PairSkinAdhesion::energy(double r, const double *coeffs) const
{
  const Adhesion adhesion(coeffs);
  const double w = adhesion.width, s = std::clamp(r / coeffs[1] - 1.0, 0.0, w);
  return coeffs[0] * (0.5 * s * s - 0.25 * adhesion.quartic * s * s * s * s - 0.25 * w * w);
}
