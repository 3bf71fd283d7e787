// Pairs of particles that can come into contact before the next neighbor build, for terms that few
// pairs of types have. Each pair is listed once on all ranks together.

#ifndef LMP_SKIN_CONTACTS_H
#define LMP_SKIN_CONTACTS_H

#include "skin_columns.h"
#include "skin_pair_forces.h"

#include "pointers.h"

#include <vector>

namespace LAMMPS_NS {

class SkinContacts : protected Pointers {
 public:
  explicit SkinContacts(class LAMMPS *lmp) : Pointers(lmp) {}

  // the kind of contact of all pairs of types, in rows of ntypes + 1, -1 if they have none;
  // contact distances of kinds. To be called on all ranks. Pairs that are listed change to their
  // new kinds

  void set_kinds(const std::vector<int> &kind_of_types, const std::vector<double> &distance);
  void build();
  void clear();
  double memory_usage() const;

  std::vector<std::vector<SkinAtomPair>> of_kind;

 private:
  int ntypes = 0;
  std::vector<int> kinds;
  std::vector<double> distances, radii;    // without and with margins

  // pairs are sought from particles of the types in centers, among those of the types in partners;
  // one_way if these have no type in common, so that no pair is found from both of its ends

  std::vector<char> centers, partners;
  bool one_way = false;
  bool one_kind = false;    // of all pairs of a center and a partner
  bool all_nearest = false;    // no pair in reach is one of images that are not the nearest ones
  SkinColumns columns, center_columns;
  SkinSurroundings near;

  void choose_centers();
  bool all_of_one_kind() const;
  void regroup();
  void add_column(const SkinColumns &, int, double);
  bool mine(int, int) const;
  bool above(int, int) const;
  bool hidden(int, int) const;
  bool excluded(int, int) const;
};

}    // namespace LAMMPS_NS

#endif
