#ifndef LMP_DIHEDRAL_SKIN_BEND_H
#define LMP_DIHEDRAL_SKIN_BEND_H

#include "dihedral.h"

#include <vector>

namespace LAMMPS_NS {

class DihedralSkinBend : public Dihedral {
 public:
  DihedralSkinBend(class LAMMPS *);
  ~DihedralSkinBend() override;
  void compute(int, int) override;
  void coeff(int, char **) override;
  void init_style() override;
  void write_restart(FILE *) override;
  void read_restart(FILE *) override;
  void write_data(FILE *) override;
  double memory_usage() override;

 private:
  struct Triangle {
    int vertex[3];
    int across[3];    // triangle on the other side of the link opposite to each vertex
    int type[3];      // dihedral type of that link
  };
  struct Normal {
    double unit[3];
    double inverse;    // 1 / length of the unnormalised normal
  };

  double *stiffness;

  bigint built_call, built_step;    // the neighbor build the triangles belong to
  std::vector<Triangle> triangles;
  std::vector<Normal> normals;
  std::vector<int> first_of_vertex, next_of_triangle;    // triangles by their first vertex

  void allocate();
  void build_triangles();
  int find_triangle(int, int, int);
  void hinge(int, int, int, int);
  void compute_normals();
  template <bool TALLY> void compute_forces();
  void tally_energy(const Triangle &, int, double);
  void tally_virial(const Triangle &, const double *, const double *, const double *,
                    const double *);
  void degenerate(int);
};

}    // namespace LAMMPS_NS

#endif
