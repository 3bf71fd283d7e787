// Stretch of links: repulsive below d2, harmonic to x = 1, then a line that a singularity at
// x = 1 + d2 ends, x = distance / contact length.

#include "skin_stretch_forces.h"

#include "skin_double4.h"
#include "skin_vector.h"

#include <cmath>

using namespace LAMMPS_NS;

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
  SkinDouble4 four_beyond = {};
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

SKIN_VECTOR static double stretch_group(const SkinLinks::Group &group, const double *x,
                                        const double *coeff, double *f)
{
  return pull_all(group.threes, x, coeff, f) + pull_all(group.ones, x, coeff, f);
}

/* ---------------------------------------------------------------------- */

double LAMMPS_NS::skin_stretch(const SkinLinks::Group &group, const double *x,
                               const SkinStretch &c, double *f)
{
  return stretch_group(group, x, c.data(), f);
}

/* ---------------------------------------------------------------------- */

double LAMMPS_NS::skin_stretch_slope(const SkinStretch &c, double rsq)
{
  double beyond = 0.0;
  return slope_of<double>(rsq, c.data(), beyond);
}

/* ----------------------------------------------------------------------
   energy of links that reach this far
------------------------------------------------------------------------- */

template <class T> SKIN_INLINE T energy_of(const SkinPoint<T> &d, const double *coeff)
{
  const double d2 = coeff[3], per_contact = 1.0 / coeff[1], per_d2 = 1.0 / d2;
  const T zero = {}, one = zero + 1.0, rest = zero + d2;
  const T s = root(dot(d, d)) * per_contact, above = larger<T>(s - 1.0, zero);
  const T between = smaller<T>(larger<T>(s, rest), one) - d2;
  const T spring = coeff[2] * per_d2 * per_d2 * between * (0.5 * between + above);
  const T inverse = d2 / (smaller<T>(s, rest) - above);
  const T inv3 = inverse * inverse * inverse, inv6 = inv3 * inv3;
  return coeff[0] * (coeff[4] * spring + inv6 * (inv6 / 12.0 - 1.0 / 6.0));
}

template <class T>
SKIN_INLINE T energy_of(const SkinThreeLinks *triangle, const double *x, const double *coeff)
{
  const int *a = triangle->data();
  const SkinPoint<T> xa = load<T>(x, a, 3), xb = load<T>(x, a + 1, 3), xc = load<T>(x, a + 2, 3);
  return energy_of(xb - xa, coeff) + energy_of(xc - xb, coeff) + energy_of(xa - xc, coeff);
}

template <class T>
SKIN_INLINE T energy_of(const SkinOneLink *link, const double *x, const double *coeff)
{
  const int *a = link->data();
  return energy_of(load<T>(x, a + 1, 2) - load<T>(x, a, 2), coeff);
}

template <class LINKS>
SKIN_INLINE double energy_of_all(const std::vector<LINKS> &all, const double *x,
                                 const double *coeff)
{
  const int n = (int) all.size();
  SkinDouble4 four_sums = {};
  double one_sum = 0.0;
  int k = 0;
  for (; k + 4 <= n; k += 4) four_sums += energy_of<SkinDouble4>(all.data() + k, x, coeff);
  for (; k < n; k++) one_sum += energy_of<double>(all.data() + k, x, coeff);
  return one_sum + sum(four_sums);
}

SKIN_VECTOR static double energy_of_group(const SkinLinks::Group &group, const double *x,
                                          const double *coeff)
{
  return energy_of_all(group.threes, x, coeff) + energy_of_all(group.ones, x, coeff);
}

/* ---------------------------------------------------------------------- */

double LAMMPS_NS::skin_stretch_energies(const SkinLinks::Group &group, const double *x,
                                        const SkinStretch &c)
{
  return energy_of_group(group, x, c.data());
}

/* ---------------------------------------------------------------------- */

double LAMMPS_NS::skin_stretch_energy(const SkinStretch &c, double r)
{
  return energy_of(SkinPoint<double>{r, 0.0, 0.0}, c.data());
}

/* ---------------------------------------------------------------------- */

double LAMMPS_NS::skin_stretch_curvature(const SkinStretch &c, double r)
{
  const double d2 = c[3], s = r / c[1];
  double second = c[4] * c[2];
  if (s < d2 || s > 1.0) {
    const double inverse = d2 / (s < d2 ? s : 1.0 + d2 - s), inv2 = inverse * inverse;
    const double inv8 = inv2 * inv2 * inv2 * inv2;
    second = 13.0 * inv8 * inv2 * inv2 * inv2 - 7.0 * inv8;
  }
  return second * (c[0] / (d2 * d2 * c[1] * c[1]));
}
