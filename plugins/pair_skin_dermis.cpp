// Soft spheres of the dermis: attraction of Lennard-Jones shape to the range, a harmonic core
// below the contact length, and below d1 of it the repulsion of phi(x + 1 - d1) on top,
// x = distance / contact length.

#include "pair_skin_dermis.h"

#include "skin_vector.h"

#include "atom.h"

using namespace LAMMPS_NS;

namespace {

struct SoftSphere {
  double stiffness, per_contact, core, onset, cutsq, end = 0.0;

  explicit SoftSphere(const double *c) :
      stiffness(c[0]), per_contact(1.0 / c[1]), core(c[2]), onset(c[3]),
      cutsq(c[1] * c[1] * c[4] * c[4])
  {
    end = shape(c[4]);
  }

  template <class T> SKIN_METHOD T slope(const T &rsq) const
  {
    const T zero = {}, one = zero + 1.0, first = zero + onset;
    const T r = root(rsq), x = r * per_contact;

    // argument of phi: 1 within the core, where phi has no slope

    const T argument = larger<T>(x, one) + (smaller<T>(x, first) - onset);
    const T reciprocal = 1.0 / (argument * r);
    const T inverse = reciprocal * r, inv3 = inverse * inverse * inverse, six = inv3 * inv3;
    const T slopes = (six - six * six) * inverse + core * (smaller<T>(x, one) - 1.0);
    return rsq < cutsq ? -(stiffness * per_contact) * slopes * (reciprocal * argument) : zero;
  }

  template <class T> SKIN_METHOD T energy(const T &rsq) const
  {
    const T zero = {}, one = zero + 1.0, first = zero + onset;
    const T x = root(rsq) * per_contact, overlap = smaller<T>(x, one) - 1.0;
    const T argument = larger<T>(x, one) + (smaller<T>(x, first) - onset);
    const T energies = 0.5 * core * overlap * overlap + shape<T>(argument) - end;
    return rsq < cutsq ? stiffness * energies : zero;
  }

  template <class T> SKIN_METHOD T shape(const T &x) const
  {
    const T square = 1.0 / (x * x), six = square * square * square;
    return six * six / 12.0 - six / 6.0;
  }
};

SKIN_VECTOR double pull_all(const std::vector<SkinAtomPair> &pairs, const SoftSphere &potential,
                            const double *x, double *f)
{
  return skin_add_pair_forces(pairs, potential, x, f);
}

SKIN_VECTOR double add_all(const std::vector<SkinAtomPair> &pairs, const SoftSphere &potential,
                           const double *x)
{
  return skin_add_pair_energies(pairs, potential, x);
}

}    // namespace

/* ---------------------------------------------------------------------- */

PairSkinDermis::PairSkinDermis(LAMMPS *lmp) :
    PairSkinBase(lmp, "skin/dermis", 0.1,
             {{"K", NOT_NEGATIVE}, {"contact length", NOT_NEGATIVE}, {"a1", NOT_NEGATIVE},
              {"d1", FRACTION}, {"range", ONE_OR_MORE}})
{
}

/* ---------------------------------------------------------------------- */

double PairSkinDermis::pull(const std::vector<SkinAtomPair> &pairs, const double *coeffs)
{
  return pull_all(pairs, SoftSphere(coeffs), atom->x[0], atom->f[0]);
}

/* ---------------------------------------------------------------------- */

double PairSkinDermis::add_energies(const std::vector<SkinAtomPair> &pairs,
                                    const double *coeffs) const
{
  return add_all(pairs, SoftSphere(coeffs), atom->x[0]);
}

/* ---------------------------------------------------------------------- */

double PairSkinDermis::slope(double rsq, const double *coeffs) const
{
  return SoftSphere(coeffs).slope(rsq);
}

/* ---------------------------------------------------------------------- */

double PairSkinDermis::energy(double rsq, const double *coeffs) const
{
  return SoftSphere(coeffs).energy(rsq);
}
