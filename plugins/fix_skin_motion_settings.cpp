// arguments of fix skin/motion

#include "fix_skin_motion.h"

#include "atom.h"
#include "error.h"

#include <cmath>
#include <string>

using namespace LAMMPS_NS;

static constexpr int MOST_STAGES = 99;

// positions cannot be rounded to less

static constexpr double FINEST = 1.0e-12;

/* ---------------------------------------------------------------------- */

void FixSkinMotion::parse(int narg, char **arg)
{
  if (narg < 4) error->all(FLERR, "Fix skin/motion needs a method: euler, rkl1 or rkl2");
  const std::string name = arg[3];
  if (name != "euler" && name != "rkl1" && name != "rkl2")
    error->all(FLERR, "Fix skin/motion method = {}: must be euler, rkl1 or rkl2", name);

  int nstages = (name == "euler") ? 1 : 7;
  auto positive = [&](const std::string &key, const char *text) {
    const double value = utils::numeric(FLERR, text, false, lmp);
    if (!(value > 0.0))
      error->all(FLERR, "Fix skin/motion {} = {}: must be a number > 0", key, text);
    return value;
  };

  for (int n = 4; n < narg;) {
    const std::string key = arg[n];
    if (key != "stages" && key != "stiffness" && key != "move" && key != "link" &&
        key != "round" && key != "margins")
      error->all(FLERR, "Unknown fix skin/motion keyword: {}", key);
    const int nvalues = (key == "margins")             ? atom->ntypes
        : (key == "round" || key == "link") ? 2
                                            : 1;
    if (n + nvalues >= narg)
      error->all(FLERR, "Fix skin/motion keyword {} needs {} value(s)", key, nvalues);
    char **values = &arg[n + 1];
    n += 1 + nvalues;
    if (key == "stages") {
      nstages = utils::inumeric(FLERR, values[0], false, lmp);
      const int least = (name == "euler") ? 1 : (name == "rkl1") ? 2 : 3;
      const int most = (name == "euler") ? 1 : MOST_STAGES;
      if (nstages < least || nstages > most)
        error->all(FLERR, "Fix skin/motion {} stages = {}: must be {} to {}", name, values[0],
                   least, most);
    } else if (key == "link") {
      shortest_link = positive(key, values[0]);
      longest_link = positive(key, values[1]);
      if (longest_link <= shortest_link)
        error->all(FLERR, "Fix skin/motion link {} {}: the second must be larger than the first",
                   values[0], values[1]);
    } else if (key == "round") {
      rounding = positive(key, values[0]);
      if (rounding < FINEST)
        error->all(FLERR, "Fix skin/motion round = {}: must be at least {}", values[0], FINEST);
      round_every = utils::bnumeric(FLERR, values[1], false, lmp);
      if (round_every < 1)
        error->all(FLERR, "Fix skin/motion round {} {}: the number of steps must be > 0",
                   values[0], values[1]);
    } else if (key == "margins") {
      margins.assign(1, 1.0);
      for (int type = 1; type <= nvalues; type++) {
        margins.push_back(positive(key, values[type - 1]));
        if (margins[type] > 1.0)
          error->all(FLERR, "Fix skin/motion margins = {} for type {}: must be a number > 0 and "
                     "<= 1", values[type - 1], type);
      }
    } else {
      (key == "move" ? largest_move : stiffness_limit) = positive(key, values[0]);
    }
  }
  method = name == "rkl2" ? SkinStages::second_order(nstages) : SkinStages::first_order(nstages);
}
