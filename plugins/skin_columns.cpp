#include "skin_columns.h"

#include "skin_vector.h"

#include "atom.h"

using namespace LAMMPS_NS;

// particles in a column, if they were spread evenly

static constexpr double COLUMN = 8.0;

// columns along a side at most, and their width at least

static constexpr double MOST = 10000.0, SMALLEST = 1.0e-3;

/* ----------------------------------------------------------------------
   counting sort
------------------------------------------------------------------------- */

void SkinColumns::sort(const Atom *atom, const std::vector<char> &wanted)
{
  const double *const *const at = atom->x;
  const int *const type = atom->type;
  const int n = atom->nlocal + atom->nghost;

  chosen.clear();
  for (int i = 0; i < n; i++)
    if (wanted[type[i]]) chosen.push_back(i);
  const int count = (int) chosen.size();

  double hi[2] = {0.0, 0.0};
  lo[0] = lo[1] = 0.0;
  if (count) {
    std::copy_n(at[chosen[0]], 2, lo);
    std::copy_n(at[chosen[0]], 2, hi);
  }
  for (const int i : chosen)
    for (int d = 0; d < 2; d++) {
      lo[d] = std::min(lo[d], at[i][d]);
      hi[d] = std::max(hi[d], at[i][d]);
    }

  const double sides[2] = {hi[0] - lo[0], hi[1] - lo[1]};
  width = std::sqrt(COLUMN * sides[0] * sides[1] / std::max(count, 1));
  width = std::max({width, sides[0] / MOST, sides[1] / MOST, SMALLEST});
  per_width = 1.0 / width;
  for (int d = 0; d < 2; d++) ncolumns[d] = count ? (int) (sides[d] * per_width) + 1 : 0;

  first.assign(ncolumns[0] * ncolumns[1] + 1, 0);
  for (std::vector<double> &coordinates : x) coordinates.resize(count);
  index.resize(count);
  column_of.resize(count);

  for (int k = 0; k < count; k++) {
    const double *const point = at[chosen[k]];
    column_of[k] = column(1, point[1]) * ncolumns[0] + column(0, point[0]);
    first[column_of[k] + 1]++;
  }
  for (size_t c = 1; c < first.size(); c++) first[c] += first[c - 1];

  slot.assign(first.begin(), first.end());
  for (int k = 0; k < count; k++) {
    const int i = chosen[k], place = slot[column_of[k]]++;
    for (int d = 0; d < 3; d++) x[d][place] = at[i][d];
    index[place] = i;
  }

  zlo.assign(first.size(), INFINITY);
  zhi.assign(first.size(), -INFINITY);
  for (size_t c = 0; c + 1 < first.size(); c++) {
    double least = INFINITY, most = -INFINITY;
    for (int k = first[c]; k < first[c + 1]; k++) {
      least = std::min(least, x[2][k]);
      most = std::max(most, x[2][k]);
    }
    zlo[c] = least;
    zhi[c] = most;
  }
}

/* ---------------------------------------------------------------------- */

void SkinColumns::around(const double *boxlo, const double *boxhi, double radius,
                         SkinSurroundings &near, int first_column) const
{
  for (std::vector<double> &coordinates : near.x) coordinates.clear();
  near.index.clear();
  near.zlo = INFINITY;
  near.zhi = -INFINITY;
  if (index.empty()) return;

  const int ylo = std::max(column(1, boxlo[1] - radius), first_column / ncolumns[0]);
  const int yhi = column(1, boxhi[1] + radius);
  for (int iy = ylo; iy <= yhi; iy++) {

    // how far the radius reaches in this row, a hair's breadth more

    const double y = lo[1] + iy * width;
    const double dy = std::max({y - boxhi[1], boxlo[1] - y - width, 0.0});
    const double reach = std::sqrt(std::max(radius * radius - dy * dy, 0.0)) + 1.0e-9 * radius;
    const int row = iy * ncolumns[0], last = row + column(0, boxhi[0] + reach);
    const auto apart = [&](int c) {
      return zlo[c] > boxhi[2] + reach || zhi[c] < boxlo[2] - reach;
    };
    for (int c = std::max(row + column(0, boxlo[0] - reach), first_column); c <= last; c++) {
      if (apart(c)) continue;

      // the particles of columns that follow each other do so, too

      const int begin = first[c];
      for (;; c++) {
        near.zlo = std::min(near.zlo, zlo[c]);
        near.zhi = std::max(near.zhi, zhi[c]);
        if (c == last || apart(c + 1)) break;
      }
      const int end = first[c + 1];
      for (int d = 0; d < 3; d++)
        near.x[d].insert(near.x[d].end(), x[d].begin() + begin, x[d].begin() + end);
      near.index.insert(near.index.end(), index.begin() + begin, index.begin() + end);
    }
  }
}

/* ----------------------------------------------------------------------
   distances first; then, without a branch that could not be foreseen, which are within the radius
------------------------------------------------------------------------- */

SKIN_VECTOR static int select(int first, int n, const double *x, const double *y, const double *z,
                              const double *point, double radiussq, double *distsq, int *hits)
{
  const double px = point[0], py = point[1], pz = point[2];
  for (int k = first; k < n; k++) {
    const double dx = x[k] - px, dy = y[k] - py, dz = z[k] - pz;
    distsq[k] = dx * dx + dy * dy + dz * dz;
  }
  int nhits = 0;
  for (int k = first; k < n; k++) {
    hits[nhits] = k;
    nhits += distsq[k] <= radiussq;
  }
  return nhits;
}

/* ---------------------------------------------------------------------- */

SkinSurroundings::Found SkinSurroundings::within(const double *point, double radius, int first)
{
  const int n = (int) index.size();
  if ((int) hits.size() <= n) {
    distsq.resize(2 * (size_t) n + 1);
    hits.resize(2 * (size_t) n + 1);
  }
  if (zlo > point[2] + radius || zhi < point[2] - radius) return {hits.data(), hits.data()};
  const int nhits = select(first, n, x[0].data(), x[1].data(), x[2].data(), point,
                           radius * radius, distsq.data(), hits.data());
  return {hits.data(), hits.data() + nhits};
}

/* ---------------------------------------------------------------------- */

double SkinSurroundings::memory_usage() const
{
  return (double) (x[0].capacity() + x[1].capacity() + x[2].capacity() + distsq.capacity()) *
      sizeof(double) + (double) (index.capacity() + hits.capacity()) * sizeof(int);
}

/* ---------------------------------------------------------------------- */

double SkinColumns::distance_squared_to_column(int ix, int iy, const double *point) const
{
  const int c = iy * ncolumns[0] + ix;
  const double xlo = lo[0] + ix * width, ylo = lo[1] + iy * width;
  const double dx = std::max({xlo - point[0], point[0] - xlo - width, 0.0});
  const double dy = std::max({ylo - point[1], point[1] - ylo - width, 0.0});
  const double dz = std::max({zlo[c] - point[2], point[2] - zhi[c], 0.0});
  return (dx * dx + dy * dy + dz * dz) * (1.0 - 1.0e-12);
}

/* ---------------------------------------------------------------------- */

double SkinColumns::memory_usage() const
{
  return (double) (x[0].capacity() + x[1].capacity() + x[2].capacity() + zlo.capacity() +
                   zhi.capacity()) * sizeof(double) +
      (double) (first.capacity() + index.capacity() + column_of.capacity() + slot.capacity() +
                chosen.capacity()) * sizeof(int);
}
