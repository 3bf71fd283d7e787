#include "skin_atom_copy.h"

#include "atom.h"
#include "fix.h"
#include "lammps.h"
#include "modify.h"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <string_view>

using namespace LAMMPS_NS;

static constexpr std::string_view NOT_COPIED[] = {
    "id", "type", "x", "f", "nspecial", "num_bond", "num_angle", "num_dihedral", "num_improper",
    "nspecial15", "ellipsoid", "line", "tri", "body"};

/* ----------------------------------------------------------------------
   Atom::peratom lists the arrays of all atom styles; those not in use are null pointers, and those
   whose length differs between atoms belong to bonds
------------------------------------------------------------------------- */

static void copy_atom_style(const Atom *atom, int i, int j)
{
  for (const Atom::PerAtom &data : atom->peratom) {
    if (data.cols < 0 ||
        std::count(std::begin(NOT_COPIED), std::end(NOT_COPIED), std::string_view(data.name)))
      continue;
    void *const array = *(void **) data.address;
    if (!array) continue;
    const size_t size = data.datatype == Atom::DOUBLE ? sizeof(double)
        : data.datatype == Atom::BIGINT               ? sizeof(bigint)
                                                      : sizeof(int);
    if (data.cols == 0) {
      char *const vector = (char *) array;
      std::memcpy(vector + j * size, vector + i * size, size);
    } else {
      char **const rows = (char **) array;
      std::memcpy(rows[j], rows[i], data.cols * size);
    }
  }
}

/* ---------------------------------------------------------------------- */

void SkinAtomCopy::copy(LAMMPS *lmp, int i, int j)
{
  const Atom *const atom = lmp->atom;
  copy_atom_style(atom, i, j);
  for (int n = 0; n < atom->nextra_grow; n++)
    lmp->modify->fix[atom->extra_grow[n]]->copy_arrays(i, j, 0);
}
