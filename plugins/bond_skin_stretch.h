#ifndef LMP_BOND_SKIN_STRETCH_H
#define LMP_BOND_SKIN_STRETCH_H

#include "bond.h"

#include "skin_build.h"
#include "skin_links.h"
#include "skin_stretch_forces.h"

namespace LAMMPS_NS {

class BondSkinStretch : public Bond {
 public:
  explicit BondSkinStretch(class LAMMPS *);
  ~BondSkinStretch() override;
  void compute(int, int) override;
  void coeff(int, char **) override;
  void init_style() override;
  double equilibrium_distance(int) override;
  void write_restart(FILE *) override;
  void read_restart(FILE *) override;
  void write_data(FILE *) override;
  double single(int, double, int, int, double &) override;
  void *extract(const char *, int &) override;
  void reinit() override;
  double memory_usage() override;
  void add_stiffness(double *);

  // for integrators that can take back a step: while links are spared, those that are as long as
  // their singular length do not end the run, and it is remembered that there were some

  void spare_links(bool);
  bool had_broken() const { return broken; }
  bool any_broken() const;

 private:
  static constexpr int NCOEFFS = 5;

  // K, contact length, a2, d2, scale of the spring-like part: each of them for all types

  double **coeffs;
  SkinLinks links;
  SkinBuild build;    // that they belong to
  bool sparing, broken;

  void allocate();
  void tally();
  void check(int, double, const std::string &) const;
  SkinStretch of_type(int) const;
  double length(int) const;
  double singular(int) const;
  void overstretched(int) const;
};

}    // namespace LAMMPS_NS

#endif
