// settings, commands and other fixes with which fix skin/cells does not work

#include "fix_skin_cells.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "group.h"
#include "input.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"

#include <cstring>

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

void FixSkinCells::check_settings() const
{
  if (!force->newton) error->all(FLERR, "Fix skin/cells needs newton on");
  if (atom->molecular != Atom::MOLECULAR || atom->maxspecial < 1)
    error->all(FLERR, "Fix skin/cells needs an atom style with bonds, such as molecular");
  if (force->special_lj[1] != 0.0 || force->special_coul[1] != 0.0)
    error->all(FLERR, "Fix skin/cells needs special_bonds with weights 0.0 of 1-2 neighbors, or "
               "the two cells of a dividing pair would exclude each other; it got {} and {}",
               force->special_lj[1], force->special_coul[1]);
  if (atom->map_style == Atom::MAP_NONE) error->all(FLERR, "Fix skin/cells needs an atom map");
  if (domain->zperiodic || domain->boundary[2][1] != 1)
    error->all(FLERR, "Fix skin/cells removes cells through the top of the box: "
               "it needs boundary p p f");
  if (neighbor->every != 1 || neighbor->delay != 0 || neighbor->dist_check != 1 ||
      neighbor->build_once)
    error->all(FLERR, "Fix skin/cells needs neigh_modify every 1 delay 0 check yes once no, or the "
               "nearest membrane particle would not be exact; it got every {} delay {} check {} "
               "once {}", neighbor->every, neighbor->delay, neighbor->dist_check ? "yes" : "no",
               neighbor->build_once ? "yes" : "no");
  if (neighbor->includegroup)
    error->all(FLERR, "Fix skin/cells does not work with neigh_modify include: lists would not be "
               "built anew when the membrane moves");
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
      if (cells.kind_of(i) != SkinCells::NONE && (atom->mask[i] & fix->groupbit)) mine = 1;
    MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
    if (!any) continue;
    if (fix->rigid_flag)
      error->all(FLERR, "Fix skin/cells: cells cannot divide in the rigid bodies of fix {}",
                 fix->id);
    const int known = 1 | groupbit | divisions.inherited_groups;
    if (!(fix->groupbit & known) && !group->dynamic[fix->igroup] && comm->me == 0)
      error->warning(FLERR, "Fix skin/cells: daughters will not be in the group {} of fix {}, "
                     "which moves some of the cells: if they should, use inherit {}",
                     group->names[fix->igroup], fix->id, group->names[fix->igroup]);
  }
}
