// Stages of one step of forward Euler or of a Runge-Kutta-Legendre method (Meyer, Balsara, Aslam
// 2014): Y_j = previous Y_(j-1) + before Y_(j-2) + start Y_0 + dt (force F_(j-1) + first F_0),
// reached at the part `time` of the step. The real interval of stability is `reach` of it.

#ifndef LMP_SKIN_STAGES_H
#define LMP_SKIN_STAGES_H

#include <vector>

namespace LAMMPS_NS {

struct SkinStage {
  double previous, before, start, force, first, time;
};

struct SkinStages {
  std::vector<SkinStage> stages;
  double reach;    // dt times the largest eigenvalue must stay below this

  static SkinStages euler();
  static SkinStages first_order(int);
  static SkinStages second_order(int);
};

}    // namespace LAMMPS_NS

#endif
