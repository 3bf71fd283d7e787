// The distinct triangles of a membrane whose links are dihedrals. Most of them are in pairs, two
// triangles with a link in common, which share work.

#ifndef LMP_SKIN_TRIANGLES_H
#define LMP_SKIN_TRIANGLES_H

#include "pointers.h"

#include <vector>

namespace LAMMPS_NS {

struct SkinTriangle {
  int corner[3];
  int across[3];    // triangle across the link opposite to each corner, itself if there is none
  int type[3];      // dihedral type of that link

  // whether the link opposite to a corner of this triangle has a dihedral here

  bool bends(int corner, int self) const { return across[corner] != self; }
};

class SkinTriangles : protected Pointers {
 public:
  explicit SkinTriangles(class LAMMPS *lmp) : Pointers(lmp) {}
  void build();
  double memory_usage() const;

  // triangles 2 k and 2 k + 1 of k < npairs are (i1,i2,i3) and (i4,i3,i2) of a dihedral

  std::vector<SkinTriangle> all;
  int npairs = 0;

  // triangles with a link that has no dihedral here

  std::vector<int> partial;

  // pairs are taken in blocks; the triangles around those of a block are below its reach, or have
  // no partner

  static constexpr int BLOCK = 256;
  std::vector<int> reach;

 private:
  std::vector<int> first_of_vertex, next_of_triangle;    // triangles by their first corner
  std::vector<int> place;                                // in all, of triangles as they are found
  std::vector<SkinTriangle> found;

  int find(int, int, int);
  void hinge(int, int, int, int);
  void pair_up();
  void put(int, int);
  void find_reach();
  void find_partial();
};

}    // namespace LAMMPS_NS

#endif
