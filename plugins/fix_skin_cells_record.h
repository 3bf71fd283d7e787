// What fix skin/cells has counted and logged so far, kept for the next one when it is unfixed. It
// lives as long as the atoms do: LAMMPS deletes it with them, as the command clear does.

#ifndef LMP_FIX_SKIN_CELLS_RECORD_H
#define LMP_FIX_SKIN_CELLS_RECORD_H

#include "fix.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

class FixSkinCellsRecord : public Fix {
 public:
  static constexpr const char *ID = "skin_cells_record";
  static constexpr const char *STYLE = "SKIN/CELLS/RECORD";    // in capitals: not for input scripts

  FixSkinCellsRecord(class LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg) {}
  int setmask() override { return 0; }

  std::vector<double> values;    // as in a restart file; none once a fix skin/cells has taken them
  std::string log;               // the event log whose length is among them
};

}    // namespace LAMMPS_NS

#endif
