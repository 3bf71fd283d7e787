#include "skin_nearest.h"

#include "skin_double4.h"
#include "skin_vector.h"

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

void SkinNearest::search_column(int ix, int iy, const double *point, const tagint *tag,
                                Neighbor &best) const
{
  if (best.index >= 0 && columns.distance_squared_to_column(ix, iy, point) > best.distsq) return;

  const int c = iy * columns.ncolumns[0] + ix;
  for (int k = columns.first[c]; k < columns.first[c + 1]; k++) {
    const double rsq = columns.distance_squared(k, point);
    const int i = columns.index[k];
    if (best.index < 0 || rsq < best.distsq || (rsq == best.distsq && tag[i] < tag[best.index]))
      best = {i, rsq};
  }
}

/* ----------------------------------------------------------------------
   search square rings of columns outward until no further ring can hold a nearer particle
------------------------------------------------------------------------- */

SkinNearest::Neighbor SkinNearest::find(const double *point, const tagint *tag) const
{
  Neighbor best = {-1, 0.0};
  if (columns.index.empty()) return best;

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
        if (ix >= 0 && ix < n[0]) search_column(ix, iy, point, tag, best);
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

void SkinNearest::add_candidates(const double *point, double margin, const tagint *tag)
{
  const Neighbor best = find(point, tag);
  if (best.index >= 0) {
    // the nearest itself is among them, whatever the rounding of the root

    const double radius = std::sqrt(best.distsq) * (1.0 + 1.0e-12) + 2.0 * margin;
    columns.around(point, point, radius, near);
    const auto [begin, end] = near.within(point, radius);
    for (const int *k = begin; k < end; k++) candidates.push_back(near.index[*k]);
  }
  first_candidate.push_back((int) candidates.size());
}

/* ----------------------------------------------------------------------
   squared distances of a point to the particles of a list; returns the least
------------------------------------------------------------------------- */

SKIN_VECTOR static double distances_squared(const int *list, int n, const double *point,
                                            const double *x, double *distsq)
{
  const SkinDouble4 zero = {};
  const SkinPoint<SkinDouble4> four_points = spread({point[0], point[1], point[2]});
  SkinDouble4 four_least = zero + INFINITY;
  double least = INFINITY;
  int k = 0;
  for (; k + 4 <= n; k += 4) {
    const SkinPoint<SkinDouble4> d = load<SkinDouble4>(x, list + k, 1) - four_points;
    const SkinDouble4 rsq = dot(d, d);
    for (int m = 0; m < 4; m++) distsq[k + m] = rsq[m];
    four_least = smaller(four_least, rsq);
  }
  for (; k < n; k++) {
    const SkinPoint<double> one_point = {point[0], point[1], point[2]};
    const SkinPoint<double> d = load<double>(x, list + k, 1) - one_point;
    distsq[k] = dot(d, d);
    least = smaller(least, distsq[k]);
  }
  for (int m = 0; m < 4; m++) least = smaller(least, four_least[m]);
  return least;
}

/* ----------------------------------------------------------------------
   of equally near ones that of the lowest ID
------------------------------------------------------------------------- */

SkinNearest::Neighbor SkinNearest::nearest_candidate(int list, const double *point,
                                                     const double *x, const tagint *tag)
{
  const int *const mine = candidates.data() + first_candidate[list];
  const int n = first_candidate[list + 1] - first_candidate[list];
  if (n == 0) return {-1, 0.0};

  if ((int) distsq.size() < n) distsq.resize(2 * (size_t) n);
  Neighbor best = {-1, distances_squared(mine, n, point, x, distsq.data())};
  for (int k = 0; k < n; k++)
    if (distsq[k] == best.distsq && (best.index < 0 || tag[mine[k]] < tag[best.index]))
      best.index = mine[k];
  return best;
}

/* ---------------------------------------------------------------------- */

double SkinNearest::memory_usage() const
{
  return columns.memory_usage() + near.memory_usage() +
      (double) distsq.capacity() * sizeof(double) +
      (double) (candidates.capacity() + first_candidate.capacity()) * sizeof(int);
}
