// Cells on a basement membrane: set-up, checks, restart and output of the fix. Its arguments stand
// in fix_skin_cells_settings.cpp, its forces in _forces.cpp, events in _events.cpp with births in
// _births.cpp and dividing pairs in _pairs.cpp, and atoms that others make or move in _atoms.cpp.

#include "fix_skin_cells.h"

#include "fix_skin_cells_record.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "memory.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FixConst;

/* ---------------------------------------------------------------------- */

FixSkinCells::FixSkinCells(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), seed(0), membrane_type(0), kinds(lmp), contact(0.0), core(0.0),
    spring_stiffness(0.0), spring_start(0.0), spring_rate(0.0), spring_end(0.0),
    half_separation(0.0), pairs_stay(false), apart(0.0), every(1), inherited_groups(0), next_id(0),
    births(0), deaths(0), state{}, interventions(lmp), log(lmp), log_position(-1), setup_time(0.0),
    time_offset(0.0), known_atoms(0), energy{}, energy_all{}, energy_summed(false), nmax(0),
    rearranged(true)
{
  parse(narg, arg);
  skip_used_ids();    // also those of atoms that are removed before the first run

  restart_global = 1;
  force_reneighbor = 1;
  next_reneighbor = -1;
  nevery = 1;
  time_depend = 1;
  virial_global_flag = virial_peratom_flag = 1;
  energy_global_flag = energy_peratom_flag = 1;
  create_attribute = stores_ids = 1;
  maxexchange = NCOLUMNS;

  scalar_flag = 1;
  extscalar = 1;
  vector_flag = 1;
  size_vector = NTERMS + 4 + kinds.size();
  extvector = 1;
  global_freq = 1;

  peratom_flag = 1;
  size_peratom_cols = NCOLUMNS;
  peratom_freq = 1;
  grow_arrays(atom->nmax);
  atom->add_callback(Atom::GROW);
}

/* ---------------------------------------------------------------------- */

FixSkinCells::~FixSkinCells()
{
  if (is_first()) leave_record();
  atom->delete_callback(id, Atom::GROW);
  memory->destroy(array_atom);
}

/* ---------------------------------------------------------------------- */

