// What an error that ends a run recommends: a smaller timestep, unless the fault was there before
// any step was made, or fix move takes particles where it is told to. A minimisation has none.

#ifndef LMP_SKIN_REMEDY_H
#define LMP_SKIN_REMEDY_H

#include "fix_skin_motion.h"

#include "modify.h"
#include "update.h"
#include "utils.h"

#include <string>

namespace LAMMPS_NS {

inline std::string skin_remedy(const Update *update, Modify *modify, bool at_start)
{
  if (update->whichflag != 1) return "";
  bool dragged = false;
  for (Fix *fix : modify->get_fix_list())
    if (!fix)
      continue;
    else if (const auto *const motion = dynamic_cast<FixSkinMotion *>(fix))
      at_start = at_start || motion->begins_disturbed();
    else if (utils::strmatch(fix->style, "^move"))
      dragged = true;
  if (update->setupflag || at_start) return "; the state that this run began with is like that";
  return dragged ? "" : fmt::format("; try a smaller timestep than {}", update->dt);
}

}    // namespace LAMMPS_NS

#endif
