// atoms come, go and change places, by this fix and by other commands: the per-atom array of fix
// skin/cells, its list of cells, and cells that others have made

#include "fix_skin_cells.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "input.h"
#include "memory.h"
#include "modify.h"
#include "neighbor.h"
#include "platform.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <string>
#include <sys/stat.h>

using namespace LAMMPS_NS;

static constexpr int MAXLINE = 1024;

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
   title of the section of a data file that says the state of atoms that are now added; empty if
   none is named
------------------------------------------------------------------------- */

std::string FixSkinCells::section_that_is_read() const
{
  if (std::strcmp(input->command, "read_data") != 0) return "";
  for (int k = 0; k + 3 < input->narg; k++) {
    if (std::strcmp(input->arg[k], "fix") != 0) continue;
    const Fix *const fix = modify->get_fix_by_id(input->arg[k + 1]);
    if (fix && utils::strmatch(fix->style, "^property/atom")) return input->arg[k + 3];
  }
  return "";
}

/* ----------------------------------------------------------------------
   whether a data file has a section, which LAMMPS does not mind if it has not
------------------------------------------------------------------------- */

static bool has_section(const std::string &path, const std::string &title)
{
  const bool packed = platform::has_compress_extension(path);
  FILE *const file = packed ? platform::compressed_read(path) : fopen(path.c_str(), "r");
  if (!file) return true;    // LAMMPS has read it
  char line[MAXLINE];
  bool found = false;
  while (!found && fgets(line, MAXLINE, file))
    found = utils::trim(utils::trim_comment(line)) == title;
  if (packed) platform::pclose(file);
  else fclose(file);
  return found;
}

/* ----------------------------------------------------------------------
   a new atom; fix property/atom leaves it what its place in the arrays had before, unless its state
   has just been read
------------------------------------------------------------------------- */

void FixSkinCells::set_arrays(int i)
{
  set_row(i, nullptr);
  if (!state.refresh(atom).empty()) return;
  const std::string section = section_that_is_read();
  if (section.empty()) state.clear(i);
  else if (kinds.of_type(atom->type[i]) != NONE) check_section(i, section);
}

/* ----------------------------------------------------------------------
   a cell whose state should have been read; a file is looked at once, unless it has changed
------------------------------------------------------------------------- */

void FixSkinCells::check_section(int i, const std::string &section)
{
  const std::string path = input->arg[0];
  struct stat now = {};
  stat(path.c_str(), &now);
  const std::string looked = fmt::format("{} {} {} {}.{}", path, section, now.st_size,
                                         now.st_mtim.tv_sec, now.st_mtim.tv_nsec);
  if (looked == looked_at) return;
  if (!has_section(path, section))
    error->one(FLERR, "Fix skin/cells: data file {} has no section {}, from which read_data was to "
               "take the state of cell {}", path, section, atom->tag[i]);
  looked_at = looked;
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
