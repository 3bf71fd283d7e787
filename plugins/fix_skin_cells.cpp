// Cells on a basement membrane: LAMMPS' hooks, restart and output of the fix. What cells do stands
// in classes of their own: SkinCells, SkinAttachment, SkinDividingPairs, SkinDivisions and
// SkinLineage. Of the fix itself, its arguments stand in fix_skin_cells_settings.cpp, forces in
// _forces.cpp, event steps in _events.cpp, checks in _checks.cpp, interventions in
// _interventions.cpp, and atoms that others make or move in _atoms.cpp.

#include "fix_skin_cells.h"

#include "fix_skin_cells_record.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "memory.h"
#include "modify.h"
#include "update.h"

using namespace LAMMPS_NS;
using namespace FixConst;

/* ---------------------------------------------------------------------- */

FixSkinCells::FixSkinCells(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), cells(lmp, groupbit), pairs(lmp, cells), divisions(lmp, cells, pairs),
    attachment(lmp, cells, pairs), interventions(lmp), lineage(lmp, cells.kinds, interventions),
    state_section(lmp), every(1), any_away(0), energy{}, energy_all{}, energy_summed(false),
    nmax(0), rearranged(true), reach_checked(false)
{
  parse(narg, arg);
  lineage.skip_used_ids();    // also those of atoms that are removed before the first run

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
  size_vector = NTERMS + NCOUNTS + (int) cells.kinds.of_other_numbers().size();
  extvector = 1;
  global_freq = 1;

  peratom_flag = 1;
  size_peratom_cols = NCOLUMNS;
  peratom_freq = 1;
  FixSkinCells::grow_arrays(atom->nmax);
  atom->add_callback(Atom::GROW);
}

/* ---------------------------------------------------------------------- */

FixSkinCells::~FixSkinCells()
{
  if (is_first()) lineage.leave_record();
  atom->delete_callback(id, Atom::GROW);
  memory->destroy(array_atom);
}

/* ---------------------------------------------------------------------- */

int FixSkinCells::setmask()
{
  return POST_INTEGRATE | PRE_EXCHANGE | PRE_NEIGHBOR | PRE_FORCE | PRE_REVERSE | POST_FORCE |
      MIN_PRE_NEIGHBOR | MIN_PRE_FORCE | MIN_PRE_REVERSE | MIN_POST_FORCE | END_OF_STEP;
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::init()
{
  check_settings();
  cells.find_state();
  check_others();
  lineage.take_record();
  lineage.skip_used_ids();
  for (int i = 0; i < atom->nlocal; i++) cells.check(i, lineage.next_id);
  pairs.check();
  interventions.begin(cells.clock.time_of_step(update->ntimestep));
  lineage.open_log();
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::forget_detached_after(double offset)
{
  cells.find_state();
  attachment.forget_detached_after(cells.clock.time_of_step(update->ntimestep) + offset);
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::setup_pre_force(int vflag)
{
  cells.known_atoms = atom->natoms;
  reach_checked = false;
  pre_force(vflag);
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::setup_pre_reverse(int eflag, int vflag)
{
  pre_reverse(eflag, vflag);
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::end_of_step()
{
  lineage.log.begin();
  const double time = cells.clock.time_of_step(update->ntimestep);
  if (update->ntimestep % every == 0 && interventions.due(time).empty()) interventions.pass(time);
}

/* ----------------------------------------------------------------------
   what ended at the start of a run without steps
------------------------------------------------------------------------- */

void FixSkinCells::post_run()
{
  lineage.log.begin_if_waiting();
}

/* ----------------------------------------------------------------------
   what must outlive a restart besides the per-atom properties
------------------------------------------------------------------------- */

void FixSkinCells::write_restart(FILE *fp)
{
  // a restarted run counts its time from here: so does this one, or the two differ by rounding

  if (update->whichflag != 2) update->update_time();

  const std::vector<double> list = lineage.to_restart();
  const int size = (int) (list.size() * sizeof(double));
  if (comm->me != 0) return;
  if (fwrite(&size, sizeof(int), 1, fp) != 1 || fwrite(list.data(), size, 1, fp) != 1)
    error->one(FLERR, "Fix skin/cells: cannot write to the restart file: {}",
               utils::getsyserror());
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::restart(char *buf)
{
  lineage.from_restart(buf);
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::post_constructor()
{
  if (!modify->get_fix_by_id(FixSkinCellsRecord::ID))
    modify->add_fix(fmt::format("{} all {}", FixSkinCellsRecord::ID, FixSkinCellsRecord::STYLE));
  if (is_first()) lineage.take_record();
}

/* ----------------------------------------------------------------------
   of several fixes skin/cells, of which none can run, the first alone may have run before
------------------------------------------------------------------------- */

bool FixSkinCells::is_first() const
{
  const auto all = modify->get_fix_by_style("^skin/cells$");
  return !all.empty() && all.front() == this;
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
   cells of which something is true, on all ranks
------------------------------------------------------------------------- */

template <class CONDITION> int FixSkinCells::count(const CONDITION &condition)
{
  cells.find_state();
  int mine = 0, all;
  for (int i = 0; i < atom->nlocal; i++)
    mine += cells.kind_of(i) != SkinCells::NONE && condition(i);
  MPI_Allreduce(&mine, &all, 1, MPI_INT, MPI_SUM, world);
  return all;
}

/* ----------------------------------------------------------------------
   energies of adhesion, binding, division; cells of the kinds numbered 3 to 6; dividing pairs;
   births and deaths since the start; the ID of the next newborn; cells of each other kind
------------------------------------------------------------------------- */

double FixSkinCells::compute_vector(int n)
{
  if (n < NTERMS) {
    if (!energy_summed) MPI_Allreduce(energy, energy_all, NTERMS, MPI_DOUBLE, MPI_SUM, world);
    energy_summed = true;
    return energy_all[n];
  }

  n -= NTERMS;
  if (n == PAIRS) return 0.5 * count([&](int i) { return cells.state.pair[i] != 0; });
  if (n == BIRTHS) return (double) lineage.births;
  if (n == DEATHS) return (double) lineage.deaths;
  if (n == NEXT_ID) {
    lineage.skip_used_ids();
    return (double) lineage.next_id;
  }
  const int kind = n < PAIRS ? cells.kinds.of_number(SkinCellKinds::FIRST_NUMBER + n)
                             : cells.kinds.of_other_numbers()[n - NCOUNTS];
  return count([&](int i) { return cells.kind_of(i) == kind; });
}

/* ---------------------------------------------------------------------- */

double FixSkinCells::memory_usage()
{
  return (double) nmax * NCOLUMNS * sizeof(double) + (double) cells.list.capacity() * sizeof(int) +
      attachment.memory_usage();
}
