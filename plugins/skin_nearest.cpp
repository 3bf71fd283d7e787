#include "skin_nearest.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

static inline double distance_squared(const double *a, const double *b)
{
  const double dx = a[0] - b[0], dy = a[1] - b[1], dz = a[2] - b[2];
  return dx * dx + dy * dy + dz * dz;
}

/* ----------------------------------------------------------------------
   counting sort of the membrane particles into columns over the xy plane
------------------------------------------------------------------------- */

void SkinNearest::bin(int n, const double *const *x, const int *type, const tagint *tag,
                      int membrane, double column_width)
{
  width = column_width;
  double hi[2] = {0.0, 0.0};
  lo[0] = lo[1] = 0.0;
  int count = 0;
  for (int i = 0; i < n; i++) {
    if (type[i] != membrane) continue;
    for (int d = 0; d < 2; d++) {
      if (count == 0 || x[i][d] < lo[d]) lo[d] = x[i][d];
      if (count == 0 || x[i][d] > hi[d]) hi[d] = x[i][d];
    }
    count++;
  }

  ncolumns[0] = ncolumns[1] = count ? 1 : 0;
  if (count)
    for (int d = 0; d < 2; d++) ncolumns[d] = (int) ((hi[d] - lo[d]) / width) + 1;

  first.assign(ncolumns[0] * ncolumns[1] + 1, 0);
  particles.resize(count);
  column_of.resize(count);

  int k = 0;
  for (int i = 0; i < n; i++) {
    if (type[i] != membrane) continue;
    column_of[k] = column(1, x[i][1]) * ncolumns[0] + column(0, x[i][0]);
    first[column_of[k++] + 1]++;
  }
  for (size_t c = 1; c < first.size(); c++) first[c] += first[c - 1];

  zlo.assign(first.size(), INFINITY);
  zhi.assign(first.size(), -INFINITY);
  std::vector<int> slot(first.begin(), first.end());
  k = 0;
  for (int i = 0; i < n; i++) {
    if (type[i] != membrane) continue;
    const int c = column_of[k++];
    particles[slot[c]++] = {{x[i][0], x[i][1], x[i][2]}, i, tag[i]};
    zlo[c] = std::min(zlo[c], x[i][2]);
    zhi[c] = std::max(zhi[c], x[i][2]);
  }
}

/* ---------------------------------------------------------------------- */

int SkinNearest::column(int dim, double coordinate) const
{
  const double c = std::floor((coordinate - lo[dim]) / width);
  return (int) std::min(std::max(c, 0.0), (double) (ncolumns[dim] - 1));
}

/* ----------------------------------------------------------------------
   lower bound for the distance to the particles of a column: that to the box that holds them
------------------------------------------------------------------------- */

double SkinNearest::distance_squared_to_column(int ix, int iy, const double *point) const
{
  const int c = iy * ncolumns[0] + ix;
  const double xlo = lo[0] + ix * width, ylo = lo[1] + iy * width;
  const double dx = std::max({xlo - point[0], point[0] - xlo - width, 0.0});
  const double dy = std::max({ylo - point[1], point[1] - ylo - width, 0.0});
  const double dz = std::max({zlo[c] - point[2], point[2] - zhi[c], 0.0});
  return dx * dx + dy * dy + dz * dz;
}

/* ----------------------------------------------------------------------
   of particles at the same distance the one with the lowest ID is the nearest
------------------------------------------------------------------------- */

void SkinNearest::search_column(int ix, int iy, const double *point, Neighbor &best,
                                tagint &best_tag) const
{
  // a hair's breadth for the rounding of the bound

  if (best.index >= 0 &&
      distance_squared_to_column(ix, iy, point) > best.distsq * (1.0 + 1.0e-12))
    return;

  const int c = iy * ncolumns[0] + ix;
  for (int k = first[c]; k < first[c + 1]; k++) {
    const Particle &p = particles[k];
    const double rsq = distance_squared(point, p.x);
    if (best.index < 0 || rsq < best.distsq || (rsq == best.distsq && p.tag < best_tag)) {
      best = {p.index, rsq};
      best_tag = p.tag;
    }
  }
}

/* ----------------------------------------------------------------------
   search square rings of columns outward until no further ring can hold a nearer particle
------------------------------------------------------------------------- */

SkinNearest::Neighbor SkinNearest::find(const double *point) const
{
  Neighbor best = {-1, 0.0};
  if (particles.empty()) return best;
  tagint best_tag = 0;

  const int cx = column(0, point[0]), cy = column(1, point[1]);
  const int last = std::max(ncolumns[0], ncolumns[1]);

  for (int ring = 0; ring <= last; ring++) {

    // what lies in this ring is at least (ring-1) whole columns away

    const double gap = std::max(ring - 1, 0) * width;
    if (best.index >= 0 && best.distsq < gap * gap) break;

    for (int iy = std::max(cy - ring, 0); iy <= std::min(cy + ring, ncolumns[1] - 1); iy++) {
      const bool whole_row = (iy == cy - ring) || (iy == cy + ring);
      const int step = (whole_row || ring == 0) ? 1 : 2 * ring;
      for (int ix = cx - ring; ix <= cx + ring; ix += step)
        if (ix >= 0 && ix < ncolumns[0]) search_column(ix, iy, point, best, best_tag);
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
    const int xlo = column(0, point[0] - radius), xhi = column(0, point[0] + radius);
    const int ylo = column(1, point[1] - radius), yhi = column(1, point[1] + radius);
    for (int iy = ylo; iy <= yhi; iy++)
      for (int ix = xlo; ix <= xhi; ix++) {
        if (distance_squared_to_column(ix, iy, point) > radius * radius * (1.0 + 1.0e-12))
          continue;
        const int c = iy * ncolumns[0] + ix;
        for (int k = first[c]; k < first[c + 1]; k++)
          if (distance_squared(point, particles[k].x) <= radius * radius)
            candidates.push_back(particles[k].index);
      }
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
    const double rsq = distance_squared(point, x[j]);
    if (best.index < 0 || rsq < best.distsq || (rsq == best.distsq && tag[j] < tag[best.index]))
      best = {j, rsq};
  }
  return best;
}

/* ---------------------------------------------------------------------- */

double SkinNearest::memory_usage() const
{
  return (double) particles.capacity() * sizeof(Particle) +
      (double) (first.capacity() + column_of.capacity() + candidates.capacity() +
                first_candidate.capacity()) * sizeof(int);
}
