// Attachment of cells to the membrane: the nearest membrane particle of each, the force between
// the two that the law of the cell's kind says, and cells that are too far from it or too close.

#ifndef LMP_SKIN_ATTACHMENT_H
#define LMP_SKIN_ATTACHMENT_H

#include "pointers.h"

#include "skin_cells.h"
#include "skin_nearest.h"

namespace LAMMPS_NS {

class SkinDividingPairs;

class SkinAttachment : protected Pointers {
 public:
  SkinAttachment(class LAMMPS *lmp, SkinCells &cells, const SkinDividingPairs &pairs) :
      Pointers(lmp), cells(cells), pairs(pairs)
  {
  }

  int membrane_type = 0;
  double contact = 0.0;    // cell-membrane contact length
  double core = 0.0;       // closest that a cell may come to a membrane particle

  // of each cell of the list the membrane particles that may be its nearest one until the next
  // neighbor build, and the nearest of these

  void list_candidates();
  SkinNearest::Neighbor nearest_candidate(int k);

  // nearest of all membrane particles where they are now

  void sort_membrane() { nearest.bin(atom, membrane_type); }
  SkinNearest::Neighbor find_nearest(int i) const
  {
    return nearest.find(atom->x[i], atom->tag);
  }

  // whether there is none that is nearer beyond the ghost particles of this rank

  bool is_sure(const SkinNearest::Neighbor &) const;

  // force on cell i as a multiple of the way from the membrane particle to it, and the energy

  struct Pull {
    SkinCellKind::Law law;
    double factor, energy;
  };
  Pull pull(int i, const SkinNearest::Neighbor &) const;

  // note that a cell has detached; an error if it is lost or has pierced the membrane

  void watch(int i, const SkinNearest::Neighbor &);
  bool any_astray();
  void forget_detached_after(double time);

  // ghost particles must reach far enough

  void check_reach() const;
  double memory_usage() const { return nearest.memory_usage(); }

 private:
  SkinCells &cells;
  const SkinDividingPairs &pairs;
  SkinNearest nearest;

  double ghost_cutoff() const;
  double reach() const;
  double stretch(const SkinNearest::Neighbor &) const;
  double stiffness_of(int) const;
  void lost(int, double) const;
  void pierced(int, const SkinNearest::Neighbor &, double) const;
};

}    // namespace LAMMPS_NS

#endif
