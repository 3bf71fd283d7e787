// atoms come, go and change places, by this fix and by other commands: the per-atom array of fix
// skin/cells, its list of cells, and cells that others have made

#include "fix_skin_cells.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "memory.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>

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
   a new atom; fix property/atom leaves it what its place in the arrays had before, unless its state
   has just been read
------------------------------------------------------------------------- */

void FixSkinCells::set_arrays(int i)
{
  set_row(i, nullptr);
  if (!cells.state.refresh(atom).empty()) return;
  if (state_section.title().empty()) cells.state.clear(i);
  else if (cells.kinds.of_type(atom->type[i]) != SkinCells::NONE) state_section.check(atom->tag[i]);
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
  cells.clock.begin();
  pre_neighbor();
}

/* ----------------------------------------------------------------------
   before each neighbor build, whoever has made or removed atoms by then; special neighbors are
   made from bonds alone when atoms are read, so dividing pairs are put back in
------------------------------------------------------------------------- */

void FixSkinCells::pre_neighbor()
{
  cells.find_state();
  end_widowed_pairs();
  for (int i = 0; i < atom->nlocal; i++) {
    if (cells.kind_of(i) == SkinCells::NONE) continue;
    start_created_cell(i);
    if (cells.state.pair[i]) pairs.hide_partner(i);
  }
  list_cells();
}

/* ----------------------------------------------------------------------
   a pair of which another command has removed a cell is over
------------------------------------------------------------------------- */

void FixSkinCells::end_widowed_pairs()
{
  for (const SkinCellEvent &end : pairs.widowed()) {
    lineage.write(end, "division_end", end.id, end.other, "partner_removed");
    pairs.dissolve(end);
  }
  lineage.log.flush();
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
  SkinCellState &state = cells.state;
  const bool all_zero = state.all_zero(i);
  if (all_zero) {
    cells.check(i, lineage.next_id);
    state.next_division[i] = SkinCellState::NEVER;
    state.birth_time[i] = cells.clock.now();
  }
  const bool unscheduled = cells.row_of(i).divides() && state.next_division[i] < 0.0;
  if ((all_zero || unscheduled) && state.detached_time[i] == 0.0)
    state.detached_time[i] = SkinCellState::NEVER;
  if (unscheduled) divisions.schedule_first(i);
}

/* ----------------------------------------------------------------------
   my cells, their candidates for the nearest membrane particle, and rows of zeros for everything
   that is no cell
------------------------------------------------------------------------- */

void FixSkinCells::list_cells()
{
  cells.list.clear();
  for (int i = 0; i < atom->nlocal; i++) {
    if (cells.kind_of(i) != SkinCells::NONE) cells.list.push_back(i);
    else set_row(i, nullptr);
  }
  rearranged = false;
  parted.assign(cells.list.size(), 0);
  attachment.list_candidates();
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
