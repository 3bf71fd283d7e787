#ifndef LMP_FIX_SKIN_MOTION_H
#define LMP_FIX_SKIN_MOTION_H

#include "fix.h"

namespace LAMMPS_NS {

class FixSkinMotion : public Fix {
 public:
  FixSkinMotion(class LAMMPS *, int, char **);
  int setmask() override;
  void init() override;
  void initial_integrate(int) override;
  double compute_vector(int) override;

 private:
  double largest_move;           // of any particle in one substep
  bigint refined, substeps;      // steps that were divided, and into how many in all

  struct Fastest {
    double force;
    int rank;
  };

  Fastest find_fastest(int &) const;
  void move(double);
  void evaluate_forces();
  void unstable(const Fastest &, int, double) const;
};

}    // namespace LAMMPS_NS

#endif
