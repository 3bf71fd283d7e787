// What an error that ends a run recommends: a smaller timestep, unless the fault was there before
// any step was made. A minimisation has none.

#ifndef LMP_SKIN_REMEDY_H
#define LMP_SKIN_REMEDY_H

#include "update.h"

#include <string>

namespace LAMMPS_NS {

inline std::string skin_remedy(const Update *update, bool at_start)
{
  if (update->whichflag != 1) return "";
  if (update->setupflag || at_start) return "; the state that this run began with is like that";
  return fmt::format("; try a smaller timestep than {}", update->dt);
}

}    // namespace LAMMPS_NS

#endif
