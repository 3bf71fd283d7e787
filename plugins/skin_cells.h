// The cells of this rank: which atoms they are, their kinds, their state and their time.

#ifndef LMP_SKIN_CELLS_H
#define LMP_SKIN_CELLS_H

#include "pointers.h"

#include "skin_cell_events.h"
#include "skin_cell_kinds.h"
#include "skin_cell_state.h"
#include "skin_clock.h"

#include "atom.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

class SkinCells : protected Pointers {
 public:
  static constexpr int NONE = 0;    // kind of what is no cell

  SkinCells(class LAMMPS *lmp, int groupbit) :
      Pointers(lmp), kinds(lmp), state{}, clock(lmp), known_atoms(0), groupbit(groupbit)
  {
  }

  SkinCellKinds kinds;
  SkinCellState state;
  SkinClock clock;
  std::vector<int> list;    // local indices of my cells since the last neighbor build
  bigint known_atoms;       // if no other command has made or removed any in this run
  const int groupbit;

  // of a local or ghost atom

  int kind_of(int i) const
  {
    return (atom->mask[i] & groupbit) ? kinds.of_type(atom->type[i]) : NONE;
  }
  const SkinCellKind &row_of(int i) const { return kinds[kind_of(i)]; }

  // local index of an owned or ghost atom, or of an owned one, -1 if there is none

  int local_index(tagint id) const { return id > atom->map_tag_max ? -1 : atom->map(id); }
  int owned_index(tagint id) const
  {
    const int i = local_index(id);
    return i < atom->nlocal ? i : -1;
  }

  // the arrays of the state are where they were until atoms come, go or change places

  void find_state();

  // that a cell can be what its state says

  void check(int i, bigint next_id) const;

  // whether it was found to have left the membrane

  bool detached(int i) const { return row_of(i).detaches() && state.detached_time[i] >= 0.0; }

  bool left_before(int i, double time) const
  {
    return detached(i) && clock.is_before(state.detached_time[i], time);
  }

  // what happens to a cell at a time; also whose it is and where

  SkinCellEvent event(int i, int what, double time) const;

  // what an error that ends the run recommends: no timestep is to blame where other commands have
  // made or removed atoms

  std::string remedy() const;
};

}    // namespace LAMMPS_NS

#endif
