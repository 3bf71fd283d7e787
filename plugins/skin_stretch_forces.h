// Stretch of membrane links as a function of their length, and the forces of all links of a type.

#ifndef LMP_SKIN_STRETCH_FORCES_H
#define LMP_SKIN_STRETCH_FORCES_H

#include "skin_links.h"

#include <array>

namespace LAMMPS_NS {

// K, contact length, a2, d2, scale of the spring-like part

typedef std::array<double, 5> SkinStretch;

// energy, -dE/dr / r and second derivative of one link

double skin_stretch_energy(const SkinStretch &, double r);
double skin_stretch_slope(const SkinStretch &, double rsq);
double skin_stretch_curvature(const SkinStretch &, double r);

// forces of links of one type; returns how many are at their singular length or beyond

double skin_stretch(const SkinLinks::Group &, const double *x, const SkinStretch &, double *f);

// energy of links of one type

double skin_stretch_energies(const SkinLinks::Group &, const double *x, const SkinStretch &);

}    // namespace LAMMPS_NS

#endif
