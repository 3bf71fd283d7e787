// The time that cells have: that of the step or of a stage within it, and in a minimisation, whose
// iterations are no time, that of its start.

#ifndef LMP_SKIN_CLOCK_H
#define LMP_SKIN_CLOCK_H

#include "pointers.h"

#include "update.h"

namespace LAMMPS_NS {

class SkinClock : protected Pointers {
 public:
  explicit SkinClock(class LAMMPS *lmp) : Pointers(lmp), start(0.0), offset(0.0) {}

  double time_of_step(bigint step) const
  {
    return update->atime + (double) (step - update->atimestep) * update->dt;
  }

  double now() const
  {
    return update->whichflag == 2 ? start : time_of_step(update->ntimestep) + offset;
  }

  // whatever the rounding of times

  bool is_before(double time, double other) const { return time < other - 1.0e-9 * update->dt; }

  // a run or a minimisation begins

  void begin() { start = time_of_step(update->ntimestep); }

  // restart files of a minimisation have the time of its start

  void stand_still()
  {
    update->atime = start;
    update->atimestep = update->ntimestep;
  }

  // until the next call it is this time, counted from the end of the step

  void set_within_step(double time) { offset = time; }
  bool is_within_step() const { return offset != 0.0; }

 private:
  double start, offset;
};

}    // namespace LAMMPS_NS

#endif
