// The state that each cell carries: custom per-atom properties of fix property/atom, which
// migrates them and writes them to restart and data files.

#ifndef LMP_SKIN_CELL_STATE_H
#define LMP_SKIN_CELL_STATE_H

#include "atom.h"

#include <string>

namespace LAMMPS_NS {

struct SkinCellState {
  // what fix property/atom must have been told to store

  static constexpr const char *PROPERTIES =
      "i_divisions_left i_divisions_done i_parent i_pair "
      "d_next_division d_birth_time d_pair_start d_detached_time";

  static constexpr double NEVER = -1.0;    // no division scheduled; not detached

  int *divisions_left;        // m of a TA cell; M for a stem cell
  int *divisions_done;        // also counts the random events of this cell
  int *parent;                // id of the mother, 0 for the first cells
  int *pair;                  // id of the other cell of a dividing pair, 0 if none
  double *next_division;      // time of the next division, NEVER if none
  double *birth_time;         // time at which this id came into being
  double *pair_start;         // time of the division that made the pair
  double *detached_time;      // time at which the cell was first found detached, or NEVER

  // zeros are what an atom has that no one has told its state

  void clear(int i)
  {
    divisions_left[i] = divisions_done[i] = parent[i] = pair[i] = 0;
    next_division[i] = birth_time[i] = pair_start[i] = detached_time[i] = 0.0;
  }

  bool all_zero(int i) const
  {
    return !divisions_done[i] && !parent[i] && !pair[i] && next_division[i] == 0.0 &&
        birth_time[i] == 0.0 && pair_start[i] == 0.0 && detached_time[i] == 0.0;
  }

  // find the current arrays, return the name of the first property that is missing, if any

  std::string refresh(Atom *atom)
  {
    std::string missing;
    auto integer = [&](const char *name, int *&vector) {
      int flag, columns, index = atom->find_custom(name, flag, columns);
      if (index >= 0 && flag == 0 && columns == 0) vector = atom->ivector[index];
      else if (missing.empty()) missing = std::string("i_") + name;
    };
    auto real = [&](const char *name, double *&vector) {
      int flag, columns, index = atom->find_custom(name, flag, columns);
      if (index >= 0 && flag == 1 && columns == 0) vector = atom->dvector[index];
      else if (missing.empty()) missing = std::string("d_") + name;
    };
    integer("divisions_left", divisions_left);
    integer("divisions_done", divisions_done);
    integer("parent", parent);
    integer("pair", pair);
    real("next_division", next_division);
    real("birth_time", birth_time);
    real("pair_start", pair_start);
    real("detached_time", detached_time);
    return missing;
  }
};

}    // namespace LAMMPS_NS

#endif
