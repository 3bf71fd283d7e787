// Forces between the two particles of each of many pairs, four pairs at a time; their energy.

#ifndef LMP_SKIN_PAIR_FORCES_H
#define LMP_SKIN_PAIR_FORCES_H

#include "skin_double4.h"

#include <array>
#include <cmath>
#include <vector>

namespace LAMMPS_NS {

typedef std::array<int, 2> SkinAtomPair;

/* ----------------------------------------------------------------------
   forces on points that are this far from another one, for each of which POTENTIAL::slope gives
   -dE/dr / r for a squared distance, or for four of them
------------------------------------------------------------------------- */

template <class POTENTIAL, class T>
SKIN_INLINE SkinPoint<T> skin_pair_force(const POTENTIAL &potential, const SkinPoint<T> &d,
                                         T &least)
{
  const T rsq = dot(d, d);
  least = smaller<T>(least, rsq);
  return potential.template slope<T>(rsq) * d;
}

template <class POTENTIAL, class T>
SKIN_INLINE void skin_add_pair_force(const SkinAtomPair *two, const POTENTIAL &potential,
                                     const double *x, double *f, T &least)
{
  const int *a = two->data(), *b = a + 1;
  const SkinPoint<T> d = load<T>(x, b, 2) - load<T>(x, a, 2);
  const SkinPoint<T> force = skin_pair_force(potential, d, least);
  add(f, a, 2, SkinPoint<T>{} - force);
  add(f, b, 2, force);
}

/* ----------------------------------------------------------------------
   returns the least of the squared distances. The first of pairs mostly stays the same for some
   while, in which the forces on it are summed; the second is anywhere
------------------------------------------------------------------------- */

template <class POTENTIAL>
SKIN_INLINE double skin_add_pair_forces(const std::vector<SkinAtomPair> &all,
                                        const POTENTIAL &potential, const double *x, double *f)
{
  constexpr int AHEAD = 32;
  const int n = (int) all.size();
  double least = INFINITY;
  SkinDouble4 four_least = SkinDouble4{} + least;
  int center = n ? all[0][0] : 0;
  SkinPoint<SkinDouble4> place = {}, sums = {};
  if (n) place = spread(load<double>(x, &center, 1));
  int k = 0;
  for (; k + 4 <= n; k += 4) {
    const SkinAtomPair *const four = all.data() + k;
    const SkinAtomPair *const later = all.data() + smaller(k + AHEAD, n - 4);
    for (int m = 0; m < 4; m++) {
      fetch(x, later[m][1]);
      fetch(f, later[m][1]);
    }
    const int first = four[0][0];
    if ((first != four[1][0]) | (first != four[2][0]) | (first != four[3][0])) {
      skin_add_pair_force<POTENTIAL, SkinDouble4>(four, potential, x, f, four_least);
      continue;
    }
    if (first != center) {
      add(f, &center, 1, sum(sums));
      center = first;
      place = spread(load<double>(x, &center, 1));
      sums = SkinPoint<SkinDouble4>{};
    }
    const int *const b = four->data() + 1;
    const SkinPoint<SkinDouble4> d = load<SkinDouble4>(x, b, 2) - place;
    const SkinPoint<SkinDouble4> force = skin_pair_force(potential, d, four_least);
    add(f, b, 2, force);
    sums = sums - force;
  }
  if (n) add(f, &center, 1, sum(sums));
  for (; k < n; k++) skin_add_pair_force<POTENTIAL, double>(all.data() + k, potential, x, f, least);
  for (int m = 0; m < 4; m++) least = smaller(least, four_least[m]);
  return least;
}

/* ----------------------------------------------------------------------
   POTENTIAL::energy is that for a squared distance, or for four of them
------------------------------------------------------------------------- */

template <class POTENTIAL>
SKIN_INLINE double skin_add_pair_energies(const std::vector<SkinAtomPair> &all,
                                          const POTENTIAL &potential, const double *x)
{
  const int n = (int) all.size();
  SkinDouble4 four_sums = {};
  double one_sum = 0.0;
  int k = 0;
  for (; k + 4 <= n; k += 4) {
    const int *const a = all[k].data();
    const SkinPoint<SkinDouble4> d = load<SkinDouble4>(x, a + 1, 2) - load<SkinDouble4>(x, a, 2);
    four_sums += potential.template energy<SkinDouble4>(dot(d, d));
  }
  for (; k < n; k++) {
    const int *const a = all[k].data();
    const SkinPoint<double> d = load<double>(x, a + 1, 2) - load<double>(x, a, 2);
    one_sum += potential.template energy<double>(dot(d, d));
  }
  return sum(four_sums) + one_sum;
}

}    // namespace LAMMPS_NS

#endif
