// Forces between the two particles of each of many pairs, four pairs at a time.

#ifndef LMP_SKIN_TWO_H
#define LMP_SKIN_TWO_H

#include "skin_quad.h"

#include <array>
#include <vector>

namespace LAMMPS_NS {

typedef std::array<int, 2> SkinTwo;

/* ----------------------------------------------------------------------
   POTENTIAL::slope gives -dE/dr / r for a squared distance, or for four of them
------------------------------------------------------------------------- */

template <class POTENTIAL, class T>
SKIN_INLINE void skin_pull_two(const SkinTwo *two, const POTENTIAL &potential, const double *x,
                               double *f)
{
  const int *a = two->data(), *b = a + 1;
  const SkinPoint<T> d = load<T>(x, b, 2) - load<T>(x, a, 2);
  const SkinPoint<T> force = potential.template slope<T>(dot(d, d)) * d;
  add(f, a, 2, SkinPoint<T>{} - force);
  add(f, b, 2, force);
}

template <class POTENTIAL>
SKIN_INLINE void skin_pull(const std::vector<SkinTwo> &all, const POTENTIAL &potential,
                           const double *x, double *f)
{
  const int n = (int) all.size();
  int k = 0;
  for (; k + 4 <= n; k += 4)
    skin_pull_two<POTENTIAL, SkinQuad>(all.data() + k, potential, x, f);
  for (; k < n; k++) skin_pull_two<POTENTIAL, double>(all.data() + k, potential, x, f);
}

}    // namespace LAMMPS_NS

#endif
