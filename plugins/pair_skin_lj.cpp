// Lennard-Jones shape, cut and shifted: E = K (phi(x) - phi(range)), phi(x) = x^-12/12 - x^-6/6,
// x = distance / contact length.

#include "pair_skin_lj.h"

#include "skin_vector.h"

#include "atom.h"

using namespace LAMMPS_NS;

namespace {

struct LennardJones {
  double stiffness, contactsq, cutsq, end = 0.0;

  explicit LennardJones(const double *c) :
      stiffness(c[0]), contactsq(c[1] * c[1]), cutsq(c[1] * c[1] * c[2] * c[2])
  {
    end = shape(cutsq);
  }

  template <class T> SKIN_METHOD T slope(const T &rsq) const
  {
    const T inverse = 1.0 / rsq, square = contactsq * inverse;
    const T six = square * square * square, zero = {};
    return rsq < cutsq ? stiffness * (six * six - six) * inverse : zero;
  }

  template <class T> SKIN_METHOD T energy(const T &rsq) const
  {
    const T zero = {};
    return rsq < cutsq ? stiffness * (shape<T>(rsq) - end) : zero;
  }

  template <class T> SKIN_METHOD T shape(const T &rsq) const
  {
    const T square = contactsq / rsq, six = square * square * square;
    return six * six / 12.0 - six / 6.0;
  }
};

SKIN_VECTOR double pull_all(const std::vector<SkinAtomPair> &pairs, const LennardJones &potential,
                            const double *x, double *f)
{
  return skin_add_pair_forces(pairs, potential, x, f);
}

SKIN_VECTOR double add_all(const std::vector<SkinAtomPair> &pairs, const LennardJones &potential,
                           const double *x)
{
  return skin_add_pair_energies(pairs, potential, x);
}

}    // namespace

/* ---------------------------------------------------------------------- */

PairSkinLJ::PairSkinLJ(LAMMPS *lmp) :
    PairSkinBase(lmp, "skin/lj", 0.3,
             {{"K", NOT_NEGATIVE}, {"contact length", NOT_NEGATIVE}, {"range", ONE_OR_MORE}})
{
}

/* ---------------------------------------------------------------------- */

double PairSkinLJ::pull(const std::vector<SkinAtomPair> &pairs, const double *coeffs)
{
  return pull_all(pairs, LennardJones(coeffs), atom->x[0], atom->f[0]);
}

/* ---------------------------------------------------------------------- */

double PairSkinLJ::add_energies(const std::vector<SkinAtomPair> &pairs, const double *coeffs) const
{
  return add_all(pairs, LennardJones(coeffs), atom->x[0]);
}

/* ---------------------------------------------------------------------- */

double PairSkinLJ::slope(double rsq, const double *coeffs) const
{
  return LennardJones(coeffs).slope(rsq);
}

/* ---------------------------------------------------------------------- */

double PairSkinLJ::energy(double rsq, const double *coeffs) const
{
  return LennardJones(coeffs).energy(rsq);
}
