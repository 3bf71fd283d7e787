// How far a particle may go from where neighbor lists found it before they are built anew.

#ifndef LMP_SKIN_MARGINS_H
#define LMP_SKIN_MARGINS_H

#include <vector>

namespace LAMMPS_NS {

class LAMMPS;

// for each type, from 1 on: half of the neighbor skin, or the part of it that fix skin/motion gives
// to the type and sees to

std::vector<double> skin_margins(LAMMPS *);

}    // namespace LAMMPS_NS

#endif
