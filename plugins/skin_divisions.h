// Divisions: when each cell divides next, and what a birth makes of the mother and of her daughter.

#ifndef LMP_SKIN_DIVISIONS_H
#define LMP_SKIN_DIVISIONS_H

#include "pointers.h"

#include "skin_cells.h"
#include "skin_nearest.h"
#include "skin_random.h"

#include <cstdint>
#include <vector>

namespace LAMMPS_NS {

class SkinDividingPairs;

class SkinDivisions : protected Pointers {
 public:
  SkinDivisions(class LAMMPS *lmp, SkinCells &cells, SkinDividingPairs &pairs) :
      Pointers(lmp), cells(cells), pairs(pairs)
  {
  }

  bigint seed = 0;                 // of all random events
  double half_separation = 0.0;    // of a newborn pair
  int inherited_groups = 0;        // bits of groups in which a daughter is if her mother is

  // a cell that can divide but has no schedule is in its first cycle

  void schedule_first(int i);

  // one that has become a cell of another kind begins a cycle; the key is that of the conversion

  void schedule_converted(int i, uint64_t key);

  bool due_by(int i, double time) const;

  // the division that is due, at the earliest at this time, above this membrane particle

  SkinCellEvent plan(int i, double earliest, const SkinNearest::Neighbor &) const;

  // births with consecutive IDs from this one on

  void carry_out(const std::vector<SkinCellEvent> &, tagint first_id);

 private:
  SkinCells &cells;
  SkinDividingPairs &pairs;

  double wait(const SkinCellKind &, tagint, uint64_t,
              SkinRandom::Purpose = SkinRandom::WAIT) const;
  double next_after(int i, double time, int number) const;
  void middle_of_subdomain(double *) const;
  void divide_mother(int, const SkinCellEvent &, tagint);
  void start_daughter(int, const SkinCellEvent &);
};

}    // namespace LAMMPS_NS

#endif
