#include "skin_margins.h"

#include "fix_skin_motion.h"

#include "atom.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;

/* ----------------------------------------------------------------------
   in a minimization fix skin/motion has no say
------------------------------------------------------------------------- */

std::vector<double> LAMMPS_NS::skin_margins(LAMMPS *lmp)
{
  std::vector<double> parts(lmp->atom->ntypes + 1, 1.0);
  if (lmp->update->whichflag == 1)
    for (Fix *fix : lmp->modify->get_fix_by_style("^skin/motion$")) {
      const std::vector<double> &theirs = ((const FixSkinMotion *) fix)->margins;
      for (size_t type = 0; type < theirs.size(); type++)
        parts[type] = std::min(parts[type], theirs[type]);
    }
  for (double &part : parts) part *= 0.5 * lmp->neighbor->skin;
  return parts;
}
