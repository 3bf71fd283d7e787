// state and settings with which cells cannot be, in fix skin/cells

#include "fix_skin_cells.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "group.h"
#include "input.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

using namespace LAMMPS_NS;

/* ----------------------------------------------------------------------
   what a cell says of itself
------------------------------------------------------------------------- */

void FixSkinCells::check_cell(int i) const
{
  const int kind = kind_of(i);
  const int m = state.divisions_left[i];
  if (kind == NONE) return;

  if (m < 0 || (kinds[kind].limited() && m == 0) || (kinds[kind].spent && m != 0))
    error->one(FLERR, "Fix skin/cells: cell {} is of kind {} and has {} divisions left",
               atom->tag[i], kinds[kind].name, m);
  if (state.pair[i] == atom->tag[i] || state.pair[i] < 0 || state.pair[i] >= next_id)
    error->one(FLERR, "Fix skin/cells: cell {} is paired with {}, which is no other cell",
               atom->tag[i], state.pair[i]);

  for (const int *bonus : {atom->ellipsoid, atom->line, atom->tri, atom->body})
    if (bonus && bonus[i] >= 0)
      error->one(FLERR, "Fix skin/cells: cell {} is an ellipsoid, a line, a triangle or a body, "
                 "which cannot divide", atom->tag[i]);
  if (state.parent[i] == atom->tag[i])
    error->one(FLERR, "Fix skin/cells: parent = {} of cell {} must be another cell, or 0 for none",
               state.parent[i], atom->tag[i]);
  for (const auto &[name, value] : {std::pair{"divisions_done", state.divisions_done[i]},
                                    std::pair{"parent", state.parent[i]}})
    if (value < 0)
      error->one(FLERR, "Fix skin/cells: {} = {} of cell {} must be >= 0", name, value,
                 atom->tag[i]);
  for (const auto &[name, value] : {std::pair{"next_division", state.next_division[i]},
                                    std::pair{"birth_time", state.birth_time[i]},
                                    std::pair{"pair_start", state.pair_start[i]},
                                    std::pair{"detached_time", state.detached_time[i]}})
    if (!std::isfinite(value))
      error->one(FLERR, "Fix skin/cells: {} = {} of cell {} must be finite", name, value,
                 atom->tag[i]);
}

/* ----------------------------------------------------------------------
   what other fixes and commands cannot do beside this one
------------------------------------------------------------------------- */

void FixSkinCells::check_others() const
{
  if (modify->get_fix_by_style("^skin/cells$").size() > 1)
    error->all(FLERR, "Fix skin/cells can be used once: unfix the other one first, and let one fix "
               "have all cells in its group");
  if (utils::strmatch(update->integrate_style, "^respa"))
    error->all(FLERR, "Fix skin/cells does not work with run_style respa: use run_style verlet");
  if (std::strcmp(input->command, "rerun") == 0)
    error->all(FLERR, "Fix skin/cells does not work with rerun: a dump lacks the state of cells; "
               "use read_restart and run 0");

  for (const Fix *fix : modify->get_fix_list()) {
    if (!fix->rigid_flag && !fix->time_integrate) continue;
    int mine = 0, any;
    for (int i = 0; i < atom->nlocal; i++)
      if (kind_of(i) != NONE && (atom->mask[i] & fix->groupbit)) mine = 1;
    MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
    if (!any) continue;
    if (fix->rigid_flag)
      error->all(FLERR, "Fix skin/cells: cells cannot divide in the rigid bodies of fix {}",
                 fix->id);
    const int known = 1 | groupbit | inherited_groups;
    if (!(fix->groupbit & known) && !group->dynamic[fix->igroup] && comm->me == 0)
      error->warning(FLERR, "Fix skin/cells: daughters will not be in the group {} of fix {}, "
                     "which moves some of the cells: if they should, use inherit {}",
                     group->names[fix->igroup], fix->id, group->names[fix->igroup]);
  }
}

/* ----------------------------------------------------------------------
   how far ghost atoms reach; LAMMPS has it in fractions of a triclinic box
------------------------------------------------------------------------- */

double FixSkinCells::ghost_cutoff() const
{
  const double *const cutoff = comm->cutghost;
  if (domain->triclinic) return cutoff[2] * domain->prd[2];
  return std::min({cutoff[0], cutoff[1], cutoff[2]});
}

/* ----------------------------------------------------------------------
   ghost particles must reach far enough to hold the nearest membrane particle of any cell
   that is not yet detached, now and until the next neighbor build
------------------------------------------------------------------------- */

void FixSkinCells::check_reach() const
{
  const double reach = kinds.longest_range() * contact + 2.0 * neighbor->skin;
  if (comm->mode != Comm::SINGLE)
    error->all(FLERR, "Fix skin/cells needs one communication cutoff for all types: use "
               "comm_modify mode single");
  if (ghost_cutoff() < reach)
    error->all(FLERR, "Fix skin/cells needs a communication cutoff of at least {} but has {}: use "
               "comm_modify cutoff", reach, ghost_cutoff());
}
