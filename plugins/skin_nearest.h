// Exact nearest membrane particle of a point, among the owned and ghost particles of this rank.

#ifndef LMP_SKIN_NEAREST_H
#define LMP_SKIN_NEAREST_H

#include "lmptype.h"

#include <vector>

namespace LAMMPS_NS {

class SkinNearest {
 public:
  struct Neighbor {
    int index;        // local index of the membrane particle, -1 if there is none
    double distsq;    // squared distance to it
  };

  // sort the membrane particles among n atoms into columns of the given width

  void bin(int n, const double *const *x, const int *type, const tagint *tag, int membrane,
           double width);

  // nearest of all binned particles

  Neighbor find(const double *point) const;

  // start, extend and use lists of candidates, valid while nothing moves further than the margin

  void clear_candidates();
  void add_candidates(const double *point, double margin);
  Neighbor nearest_candidate(int list, const double *point, const double *const *x,
                             const tagint *tag) const;

  double memory_usage() const;

 private:
  struct Particle {
    double x[3];
    int index;
    tagint tag;
  };

  int ncolumns[2] = {0, 0};
  double lo[2] = {0.0, 0.0}, width = 0.0;
  std::vector<int> first;             // first particle of each column, one entry more at the end
  std::vector<double> zlo, zhi;       // extent of each column's particles
  std::vector<Particle> particles;    // sorted by column
  std::vector<int> column_of;

  std::vector<int> candidates, first_candidate;

  int column(int dim, double coordinate) const;
  double distance_squared_to_column(int ix, int iy, const double *point) const;
  void search_column(int ix, int iy, const double *point, Neighbor &best, tagint &best_tag) const;
};

}    // namespace LAMMPS_NS

#endif
