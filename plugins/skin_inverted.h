// Triangles that have been turned over: folded far against all that are around them. At the edges
// of ranks and of the periodic box, and where dihedrals list their corners in both senses, one
// triangle is in several lists with a part of its links in each: all ranks put them together.

#ifndef LMP_SKIN_INVERTED_H
#define LMP_SKIN_INVERTED_H

#include "pointers.h"

#include <array>
#include <vector>

namespace LAMMPS_NS {

class SkinInverted : protected Pointers {
 public:
  SkinInverted(class LAMMPS *lmp, double least) : Pointers(lmp), least(least) {}

  // look at the triangles with these normals, on all ranks; whether one with all its links here is
  // inverted may be known

  bool find(const class SkinTriangles &, const double *normal, bool whole);

  // the first one that was found: IDs of its corners, cosine of its smallest fold

  std::array<tagint, 3> corner = {};
  double cosine = 0.0;

 private:
  using Corners = std::array<tagint, 3>;
  struct Known {
    Corners corner;
    double cosine;    // of the smallest fold of the links that are here
  };

  double least;    // cosine of the angle beyond which a triangle is inverted
  std::vector<Known> folds;
  std::vector<Corners> candidates;    // on all ranks, sorted

  void measure(const class SkinTriangles &, const double *normal, bool whole);
  bool collect();
};

}    // namespace LAMMPS_NS

#endif