int FixSkinCells::setmask()
{
  return PRE_EXCHANGE | PRE_NEIGHBOR | PRE_REVERSE | MIN_PRE_NEIGHBOR | MIN_PRE_REVERSE |
      END_OF_STEP;
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::init()
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

  refresh_state();
  check_others();
  take_record();
  skip_used_ids();
  for (int i = 0; i < atom->nlocal; i++) check_cell(i);
  check_pairs();
  interventions.begin(time_of_step(update->ntimestep));
  log.open(log_position);
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::refresh_state()
{
  const std::string missing = state.refresh(atom);
  if (!missing.empty())
    error->all(FLERR, "Fix skin/cells needs the per-atom property {}: define fix ID all "
               "property/atom {} first", missing, SkinCellState::PROPERTIES);
}

/* ----------------------------------------------------------------------
   kind of a local or ghost atom, NONE if this fix has nothing to do with it
------------------------------------------------------------------------- */

int FixSkinCells::kind_of(int i) const
{
  return (atom->mask[i] & groupbit) ? kinds.of_type(atom->type[i]) : NONE;
}

/* ---------------------------------------------------------------------- */

double FixSkinCells::time_of_step(bigint step) const
{
  return update->atime + (double) (step - update->atimestep) * update->dt;
}

/* ----------------------------------------------------------------------
   current time; in a minimisation, whose iterations are no time, that of its start
------------------------------------------------------------------------- */

double FixSkinCells::now() const
{
  return update->whichflag == 2 ? setup_time : time_of_step(update->ntimestep) + time_offset;
}

/* ----------------------------------------------------------------------
   forces until the next call are those at this time, counted from the end of the step
------------------------------------------------------------------------- */

void FixSkinCells::within_step(double offset)
{
  time_offset = offset;
}

/* ----------------------------------------------------------------------
   what was seen after this time of the step did not happen: the step is done again
------------------------------------------------------------------------- */

void FixSkinCells::forget_detached_after(double offset)
{
  refresh_state();

  // what was noted at the start of the part itself stays, whatever the rounding of its time

  const double time = time_of_step(update->ntimestep) + offset + 1.0e-9 * update->dt;
  for (int i = 0; i < atom->nlocal; i++)
    if (kind_of(i) != NONE && state.detached_time[i] > time)
      state.detached_time[i] = SkinCellState::NEVER;
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::setup_pre_reverse(int eflag, int vflag)
{
  known_atoms = atom->natoms;
  check_reach();
  pre_reverse(eflag, vflag);
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::setup(int /*vflag*/)
{
  if ((update->ntimestep + 1) % every == 0) plan_events(update->ntimestep + 1);
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::end_of_step()
{
  log.begin();
  const double time = time_of_step(update->ntimestep);
  if (update->ntimestep % every == 0 && interventions.due(time).empty()) interventions.pass(time);
  if ((update->ntimestep + 1) % every == 0) plan_events(update->ntimestep + 1);
}

/* ----------------------------------------------------------------------
   what ended at the start of a run without steps
------------------------------------------------------------------------- */

void FixSkinCells::post_run()
{
  log.begin_if_waiting();
}

/* ----------------------------------------------------------------------
   what must outlive a restart besides the per-atom properties
------------------------------------------------------------------------- */

void FixSkinCells::write_restart(FILE *fp)
{
  // a restarted run counts its time from here: so does this one, or the two differ by rounding

  if (update->whichflag != 2) update->update_time();

  const std::vector<double> list = to_restart();
  const int size = (int) (list.size() * sizeof(double));
  if (comm->me != 0) return;
  if (fwrite(&size, sizeof(int), 1, fp) != 1 || fwrite(list.data(), size, 1, fp) != 1)
    error->one(FLERR, "Fix skin/cells: cannot write to the restart file: {}",
               utils::getsyserror());
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::restart(char *buf)
{
  double list[NSTORED];
  std::memcpy(list, buf, sizeof(double));
  if (list[0] != RESTART_FORMAT)
    error->all(FLERR,
               "Fix skin/cells: the restart file was written by another version of this fix");
  std::memcpy(list, buf, sizeof(list));
  from_restart(list);
}

/* ---------------------------------------------------------------------- */

std::vector<double> FixSkinCells::to_restart()
{
  skip_used_ids();
  return {RESTART_FORMAT, (double) next_id, (double) births, (double) deaths, (double) log.sync(),
          interventions.passed()};
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::from_restart(const double *list)
{
  next_id = std::max(next_id, (bigint) list[1]);
  births = (bigint) list[2];
  deaths = (bigint) list[3];
  log_position = (bigint) list[4];
  interventions.resume_after(list[5]);
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::post_constructor()
{
  if (!find_record())
    modify->add_fix(fmt::format("{} all {}", FixSkinCellsRecord::ID, FixSkinCellsRecord::STYLE));
  if (is_first()) take_record();
}

/* ----------------------------------------------------------------------
   of several fixes skin/cells, of which none can run, the first alone may have run before
------------------------------------------------------------------------- */

bool FixSkinCells::is_first() const
{
  const auto all = modify->get_fix_by_style("^skin/cells$");
  return !all.empty() && all.front() == this;
}

/* ---------------------------------------------------------------------- */

FixSkinCellsRecord *FixSkinCells::find_record() const
{
  return dynamic_cast<FixSkinCellsRecord *>(modify->get_fix_by_id(FixSkinCellsRecord::ID));
}

/* ----------------------------------------------------------------------
   go on from where an earlier fix skin/cells of these atoms was unfixed, which may have been after
   this one was defined
------------------------------------------------------------------------- */

void FixSkinCells::take_record()
{
  FixSkinCellsRecord *const record = find_record();
  if (!record || record->values.empty()) return;
  from_restart(record->values.data());
  if (record->log != log.path()) log_position = -1;
  record->values.clear();
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::leave_record()
{
  take_record();
  FixSkinCellsRecord *const record = find_record();
  if (!record) return;
  record->values = {RESTART_FORMAT, (double) next_id, (double) births, (double) deaths,
                    (double) log.position(log_position), interventions.passed()};
  record->log = log.path();
}

/* ----------------------------------------------------------------------
   energy of adhesion, binding and division springs
------------------------------------------------------------------------- */

double FixSkinCells::compute_scalar()
{
  double sum = 0.0;
  for (int term = 0; term < NTERMS; term++) sum += compute_vector(term);
  return sum;
}

/* ----------------------------------------------------------------------
   energies of adhesion, binding, division; number of dividing pairs; births and deaths since the
   start; the ID of the next newborn; numbers of cells of each kind
------------------------------------------------------------------------- */

double FixSkinCells::compute_vector(int n)
{
  if (n < NTERMS) {
    if (!energy_summed) MPI_Allreduce(energy, energy_all, NTERMS, MPI_DOUBLE, MPI_SUM, world);
    energy_summed = true;
    return energy_all[n];
  }

  n -= NTERMS;
  if (n == 1) return (double) births;
  if (n == 2) return (double) deaths;
  if (n == 3) {
    skip_used_ids();
    return (double) next_id;
  }

  refresh_state();
  int count = 0, count_all;
  for (int i = 0; i < atom->nlocal; i++)
    if (n == 0) count += (kind_of(i) != NONE && state.pair[i] != 0);
    else count += (kind_of(i) == n - 3);
  MPI_Allreduce(&count, &count_all, 1, MPI_INT, MPI_SUM, world);
  return n == 0 ? 0.5 * count_all : count_all;
}

/* ---------------------------------------------------------------------- */

double FixSkinCells::memory_usage()
{
  return (double) nmax * NCOLUMNS * sizeof(double) + (double) cells.capacity() * sizeof(int) +
      nearest.memory_usage();
}
