// Copies of atoms in all their per-atom data: of the atom style and of all fixes.

#ifndef LMP_SKIN_ATOM_COPY_H
#define LMP_SKIN_ATOM_COPY_H

namespace LAMMPS_NS {
class LAMMPS;

namespace SkinAtomCopy {

  // what i has, for j, which is on the same rank: all but its ID, its type, its place, the force on
  // it, and its bonds and what follows from them

  void copy(LAMMPS *, int i, int j);

}    // namespace SkinAtomCopy
}    // namespace LAMMPS_NS

#endif
