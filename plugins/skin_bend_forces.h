// Forces of bending. Normals are computed once per triangle; a second pass gathers those of the
// triangles across its links, which give dE/dN, and turns that into forces on its corners.

#ifndef LMP_SKIN_BEND_FORCES_H
#define LMP_SKIN_BEND_FORCES_H

#include "skin_quad.h"
#include "skin_triangles.h"

namespace LAMMPS_NS {

// smallest length of an unnormalised normal (twice a triangle's area) that has a direction

static constexpr double SKIN_SMALLEST_NORMAL = 1.0e-10;

// forces on all corners, K of each dihedral type in stiffness; stores the unit normals of all
// triangles and 1 / length of the unnormalised ones, four numbers for each

struct SkinFolds {
  double without_normal;    // triangles that have none
  double inverted;          // folded by more than the angle with cosine least against all around
};                          // them, or pairs of which one is

SkinFolds skin_bend(const SkinTriangles &, const double *x, const double *stiffness, int ntypes,
                    double least, double *normal, double *f);

// forces of one triangle on its corners 1 and 2

struct SkinPush {
  SkinPoint<double> one, two;
};

SkinPush skin_push(const SkinTriangles &, int, const double *x, const double *stiffness,
                   const double *normal);

// cosine of the angle between a triangle and the one across the link opposite to a corner

double skin_cosine(const SkinTriangles &, int, int corner, const double *normal);

}    // namespace LAMMPS_NS

#endif
