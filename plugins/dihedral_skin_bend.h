#ifndef LMP_DIHEDRAL_SKIN_BEND_H
#define LMP_DIHEDRAL_SKIN_BEND_H

#include "dihedral.h"

#include <vector>

namespace LAMMPS_NS {

class DihedralSkinBend : public Dihedral {
 public:
  explicit DihedralSkinBend(class LAMMPS *);
  ~DihedralSkinBend() override;
  void compute(int, int) override;
  void coeff(int, char **) override;
  void init_style() override;
  void write_restart(FILE *) override;
  void read_restart(FILE *) override;
  void write_data(FILE *) override;
  double memory_usage() override;
  void add_stiffness(double *) const;
  int find_inverted() const;
  void inverted(int, double) const;

 private:
  double *stiffness;

  // the distinct triangles of my links, one array for each component, so that the loops over
  // them vectorise

  int ntriangles;
  std::vector<int> corner[3];
  std::vector<int> across[3];       // triangle across the link opposite to each corner
  std::vector<int> type[3];         // dihedral type of that link
  std::vector<double> normal[3];    // unit normal
  std::vector<double> inverse;      // 1 / length of the unnormalised normal
  std::vector<double> push[6];      // forces on corners 1 and 2

  bigint built_call, built_step;    // the neighbor build the triangles belong to
  std::vector<int> first_of_vertex, next_of_triangle;    // triangles by their first corner

  void allocate();
  void build_triangles();
  int find_triangle(int, int, int);
  void hinge(int, int, int, int);
  void add_forces();
  void tally_energy();
  void tally_virial();
  void degenerate(int);
  double least_fold(int) const;
};

}    // namespace LAMMPS_NS

#endif
