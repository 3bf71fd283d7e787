#include "skin_stages.h"

using namespace LAMMPS_NS;

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
