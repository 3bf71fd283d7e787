// Forces of bending. Normals are computed once per triangle; a second pass gathers those of the
// triangles across its links, which give dE/dN, and turns that into forces on its corners.

#ifndef LMP_SKIN_BEND_FORCES_H
#define LMP_SKIN_BEND_FORCES_H

#include "skin_double4.h"
#include "skin_triangles.h"

namespace LAMMPS_NS {

// smallest length of an unnormalised normal (twice a triangle's area) that has a direction

static constexpr double SKIN_SMALLEST_NORMAL = 1.0e-10;

// energy of a fold as a function of the cosine c of its angle: K (1 - c)^2 / 2, and below the
// limit, which is 0 or none, K (1/(1 + c) - 1/2), which has no end as the fold closes

struct SkinFoldLaw {
  static constexpr double NO_LIMIT = -2.0;

  const double *stiffness, *limit;    // K and the limit of each dihedral type
  int ntypes;
  bool limited;    // whether any type has a limit

  double energy(int type, double c) const
  {
    const double e = c < limit[type] ? 1.0 / (1.0 + c) - 0.5 : 0.5 * (1.0 - c) * (1.0 - c);
    return stiffness[type] * e;
  }

  // a bound for the second derivative by the angle

  double curvature(int type, double c) const
  {
    const double e = c < limit[type] ? (3.0 - 2.0 * c) / ((1.0 + c) * (1.0 + c))
                                     : (1.0 - c) * (2.0 + c);
    return stiffness[type] * e;
  }
};

// forces on all corners; stores the unit normals of all triangles and 1 / length of the
// unnormalised ones, four numbers for each

struct SkinFolds {
  double without_normal;    // triangles that have none
  double inverted;          // folded by more than the angle with cosine least against all around
};                          // them, or pairs of which one is

SkinFolds skin_bend(const SkinTriangles &, const double *x, const SkinFoldLaw &, double least,
                    double *normal, double *f);

// energy of all folds

double skin_bend_energy(const SkinTriangles &, const SkinFoldLaw &, const double *normal);

// forces of one triangle on its corners 1 and 2

struct SkinCornerForces {
  SkinPoint<double> one, two;
};

SkinCornerForces skin_corner_forces(const SkinTriangles &, int, const double *x,
                                    const SkinFoldLaw &, const double *normal);

// cosine of the angle between a triangle and the one across the link opposite to a corner

double skin_cosine(const SkinTriangles &, int, int corner, const double *normal);

}    // namespace LAMMPS_NS

#endif
