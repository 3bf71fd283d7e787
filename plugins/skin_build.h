// Whether neighbor lists have been built since the last look. Counts of builds begin anew with each
// run, so that what is kept of them must be forgotten in init().

#ifndef LMP_SKIN_BUILD_H
#define LMP_SKIN_BUILD_H

#include "neighbor.h"

namespace LAMMPS_NS {

class SkinBuild {
 public:
  bool is_new(const Neighbor *neighbor)
  {
    if (call == neighbor->ncalls && step == neighbor->lastcall) return false;
    call = neighbor->ncalls;
    step = neighbor->lastcall;
    return true;
  }

  void forget() { call = step = -1; }

 private:
  bigint call = -1, step = -1;
};

}    // namespace LAMMPS_NS

#endif
