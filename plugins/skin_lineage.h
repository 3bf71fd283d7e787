// Who was born and who has left: the IDs that were given, the numbers of births and deaths, and the
// event log. They outlive restarts, and a fix skin/cells that is given anew.

#ifndef LMP_SKIN_LINEAGE_H
#define LMP_SKIN_LINEAGE_H

#include "pointers.h"

#include "skin_cell_events.h"
#include "skin_event_log.h"
#include "skin_interventions.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

class SkinLineage : protected Pointers {
 public:
  SkinLineage(class LAMMPS *lmp, const SkinCellKinds &kinds, SkinInterventions &interventions) :
      Pointers(lmp), log(lmp), kinds(kinds), interventions(interventions)
  {
  }

  bigint next_id = 0;    // of a newborn; may be one more than an ID can be
  bigint births = 0, deaths = 0;
  SkinEventLog log;

  // no ID is used twice, also not those of the dead, nor those that other commands give

  void skip_used_ids();
  tagint new_id();

  // go on with the log where a restart file or an earlier fix has left it

  void open_log() { log.open(log_position); }
  void write(const SkinCellEvent &, const char *kind, tagint id, tagint parent,
             const std::string &cause);

  // what a restart file holds

  std::vector<double> to_restart();
  void from_restart(const char *);

  // what the next fix takes from the one before

  void take_record();
  void leave_record();

 private:
  static constexpr int NSTORED = 6;    // values in a restart file, of which the first is this:
  static constexpr double RESTART_FORMAT = -2.0;
  static constexpr double WITHOUT_INTERVENTIONS = -1.0;    // the format before, without the last

  const SkinCellKinds &kinds;
  SkinInterventions &interventions;    // those that have happened do not happen again
  bigint log_position = -1;    // where the log stood when the restart file was written, or -1

  std::vector<double> values(bigint position) const;
  void go_on(const double *);
  class FixSkinCellsRecord *find_record() const;
};

}    // namespace LAMMPS_NS

#endif
