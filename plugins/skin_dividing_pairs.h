// Dividing pairs: the growing spring between the two cells, that they do not exclude each other
// meanwhile, and when this ends.

#ifndef LMP_SKIN_DIVIDING_PAIRS_H
#define LMP_SKIN_DIVIDING_PAIRS_H

#include "pointers.h"

#include "skin_cells.h"

#include <vector>

namespace LAMMPS_NS {

class SkinArguments;

class SkinDividingPairs : protected Pointers {
 public:
  SkinDividingPairs(class LAMMPS *lmp, SkinCells &cells) : Pointers(lmp), cells(cells) {}

  bool stay = false;     // no cell leaves while it is in a pair
  double apart = 0.0;    // a pair ends only when its cells are further apart
  void read_spring(SkinArguments &);

  // length of a full-grown spring

  double full_length() const { return end; }

  // the other cell, at its image closest to this one

  int partner_of(int i) const;

  // force on cell i as a multiple of the way from the other cell to it, and the energy of the pair

  struct Spring {
    double way[3], distance, factor, energy;
  };
  Spring spring(int i) const;

  void begin(int i, tagint other, double time);

  // special neighbors are made from bonds alone when atoms are read: put those of pairs back in

  void hide_partner(int i) { hide(i, cells.state.pair[i]); }

  // ends: whether a pair is full grown, and those of my pairs that end now by growth, by these
  // deaths on any rank, or because another command has removed a cell, which all ranks are told

  bool grown_by(int i, double time) const { return cells.state.pair[i] && end_time(i) <= time; }
  std::vector<SkinCellEvent> grown() const;
  std::vector<SkinCellEvent> ended_by(const std::vector<SkinCellEvent> &) const;
  std::vector<SkinCellEvent> widowed() const;

  // end a pair for those of its cells that I own

  void dissolve(const SkinCellEvent &);

  // whether the user has given a cell of mine a bond

  bool is_bonded(int i) const;

  // both cells of each pair name each other, on whatever ranks they are

  void check() const;

 private:
  SkinCells &cells;
  double stiffness = 0.0, start = 0.0, rate = 0.0, end = 0.0;    // of the spring

  double end_time(int) const;
  std::vector<tagint> missing_ids(const std::vector<tagint> &) const;
  bool have_bond(tagint, tagint) const;
  void hide(int, tagint);
  void show(int, tagint);
};

}    // namespace LAMMPS_NS

#endif
