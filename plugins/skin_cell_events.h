// What happens to cells at an event step, as records that every rank sees in the same order.

#ifndef LMP_SKIN_CELL_EVENTS_H
#define LMP_SKIN_CELL_EVENTS_H

#include "skin_cell_kinds.h"

#include "lmptype.h"

#include <mpi.h>
#include <vector>

namespace LAMMPS_NS {

struct SkinCellEvent {
  enum Kind { DEATH, GROWN, PARTNER_REMOVED, BIRTH };    // the middle two end a pair

  double time;
  double x[3];           // of the cell that dies, of the younger of a pair, of the newborn
  double mother_x[3];    // where a birth leaves the mother
  double site[3];        // a place that belongs to her rank
  int kind;
  tagint id;        // of the cell that dies, of the younger of a pair, of the mother
  tagint other;     // the other cell of its pair, 0 if none
  tagint parent;
  SkinCellKinds::Stage cell;      // kind and divisions left of the cell at x
  SkinCellKinds::Stage mother;    // what a birth makes of the mother

  bool operator<(const SkinCellEvent &) const;

  // all events of all ranks in the order of their times; equal on all ranks

  static std::vector<SkinCellEvent> gather(const std::vector<SkinCellEvent> &, MPI_Comm);
};

}    // namespace LAMMPS_NS

#endif
