#include "skin_virial.h"

#include "atom.h"

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

void LAMMPS_NS::skin_add_virial(const Atom *atom, double factor, double *virial)
{
  double sums[6] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  for (int i = 0; i < atom->nlocal + atom->nghost; i++) {
    const double *const x = atom->x[i], *const f = atom->f[i];
    const double each[6] = {x[0] * f[0], x[1] * f[1], x[2] * f[2],
                            x[1] * f[0], x[2] * f[0], x[2] * f[1]};
    for (int k = 0; k < 6; k++) sums[k] += each[k];
  }
  for (int k = 0; k < 6; k++) virial[k] += factor * sums[k];
}
