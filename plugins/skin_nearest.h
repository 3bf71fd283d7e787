// Exact nearest membrane particle of a point, among the owned and ghost particles of this rank.

#ifndef LMP_SKIN_NEAREST_H
#define LMP_SKIN_NEAREST_H

#include "skin_columns.h"

#include "lmptype.h"

#include <vector>

namespace LAMMPS_NS {

class SkinNearest {
 public:
  struct Neighbor {
    int index;        // local index of the membrane particle, -1 if there is none
    double distsq;    // squared distance to it
  };

  // sort the particles of the membrane's type into columns

  void bin(const Atom *, int membrane_type);

  // nearest of all binned particles

  Neighbor find(const double *point, const tagint *tag) const;

  // start, extend and use lists of candidates, valid while nothing moves further than the margin

  void clear_candidates();
  void add_candidates(const double *point, double margin, const tagint *tag);
  Neighbor nearest_candidate(int list, const double *point, const double *x, const tagint *tag);

  double memory_usage() const;

 private:
  SkinColumns columns;
  SkinSurroundings near;
  std::vector<int> candidates, first_candidate;
  std::vector<double> distsq;    // of the candidates of the last call

  void search_column(int ix, int iy, const double *point, const tagint *tag, Neighbor &best) const;
};

}    // namespace LAMMPS_NS

#endif
