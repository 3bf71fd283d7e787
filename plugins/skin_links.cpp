#include "skin_links.h"

#include "atom.h"
#include "neighbor.h"

#include <algorithm>

using namespace LAMMPS_NS;

/* ----------------------------------------------------------------------
   group the links of this neighbor build; a triangle is found from an atom that is the first one
   of two of its links
------------------------------------------------------------------------- */

void SkinLinks::build()
{
  const int nlinks = neighbor->nbondlist;
  all.resize(nlinks);
  for (int n = 0; n < nlinks; n++) std::copy_n(neighbor->bondlist[n], 3, all[n].begin());
  first_of_atom.assign(atom->nlocal + atom->nghost, -1);
  next_of_link.resize(nlinks);
  for (int n = nlinks - 1; n >= 0; n--) {
    next_of_link[n] = first_of_atom[all[n][0]];
    first_of_atom[all[n][0]] = n;
  }

  of_type.resize(atom->nbondtypes + 1);
  for (Group &group : of_type) {
    group.threes.clear();
    group.ones.clear();
  }
  listed.assign(nlinks, 0);

  for (int n = 0; n < nlinks; n++) {
    if (listed[n]) continue;
    const int a = all[n][0], b = all[n][1], type = all[n][2];
    listed[n] = 1;
    int second = next_of_link[n], third = -1;
    for (; second >= 0; second = next_of_link[second]) {
      if (listed[second] || all[second][2] != type) continue;
      third = find(b, all[second][1], type);
      if (third >= 0) break;
    }

    if (third >= 0) {
      of_type[type].threes.push_back({a, b, all[second][1]});
      listed[second] = listed[third] = 1;
    } else {
      of_type[type].ones.push_back({a, b});
    }
  }
}

/* ----------------------------------------------------------------------
   a link of this type between two atoms that is not listed yet, or -1
------------------------------------------------------------------------- */

int SkinLinks::find(int a, int b, int type) const
{
  for (const auto &[from, to] : {SkinOneLink{a, b}, SkinOneLink{b, a}})
    for (int n = first_of_atom[from]; n >= 0; n = next_of_link[n])
      if (all[n][1] == to && all[n][2] == type && !listed[n]) return n;
  return -1;
}

/* ---------------------------------------------------------------------- */

double SkinLinks::memory_usage() const
{
  double bytes = (double) (first_of_atom.capacity() + next_of_link.capacity()) * sizeof(int);
  for (const Group &group : of_type)
    bytes += (double) group.threes.capacity() * sizeof(SkinThreeLinks) +
        (double) group.ones.capacity() * sizeof(SkinOneLink);
  return bytes + (double) listed.capacity() * sizeof(char) +
      (double) all.capacity() * 3 * sizeof(int);
}
