#include "skin_stages.h"

#include "skin_double4.h"
#include "skin_vector.h"

using namespace LAMMPS_NS;

/* ----------------------------------------------------------------------
   what is no number stays in sums
------------------------------------------------------------------------- */

template <class T>
SKIN_INLINE void advance(const SkinStage &c, double time, int n, double *x, double *before,
                         const double *start, const double *f, T &most, T &sum)
{
  const T zero = {}, old = load_row<T>(x + n);
  const T next = c.previous * old + c.before * load_row<T>(before + n) +
      time * c.force * load_row<T>(f + n);
  const T way = next - load_row<T>(start + n);
  store_row(before + n, old);
  store_row(x + n, next);
  most = larger<T>(most, way * way);
  sum += zero * way;
}

/* ----------------------------------------------------------------------
   shifted Legendre polynomials of degree s; one stage is forward Euler
------------------------------------------------------------------------- */

SkinStages SkinStages::first_order(int s)
{
  const double reach = s * s + s, w = 2.0 / reach;
  SkinStages method = {{{1.0, 0.0, 0.0, w, 0.0, w}}, reach};
  for (int j = 2; j <= s; j++) {
    const double mu = (2.0 * j - 1.0) / j, nu = (1.0 - j) / j;
    method.stages.push_back({mu, nu, 0.0, mu * w, 0.0, (j * j + j) / reach});
  }
  return method;
}

/* ---------------------------------------------------------------------- */

SkinStages SkinStages::second_order(int s)
{
  const double reach = 0.5 * (s * s + s - 2), w = 2.0 / reach;
  std::vector<double> b(s + 1, 1.0 / 3.0);
  for (int j = 3; j <= s; j++) b[j] = (j * j + j - 2.0) / (2.0 * j * (j + 1.0));

  SkinStages method = {{{1.0, 0.0, 0.0, b[1] * w, 0.0, b[1] * w}}, reach, 2};
  for (int j = 2; j <= s; j++) {
    const double mu = (2.0 * j - 1.0) / j * b[j] / b[j - 1];
    const double nu = (1.0 - j) / j * b[j] / b[j - 2];
    const double force = mu * w, first = (b[j - 1] - 1.0) * force;
    method.stages.push_back(
        {mu, nu, 1.0 - mu - nu, force, first, (j * j + j - 2.0) / (s * s + s - 2.0)});
  }
  return method;
}

/* ---------------------------------------------------------------------- */

SKIN_VECTOR static double advance_all(const SkinStage &c, double time, int n, double *x,
                                      double *before, const double *start, const double *f)
{
  SkinDouble4 four_most = {}, four_sums = {};
  double most = 0.0, zeros = 0.0;
  int k = 0;
  for (; k + 4 <= n; k += 4) advance(c, time, k, x, before, start, f, four_most, four_sums);
  for (; k < n; k++) advance(c, time, k, x, before, start, f, most, zeros);
  for (int m = 0; m < 4; m++) most = larger(most, four_most[m]);
  return zeros + sum(four_sums) == 0.0 ? most : INFINITY;
}

/* ---------------------------------------------------------------------- */

double LAMMPS_NS::skin_advance(const SkinStage &c, double time, int n, double *x, double *before,
                               const double *start, const double *f)
{
  return advance_all(c, time, n, x, before, start, f);
}
