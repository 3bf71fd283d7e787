// Stages of one step of forward Euler or of a Runge-Kutta-Legendre method (Meyer, Balsara, Aslam
// 2014): Y_j = previous Y_(j-1) + before Y_(j-2) + start Y_0 + dt (force F_(j-1) + first F_0),
// reached at the part `time` of the step. The real interval of stability is `reach` of it.

#ifndef LMP_SKIN_STAGES_H
#define LMP_SKIN_STAGES_H

#include <vector>

namespace LAMMPS_NS {

struct SkinStage {
  double previous = 0.0, before = 0.0, start = 0.0, force = 0.0, first = 0.0, time = 0.0;
};

struct SkinStages {
  std::vector<SkinStage> stages;
  double reach = 0.0;    // dt times the largest eigenvalue must stay below this
  int order = 1;         // above 1, mobilities have to be those of each stage

  static SkinStages first_order(int);
  static SkinStages second_order(int);
};

// one stage for n coordinates whose forces act for this time; returns the largest square of the way
// of one of them since the start of the step, infinite for what is no number

double skin_advance(const SkinStage &, double time, int n, double *x, double *before,
                    const double *start, const double *f);

}    // namespace LAMMPS_NS

#endif
