#include "skin_nearest.h"

#include "atom.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

void SkinNearest::bin(const Atom *atom, int membrane_type)
{
  std::vector<char> wanted(atom->ntypes + 1, 0);
  wanted[membrane_type] = 1;
  columns.sort(atom, wanted);
}

/* ----------------------------------------------------------------------
   of particles at the same distance the one with the lowest ID is the nearest
------------------------------------------------------------------------- */

void SkinNearest::search_column(int ix, int iy, const double *point, Neighbor &best,
                                tagint &best_tag) const
{
  if (best.index >= 0 && columns.distance_squared_to_column(ix, iy, point) > best.distsq) return;

  const int c = iy * columns.ncolumns[0] + ix;
  for (int k = columns.first[c]; k < columns.first[c + 1]; k++) {
    const double rsq = columns.distance_squared(k, point);
    const tagint tag = columns.tag[k];
    if (best.index < 0 || rsq < best.distsq || (rsq == best.distsq && tag < best_tag)) {
      best = {columns.index[k], rsq};
      best_tag = tag;
    }
  }
}

/* ----------------------------------------------------------------------
   search square rings of columns outward until no further ring can hold a nearer particle
------------------------------------------------------------------------- */

SkinNearest::Neighbor SkinNearest::find(const double *point) const
{
  Neighbor best = {-1, 0.0};
  if (columns.index.empty()) return best;
  tagint best_tag = 0;

  const int *const n = columns.ncolumns;
  const int cx = columns.column(0, point[0]), cy = columns.column(1, point[1]);
  const int last = std::max(n[0], n[1]);

  for (int ring = 0; ring <= last; ring++) {

    // what lies in this ring is at least (ring-1) whole columns away

    const double gap = std::max(ring - 1, 0) * columns.width;
    if (best.index >= 0 && best.distsq < gap * gap) break;

    for (int iy = std::max(cy - ring, 0); iy <= std::min(cy + ring, n[1] - 1); iy++) {
      const bool whole_row = (iy == cy - ring) || (iy == cy + ring);
      const int step = (whole_row || ring == 0) ? 1 : 2 * ring;
      for (int ix = cx - ring; ix <= cx + ring; ix += step)
        if (ix >= 0 && ix < n[0]) search_column(ix, iy, point, best, best_tag);
    }
  }
  return best;
}

/* ---------------------------------------------------------------------- */

void SkinNearest::clear_candidates()
{
  candidates.clear();
  first_candidate.assign(1, 0);
}

/* ----------------------------------------------------------------------
   list all particles that can be nearest once point and particles have moved by at most
   margin relative to each other
------------------------------------------------------------------------- */

void SkinNearest::add_candidates(const double *point, double margin)
{
  const Neighbor best = find(point);
  if (best.index >= 0) {
    const double radius = std::sqrt(best.distsq) + 2.0 * margin;
    columns.around(point, point, radius, near);
    const auto [begin, end] = near.within(point, radius);
    for (const int *k = begin; k < end; k++) candidates.push_back(near.index[*k]);
  }
  first_candidate.push_back((int) candidates.size());
}

/* ---------------------------------------------------------------------- */

SkinNearest::Neighbor SkinNearest::nearest_candidate(int list, const double *point,
                                                     const double *const *x,
                                                     const tagint *tag) const
{
  Neighbor best = {-1, 0.0};
  for (int k = first_candidate[list]; k < first_candidate[list + 1]; k++) {
    const int j = candidates[k];
    const double dx = x[j][0] - point[0], dy = x[j][1] - point[1], dz = x[j][2] - point[2];
    const double rsq = dx * dx + dy * dy + dz * dz;
    if (best.index < 0 || rsq < best.distsq || (rsq == best.distsq && tag[j] < tag[best.index]))
      best = {j, rsq};
  }
  return best;
}

/* ---------------------------------------------------------------------- */

double SkinNearest::memory_usage() const
{
  return columns.memory_usage() + near.memory_usage() +
      (double) (candidates.capacity() + first_candidate.capacity()) * sizeof(int);
}
