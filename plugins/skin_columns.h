// Particles of some types, owned and ghost, sorted into columns over the xy plane, and those of
// them that are near some place: a search looks at few columns.

#ifndef LMP_SKIN_COLUMNS_H
#define LMP_SKIN_COLUMNS_H

#include <algorithm>
#include <cmath>
#include <vector>

namespace LAMMPS_NS {

class Atom;

// particles around a place

struct SkinSurroundings {
  std::vector<double> x[3];
  std::vector<int> index;    // local ones
  double zlo = 0.0, zhi = 0.0;
  std::vector<double> distsq;    // from the point of the last call

  // entries within a radius of a point, those before a given one left out, valid until the next
  // call

  struct Found {
    const int *begin, *end;
  };
  Found within(const double *point, double radius, int first = 0);
  double memory_usage() const;

 private:
  std::vector<int> hits;
};

class SkinColumns {
 public:
  // wanted has one entry for each type

  void sort(const Atom *, const std::vector<char> &wanted);

  int ncolumns[2] = {0, 0};
  double width = 0.0;
  std::vector<int> first;    // first particle of each column, one entry more at the end

  // particles in the order of columns: coordinates, local index

  std::vector<double> x[3];
  std::vector<int> index;

  double distance_squared(int k, const double *point) const
  {
    const double dx = x[0][k] - point[0], dy = x[1][k] - point[1], dz = x[2][k] - point[2];
    return dx * dx + dy * dy + dz * dz;
  }

  int column(int dim, double coordinate) const
  {
    const double c = (coordinate - lo[dim]) * per_width;
    return (int) std::min(std::max(c, 0.0), (double) (ncolumns[dim] - 1));
  }

  // lower bound for the distance of a point to the particles of a column, a hair's breadth less

  double distance_squared_to_column(int ix, int iy, const double *point) const;

  // all particles that can be within a radius of points in a box, and some more, in the order of
  // columns, of which those before a given one are left out

  void around(const double *boxlo, const double *boxhi, double radius, SkinSurroundings &,
              int first_column = 0) const;

  double memory_usage() const;

 private:
  double lo[2] = {0.0, 0.0}, per_width = 0.0;
  std::vector<double> zlo, zhi;    // extent of each column's particles
  std::vector<int> chosen, column_of, slot;
};

}    // namespace LAMMPS_NS

#endif
