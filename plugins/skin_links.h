// The links of a membrane by type: three by three, where they are the sides of a triangle, so that
// they share its corners, and the others.

#ifndef LMP_SKIN_LINKS_H
#define LMP_SKIN_LINKS_H

#include "pointers.h"

#include <array>
#include <vector>

namespace LAMMPS_NS {

typedef std::array<int, 3> SkinThreeLinks;    // atoms of the triangle
typedef std::array<int, 2> SkinOneLink;       // atoms at the ends

class SkinLinks : protected Pointers {
 public:
  explicit SkinLinks(class LAMMPS *lmp) : Pointers(lmp) {}
  void build();
  double memory_usage() const;

  struct Group {
    std::vector<SkinThreeLinks> threes;
    std::vector<SkinOneLink> ones;
  };
  std::vector<Group> of_type;

  // all links, with their types, as they are listed: in a hybrid style they are of one sub-style

  std::vector<std::array<int, 3>> all;

 private:
  std::vector<int> first_of_atom, next_of_link;    // links by their first atom, -1 ends
  std::vector<char> listed;

  int find(int, int, int) const;
};

}    // namespace LAMMPS_NS

#endif
