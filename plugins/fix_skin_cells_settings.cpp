// arguments of fix skin/cells

#include "fix_skin_cells.h"

#include "atom.h"
#include "error.h"
#include "group.h"
#include "utils.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <string>
#include <vector>

using namespace LAMMPS_NS;

namespace {

// a numeric argument and what is allowed for it

enum Allowed { ANY, NOT_NEGATIVE, POSITIVE };

double number(const std::string &keyword, const char *text, Allowed allowed, LAMMPS *lmp)
{
  const double value = utils::numeric(FLERR, text, false, lmp);
  if (!std::isfinite(value) || (allowed == POSITIVE && !(value > 0.0)) ||
      (allowed == NOT_NEGATIVE && !(value >= 0.0)))
    lmp->error->all(FLERR, "Fix skin/cells {} = {}: must be a number{}", keyword, text,
                    allowed == POSITIVE ? " > 0" : allowed == NOT_NEGATIVE ? " >= 0" : "");
  return value;
}

}    // namespace

/* ---------------------------------------------------------------------- */

void FixSkinCells::parse(int narg, char **arg)
{
  if (narg < 4) utils::missing_cmd_args(FLERR, "fix skin/cells", error);

  seed = utils::bnumeric(FLERR, arg[3], false, lmp);
  if (seed <= 0) error->all(FLERR, "Fix skin/cells seed = {}: must be an integer > 0", arg[3]);

  std::vector<std::string> required = {"membrane", "contact",     "adhesion", "binding", "cycle",
                                       "spring",   "generations", "offset"};
  kind_of_type.assign(atom->ntypes + 1, NONE);

  int iarg = 4;
  while (iarg < narg) {
    const std::string keyword = arg[iarg];
    const auto given = std::find(required.begin(), required.end(), keyword);
    if (given != required.end()) required.erase(given);

    auto values = [&](int n) {
      if (iarg + n >= narg)
        error->all(FLERR, "Fix skin/cells {} needs {} value(s) but got {}", keyword, n,
                   narg - iarg - 1);
      char **first = &arg[iarg + 1];
      iarg += n + 1;
      return first;
    };
    auto type = [&]() {
      const char *text = values(1)[0];
      const int itype = utils::expand_type_int(FLERR, text, Atom::ATOM, lmp);
      if (itype < 1 || itype > atom->ntypes)
        error->all(FLERR, "Fix skin/cells {} = {}: there are atom types 1 to {}", keyword, text,
                   atom->ntypes);
      return itype;
    };
    auto kind = [&](int k) {
      type_of_kind[k] = type();
      if (kind_of_type[type_of_kind[k]] != NONE)
        error->all(FLERR, "Fix skin/cells {}: atom type {} is named twice", keyword,
                   type_of_kind[k]);
      kind_of_type[type_of_kind[k]] = k;
    };

    if (keyword == "membrane") {
      membrane_type = type();
    } else if (keyword == "stem") {
      kind(STEM);
    } else if (keyword == "ta") {
      kind(TA);
    } else if (keyword == "exhausted") {
      kind(EXHAUSTED);
    } else if (keyword == "nd") {
      kind(ND);
    } else if (keyword == "contact") {
      contact = number(keyword, values(1)[0], POSITIVE, lmp);
    } else if (keyword == "core") {
      core = number(keyword, values(1)[0], NOT_NEGATIVE, lmp);
    } else if (keyword == "adhesion") {
      char **v = values(2);
      adhesion_stiffness = number("adhesion K", v[0], NOT_NEGATIVE, lmp);
      adhesion_range = number("adhesion lambda", v[1], POSITIVE, lmp);
      if (adhesion_range <= 1.0)
        error->all(FLERR, "Fix skin/cells adhesion lambda = {}: must be > 1", v[1]);
    } else if (keyword == "binding") {
      binding_stiffness = number(keyword, values(1)[0], NOT_NEGATIVE, lmp);
    } else if (keyword == "cycle") {
      char **v = values(3);
      cycle_delay = number("cycle T0", v[0], NOT_NEGATIVE, lmp);
      cycle_rate = number("cycle gamma", v[1], POSITIVE, lmp);
      first_phase = number("cycle first phase", v[2], NOT_NEGATIVE, lmp);
    } else if (keyword == "generations") {
      const char *text = values(1)[0];
      generations = utils::inumeric(FLERR, text, false, lmp);
      if (generations < 0)
        error->all(FLERR, "Fix skin/cells generations = {}: must be an integer >= 0", text);
    } else if (keyword == "spring") {
      char **v = values(4);
      spring_stiffness = number("spring K", v[0], NOT_NEGATIVE, lmp);
      spring_start = number("spring start", v[1], NOT_NEGATIVE, lmp);
      spring_rate = number("spring rate", v[2], POSITIVE, lmp);
      spring_end = number("spring end", v[3], POSITIVE, lmp);
      if (spring_end <= spring_start)
        error->all(FLERR, "Fix skin/cells spring: its end {} must be longer than its start {}",
                   v[3], v[1]);
    } else if (keyword == "offset") {
      half_separation = number(keyword, values(1)[0], POSITIVE, lmp);
    } else if (keyword == "every") {
      const char *text = values(1)[0];
      every = utils::inumeric(FLERR, text, false, lmp);
      if (every < 1) error->all(FLERR, "Fix skin/cells every = {}: must be an integer >= 1", text);
    } else if (keyword == "next_id") {
      const char *text = values(1)[0];
      next_id = utils::bnumeric(FLERR, text, false, lmp);
      if (next_id < 1 || next_id > MAXTAGINT)
        error->all(FLERR, "Fix skin/cells next_id = {}: must be an integer from 1 to {}", text,
                   MAXTAGINT);
    } else if (keyword == "inherit") {
      const char *text = values(1)[0];
      const int igroup = group->find(text);
      if (igroup < 0)
        error->all(FLERR, "Fix skin/cells inherit = {}: there is no such group", text);
      inherited_groups |= group->bitmask[igroup];
    } else if (keyword == "log") {
      log.set_file(values(1)[0]);
    } else {
      error->all(FLERR, "Unknown fix skin/cells keyword: {}", keyword);
    }
  }

  if (!required.empty()) error->all(FLERR, "Fix skin/cells needs the keyword {}", required[0]);
  if (kind_of_type[membrane_type] != NONE)
    error->all(FLERR, "Fix skin/cells: atom type {} is both membrane and cell", membrane_type);
  if (type_of_kind[STEM] && (!type_of_kind[TA] || !type_of_kind[EXHAUSTED]))
    error->all(FLERR, "Fix skin/cells: stem cells need the keywords ta and exhausted too");
  if (type_of_kind[TA] && !type_of_kind[EXHAUSTED])
    error->all(FLERR, "Fix skin/cells: TA cells need the keyword exhausted too");
}
