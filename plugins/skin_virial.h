// Virial of a bonded term, whose forces add up to 0 on the particles of each rank, ghosts included:
// what they add to the sum of x f over these.

#ifndef LMP_SKIN_VIRIAL_H
#define LMP_SKIN_VIRIAL_H

namespace LAMMPS_NS {

class Atom;

// to be called with a factor of -1 before forces are added, and of 1 afterwards

void skin_add_virial(const Atom *, double factor, double *virial);

}    // namespace LAMMPS_NS

#endif
