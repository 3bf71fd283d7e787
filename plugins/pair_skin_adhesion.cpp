// Adhesion: K (s^2/2 - s^4/(4 w^2) - w^2/4) with s = x - 1 from 0 to w = range - 1,
// x = distance / contact length; constant below the contact length, 0 beyond the range.

#include "pair_skin_adhesion.h"

#include "skin_vector.h"

#include "atom.h"

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

  template <class T> SKIN_METHOD T energy(const T &rsq) const
  {
    const T zero = {}, most = zero + width;
    const T r = root(rsq);
    const T s = smaller<T>(larger<T>(r * per_contact - 1.0, zero), most), ssq = s * s;
    const T energies = 0.5 * ssq - 0.25 * quartic * ssq * ssq - 0.25 * width * width;
    return s < most ? stiffness * energies : zero;
  }
};

SKIN_VECTOR double pull_all(const std::vector<SkinAtomPair> &pairs, const Adhesion &potential,
                            const double *x, double *f)
{
  return skin_add_pair_forces(pairs, potential, x, f);
}

SKIN_VECTOR double add_all(const std::vector<SkinAtomPair> &pairs, const Adhesion &potential,
                           const double *x)
{
  return skin_add_pair_energies(pairs, potential, x);
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

double PairSkinAdhesion::add_energies(const std::vector<SkinAtomPair> &pairs,
                                      const double *coeffs) const
{
  return add_all(pairs, Adhesion(coeffs), atom->x[0]);
}

/* ---------------------------------------------------------------------- */

double PairSkinAdhesion::slope(double rsq, const double *coeffs) const
{
  return Adhesion(coeffs).slope(rsq);
}

/* ---------------------------------------------------------------------- */

double PairSkinAdhesion::energy(double rsq, const double *coeffs) const
{
  return Adhesion(coeffs).energy(rsq);
}
