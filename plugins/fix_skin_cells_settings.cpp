// arguments of fix skin/cells

#include "fix_skin_cells.h"

#include "skin_arguments.h"

#include "error.h"
#include "group.h"
#include "utils.h"

#include <algorithm>
#include <string>
#include <vector>

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

void FixSkinCells::parse(int narg, char **arg)
{
  if (narg < 4) utils::missing_cmd_args(FLERR, "fix skin/cells", error);

  seed = utils::bnumeric(FLERR, arg[3], false, lmp);
  if (seed <= 0) error->all(FLERR, "Fix skin/cells seed = {}: must be an integer > 0", arg[3]);

  std::vector<std::string> required = {"membrane", "kind", "contact", "spring", "offset"};
  SkinArguments arguments(lmp, "Fix skin/cells", narg - 4, arg + 4);

  while (!arguments.at_end()) {
    const std::string keyword = arguments.keyword();
    const auto given = std::find(required.begin(), required.end(), keyword);
    if (given != required.end()) required.erase(given);

    if (keyword == "membrane") {
      membrane_type = arguments.atom_type();
    } else if (keyword == "kind") {
      kinds.add(arguments);
    } else if (keyword == "contact") {
      contact = arguments.number(SkinArguments::POSITIVE);
    } else if (keyword == "core") {
      core = arguments.number(SkinArguments::NOT_NEGATIVE);
    } else if (keyword == "spring") {
      arguments.need(4);
      spring_stiffness = arguments.number(SkinArguments::NOT_NEGATIVE, "K");
      spring_start = arguments.number(SkinArguments::NOT_NEGATIVE, "start");
      spring_rate = arguments.number(SkinArguments::POSITIVE, "rate");
      spring_end = arguments.number(SkinArguments::POSITIVE, "end");
      if (spring_end <= spring_start)
        error->all(FLERR, "Fix skin/cells spring: its end {} must be longer than its start {}",
                   spring_end, spring_start);
    } else if (keyword == "offset") {
      half_separation = arguments.number(SkinArguments::POSITIVE);
    } else if (keyword == "pairs") {
      arguments.need(2);
      const std::string stay = arguments.word(), value = arguments.word();
      if (stay != "stay" || (value != "yes" && value != "no"))
        error->all(FLERR, "Fix skin/cells pairs = {} {}: must be stay yes or stay no", stay, value);
      pairs_stay = value == "yes";
    } else if (keyword == "apart") {
      apart = arguments.number(SkinArguments::NOT_NEGATIVE);
    } else if (keyword == "every") {
      every = (int) arguments.integer(1);
    } else if (keyword == "next_id") {
      next_id = arguments.integer(1, MAXTAGINT);
    } else if (keyword == "inherit") {
      const std::string name = arguments.word();
      const int igroup = group->find(name);
      if (igroup < 0)
        error->all(FLERR, "Fix skin/cells inherit = {}: there is no such group", name);
      inherited_groups |= group->bitmask[igroup];
    } else if (keyword == "intervene") {
      interventions.add(arguments);
    } else if (keyword == "log") {
      log.set_file(arguments.word().c_str());
    } else {
      error->all(FLERR, "Unknown fix skin/cells keyword: {}", keyword);
    }
  }

  if (!required.empty()) error->all(FLERR, "Fix skin/cells needs the keyword {}", required[0]);
  kinds.complete();
  interventions.complete(kinds);
  if (kinds.of_type(membrane_type))
    error->all(FLERR, "Fix skin/cells: atom type {} is both membrane and kind {}", membrane_type,
               kinds[kinds.of_type(membrane_type)].name);
}

/* ----------------------------------------------------------------------
   fix_modify: other values of a kind from now on
------------------------------------------------------------------------- */

int FixSkinCells::modify_param(int narg, char **arg)
{
  SkinArguments arguments(lmp, "Fix skin/cells", narg, arg);
  if (arguments.keyword() != "kind") return 0;
  kinds.change(arguments);
  return arguments.used();
}
