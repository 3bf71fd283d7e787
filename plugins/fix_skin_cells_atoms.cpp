// atoms come, go and change places, by this fix and by other commands: the per-atom array of fix
// skin/cells, its list of cells, and cells that others have made

#include "fix_skin_cells.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "input.h"
#include "memory.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cstring>

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

void FixSkinCells::grow_arrays(int n)
{
  memory->grow(array_atom, n, NCOLUMNS, "skin/cells:array_atom");
  for (int i = nmax; i < n; i++) set_row(i, nullptr);
  nmax = n;
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::copy_arrays(int i, int j, int /*delflag*/)
{
  set_row(j, array_atom[i]);
}

/* ----------------------------------------------------------------------
   whether atoms are now added from a data file whose section says their state
------------------------------------------------------------------------- */

bool FixSkinCells::state_is_read() const
{
  if (std::strcmp(input->command, "read_data") != 0) return false;
  for (int k = 0; k + 1 < input->narg; k++) {
    if (std::strcmp(input->arg[k], "fix") != 0) continue;
    const Fix *const fix = modify->get_fix_by_id(input->arg[k + 1]);
    if (fix && utils::strmatch(fix->style, "^property/atom")) return true;
  }
  return false;
}

/* ----------------------------------------------------------------------
   a new atom; fix property/atom leaves it what its place in the arrays had before
------------------------------------------------------------------------- */

void FixSkinCells::set_arrays(int i)
{
  set_row(i, nullptr);
  if (state.refresh(atom).empty() && !state_is_read()) state.clear(i);
}

/* ---------------------------------------------------------------------- */

int FixSkinCells::pack_exchange(int i, double *buf)
{
  std::copy_n(array_atom[i], NCOLUMNS, buf);
  return NCOLUMNS;
}

/* ---------------------------------------------------------------------- */

int FixSkinCells::unpack_exchange(int i, double *buf)
{
  set_row(i, buf);
  return NCOLUMNS;
}

/* ----------------------------------------------------------------------
   zeros without values; whoever moves rows has moved atoms
------------------------------------------------------------------------- */

void FixSkinCells::set_row(int i, const double *values)
{
  if (values) std::copy_n(values, NCOLUMNS, array_atom[i]);
  else std::fill_n(array_atom[i], NCOLUMNS, 0.0);
  rearranged = true;
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::setup_pre_neighbor()
{
  setup_time = time_of_step(update->ntimestep);
  pre_neighbor();
}

/* ----------------------------------------------------------------------
   before each neighbor build, whoever has made or removed atoms by then; special neighbors are
   made from bonds alone when atoms are read, so dividing pairs are put back in
------------------------------------------------------------------------- */

void FixSkinCells::pre_neighbor()
{
  refresh_state();
  end_widowed_pairs();
  for (int i = 0; i < atom->nlocal; i++) {
    if (kind_of(i) == NONE) continue;
    start_created_cell(i);
    if (state.pair[i]) hide(i, state.pair[i]);
  }
  list_cells();
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::min_pre_neighbor()
{
  pre_neighbor();
}

/* ----------------------------------------------------------------------
   a cell that another command has made begins now
------------------------------------------------------------------------- */

void FixSkinCells::start_created_cell(int i)
{
  const bool divides = kinds[kind_of(i)].divides();
  const bool all_zero = state.all_zero(i);
  if (all_zero) {
    check_cell(i);
    state.next_division[i] = SkinCellState::NEVER;
    state.birth_time[i] = now();
  }
  const bool unscheduled = divides && state.next_division[i] < 0.0;
  if ((all_zero || unscheduled) && state.detached_time[i] == 0.0)
    state.detached_time[i] = SkinCellState::NEVER;
  if (unscheduled) schedule_first(i);
}

/* ----------------------------------------------------------------------
   my cells, their candidates for the nearest membrane particle, and rows of zeros for everything
   that is no cell
------------------------------------------------------------------------- */

void FixSkinCells::list_cells()
{
  cells.clear();
  for (int i = 0; i < atom->nlocal; i++) {
    if (kind_of(i) != NONE) cells.push_back(i);
    else set_row(i, nullptr);
  }
  rearranged = false;
  parted.assign(cells.size(), 0);

  nearest.clear_candidates();
  if (cells.empty()) return;
  nearest.bin(atom, membrane_type);
  for (int i : cells) nearest.add_candidates(atom->x[i], neighbor->skin);
}

/* ----------------------------------------------------------------------
   atoms to the ranks that own their places, new ghosts: before a neighbor build LAMMPS does this
   after all fixes have had their turn, but what another has made or removed may come before
------------------------------------------------------------------------- */

void FixSkinCells::migrate(bool ghosts)
{
  if (domain->triclinic) domain->x2lamda(atom->nlocal);
  domain->pbc();
  if (domain->box_change) {
    domain->reset_box();
    comm->setup();
    neighbor->setup_bins();
  }
  comm->exchange();
  if (ghosts) comm->borders();
  if (domain->triclinic) domain->lamda2x(atom->nlocal + atom->nghost);
  if (ghosts) return;
  atom->map_init();
  atom->map_set();
}
