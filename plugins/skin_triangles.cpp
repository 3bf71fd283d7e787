#include "skin_triangles.h"

#include "atom.h"
#include "error.h"
#include "neighbor.h"

#include <algorithm>

using namespace LAMMPS_NS;

/* ----------------------------------------------------------------------
   list the distinct triangles of all links and which lie across each other, for the atom
   order of this neighbor build
------------------------------------------------------------------------- */

void SkinTriangles::build()
{
  first_of_vertex.assign(atom->nlocal + atom->nghost, -1);
  next_of_triangle.clear();
  found.clear();

  for (int n = 0; n < neighbor->ndihedrallist; n++) {
    const int *d = neighbor->dihedrallist[n];
    const int left = find(d[0], d[1], d[2]);
    const int right = find(d[3], d[2], d[1]);
    hinge(left, d[0], right, d[4]);
    hinge(right, d[3], left, d[4]);
  }
  pair_up();
  find_reach();
  find_partial();
}

/* ----------------------------------------------------------------------
   index of the triangle with these corners in this orientation, added if it is new
------------------------------------------------------------------------- */

int SkinTriangles::find(int a, int b, int c)
{
  // cyclic order is orientation: rotate the smallest index to the front

  int v[3] = {a, b, c};
  if (b < a && b < c) {
    v[0] = b; v[1] = c; v[2] = a;
  } else if (c < a && c < b) {
    v[0] = c; v[1] = a; v[2] = b;
  }

  for (int t = first_of_vertex[v[0]]; t >= 0; t = next_of_triangle[t])
    if (found[t].corner[1] == v[1] && found[t].corner[2] == v[2]) return t;

  // across a link that has no dihedral here lies the triangle itself: no fold, no energy

  const int t = (int) found.size();
  found.push_back({{v[0], v[1], v[2]}, {t, t, t}, {1, 1, 1}});
  next_of_triangle.push_back(first_of_vertex[v[0]]);
  first_of_vertex[v[0]] = t;
  return t;
}

/* ----------------------------------------------------------------------
   note that a triangle has another one across the link opposite to one of its vertices
------------------------------------------------------------------------- */

void SkinTriangles::hinge(int t, int opposite, int other, int type)
{
  SkinTriangle &mine = found[t];
  int k = 0;
  while (mine.corner[k] != opposite) k++;
  if (mine.bends(k, t))
    error->one(FLERR, "Dihedral skin/bend: two dihedrals for one link of the triangle of atoms "
               "{} {} {}", atom->tag[mine.corner[0]], atom->tag[mine.corner[1]],
               atom->tag[mine.corner[2]]);
  mine.across[k] = other;
  mine.type[k] = type;
}

/* ----------------------------------------------------------------------
   order the triangles: pairs first, each triangle with the first one around it that is still
   without a partner, then those that have found none
------------------------------------------------------------------------- */

void SkinTriangles::pair_up()
{
  const int n = (int) found.size();
  place.assign(n, -1);
  all.resize(n);
  npairs = 0;

  for (int t = 0; t < n; t++) {
    for (int k = 0; k < 3 && place[t] < 0; k++) {
      const int other = found[t].across[k];
      if (other == t || place[other] >= 0) continue;
      place[t] = 2 * npairs;
      place[other] = 2 * npairs + 1;
      npairs++;

      int m = 0;
      while (found[other].corner[(m + 1) % 3] != found[t].corner[(k + 2) % 3]) m++;
      put(t, k);
      put(other, m);
    }
  }

  int last = 2 * npairs;
  for (int t = 0; t < n; t++)
    if (place[t] < 0) {
      place[t] = last++;
      put(t, 0);
    }
  for (SkinTriangle &mine : all)
    for (int &other : mine.across) other = place[other];
}

/* ----------------------------------------------------------------------
   copy a triangle to its place, one of its corners first
------------------------------------------------------------------------- */

void SkinTriangles::put(int t, int first)
{
  for (int k = 0; k < 3; k++) {
    const int from = (first + k) % 3;
    all[place[t]].corner[k] = found[t].corner[from];
    all[place[t]].across[k] = found[t].across[from];
    all[place[t]].type[k] = found[t].type[from];
  }
}

/* ---------------------------------------------------------------------- */

void SkinTriangles::find_reach()
{
  reach.clear();
  int farthest = 0;
  for (int t = 0; t < 2 * npairs; t++) {
    if (t % (2 * BLOCK) == 0) reach.push_back(0);
    for (const int other : all[t].across)
      if (other < 2 * npairs) farthest = std::max(farthest, other + 1);
    reach.back() = farthest;
  }
}

/* ---------------------------------------------------------------------- */

void SkinTriangles::find_partial()
{
  partial.clear();
  for (int t = 0; t < (int) all.size(); t++) {
    const int *const across = all[t].across;
    if (std::find(across, across + 3, t) != across + 3) partial.push_back(t);
  }
}

/* ---------------------------------------------------------------------- */

double SkinTriangles::memory_usage() const
{
  return (double) (all.capacity() + found.capacity()) * sizeof(SkinTriangle) +
      (double) (first_of_vertex.capacity() + next_of_triangle.capacity() + place.capacity() +
                reach.capacity() + partial.capacity()) * sizeof(int);
}
