#ifndef LMP_DIHEDRAL_SKIN_BEND_H
#define LMP_DIHEDRAL_SKIN_BEND_H

#include "dihedral.h"

#include "skin_bend_forces.h"
#include "skin_build.h"
#include "skin_inverted.h"
#include "skin_triangles.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

class DihedralSkinBend : public Dihedral {
 public:
  explicit DihedralSkinBend(class LAMMPS *);
  ~DihedralSkinBend() override;
  void compute(int, int) override;
  void coeff(int, char **) override;
  void init() override;
  void init_style() override;
  void write_restart(FILE *) override;
  void read_restart(FILE *) override;
  void write_data(FILE *) override;
  void *extract(const char *, int &) override;
  double memory_usage() override;
  void add_stiffness(double *) const;
  bool find_inverted();
  void inverted(double, bool at_start) const;

 private:
  double *stiffness;
  double *limit;    // cosine of a fold below which its energy diverges

  SkinTriangles triangles;
  SkinBuild build;                  // that the triangles belong to
  std::vector<double> normal;       // of each triangle: unit normal, 1 / length of the other
  double ninverted;                 // of the last compute(), or a little more
  SkinInverted inverted_triangles;

  void allocate();
  bool diverges(int type) const { return limit[type] == 0.0; }
  SkinFoldLaw law() const;
  double cosine(int, int) const;
  void tally_energy();
  void tally_virial();
  void degenerate(int);
  void check(double, const std::string &) const;
};

}    // namespace LAMMPS_NS

#endif
