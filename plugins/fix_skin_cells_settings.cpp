// arguments of fix skin/cells

#include "fix_skin_cells.h"

#include "skin_arguments.h"
#include "skin_model_kinds.h"

#include "atom.h"
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

  divisions.seed = utils::bnumeric(FLERR, arg[3], false, lmp);
  if (divisions.seed <= 0)
    error->all(FLERR, "Fix skin/cells seed = {}: must be an integer > 0", arg[3]);

  std::vector<std::string> required = {"membrane", "contact", "spring", "offset"};
  SkinModelKinds model;
  SkinArguments arguments(lmp, "Fix skin/cells", narg - 4, arg + 4);

  while (!arguments.at_end()) {
    const std::string keyword = arguments.keyword();
    const auto given = std::find(required.begin(), required.end(), keyword);
    if (given != required.end()) required.erase(given);

    if (keyword == "membrane") {
      attachment.membrane_type = arguments.atom_type();
    } else if (keyword == "kind") {
      cells.kinds.add(arguments);
    } else if (keyword == "contact") {
      attachment.contact = arguments.number(SkinArguments::POSITIVE);
    } else if (keyword == "core") {
      attachment.core = arguments.number(SkinArguments::NOT_NEGATIVE);
    } else if (keyword == "spring") {
      pairs.read_spring(arguments);
    } else if (keyword == "offset") {
      divisions.half_separation = arguments.number(SkinArguments::POSITIVE);
    } else if (keyword == "pairs") {
      arguments.need(2);
      const std::string stay = arguments.word(), value = arguments.word();
      if (stay != "stay" || (value != "yes" && value != "no"))
        error->all(FLERR, "Fix skin/cells pairs = {} {}: must be stay yes or stay no", stay, value);
      pairs.stay = value == "yes";
    } else if (keyword == "apart") {
      pairs.apart = arguments.number(SkinArguments::NOT_NEGATIVE);
    } else if (keyword == "every") {
      every = (int) arguments.integer(1);
    } else if (keyword == "next_id") {
      lineage.next_id = arguments.integer(1, MAXTAGINT);
    } else if (keyword == "inherit") {
      const std::string name = arguments.word();
      const int igroup = group->find(name);
      if (igroup < 0)
        error->all(FLERR, "Fix skin/cells inherit = {}: there is no such group", name);
      divisions.inherited_groups |= group->bitmask[igroup];
    } else if (keyword == "intervene") {
      interventions.add(arguments);
    } else if (keyword == "intervened") {
      interventions.pass(arguments.number(SkinArguments::NOT_NEGATIVE));
    } else if (keyword == "log") {
      lineage.log.set_file(arguments.word().c_str());
    } else if (!model.read(keyword, arguments)) {
      error->all(FLERR, "Unknown fix skin/cells keyword: {}", keyword);
    }
  }

  if (!required.empty()) error->all(FLERR, "Fix skin/cells needs the keyword {}", required[0]);
  model.add_to(cells.kinds, error);
  if (!cells.kinds.size()) error->all(FLERR, "Fix skin/cells needs the keyword kind");
  cells.kinds.complete();
  interventions.complete(cells.kinds);
  const int type = attachment.membrane_type;
  if (cells.kinds.of_type(type))
    error->all(FLERR, "Fix skin/cells: atom type {} is both membrane and kind {}", type,
               cells.kinds[cells.kinds.of_type(type)].name);
}

/* ----------------------------------------------------------------------
   fix_modify: other values of a kind from now on
------------------------------------------------------------------------- */

int FixSkinCells::modify_param(int narg, char **arg)
{
  SkinArguments arguments(lmp, "Fix skin/cells", narg, arg);
  if (arguments.keyword() != "kind") return 0;
  const SkinCellKinds before = cells.kinds;
  const int kind = cells.kinds.change(arguments);
  if (cells.kinds[kind].limited() && !before[kind].limited()) begin_to_count(kind);
  reach_checked = false;
  return arguments.used();
}

/* ----------------------------------------------------------------------
   cells of a kind that was endless and has generations now: those that had no divisions to count
   have all of them, or their next division is their last
------------------------------------------------------------------------- */

void FixSkinCells::begin_to_count(int kind)
{
  cells.find_state();
  for (int i = 0; i < atom->nlocal; i++)
    if (cells.kind_of(i) == kind && cells.state.divisions_left[i] == 0)
      cells.state.divisions_left[i] = std::max(cells.kinds[kind].generations, 1);
}
