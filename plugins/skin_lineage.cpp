#include "skin_lineage.h"

#include "fix_skin_cells_record.h"

#include "atom.h"
#include "domain.h"
#include "error.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <cstring>

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

void SkinLineage::skip_used_ids()
{
  tagint highest = 0, highest_all;
  for (int i = 0; i < atom->nlocal; i++) highest = std::max(highest, atom->tag[i]);
  MPI_Allreduce(&highest, &highest_all, 1, MPI_LMP_TAGINT, MPI_MAX, world);
  next_id = std::max(next_id, (bigint) highest_all + 1);
}

/* ---------------------------------------------------------------------- */

tagint SkinLineage::new_id()
{
  if (next_id > MAXTAGINT)
    error->all(FLERR, "Fix skin/cells: out of atom IDs on step {}, the largest is {}",
               update->ntimestep, MAXTAGINT);
  return (tagint) next_id++;
}

/* ---------------------------------------------------------------------- */

void SkinLineage::write(const SkinCellEvent &event, const char *kind, tagint id, tagint parent,
                        const std::string &cause)
{
  double x[3] = {event.x[0], event.x[1], event.x[2]};
  domain->remap(x);
  log.write(event.time, kind, id, parent, kinds[event.cell.kind].number, x,
            event.cell.divisions_left, cause.c_str());
}

/* ---------------------------------------------------------------------- */

std::vector<double> SkinLineage::values(bigint position) const
{
  return {RESTART_FORMAT, (double) next_id, (double) births, (double) deaths, (double) position,
          interventions.passed()};
}

/* ---------------------------------------------------------------------- */

std::vector<double> SkinLineage::to_restart()
{
  skip_used_ids();
  return values(log.sync());
}

/* ---------------------------------------------------------------------- */

void SkinLineage::from_restart(const char *buf)
{
  double list[NSTORED] = {};
  std::memcpy(list, buf, sizeof(double));
  const bool older = list[0] == WITHOUT_INTERVENTIONS;
  if (list[0] != RESTART_FORMAT && !older)
    error->all(FLERR,
               "Fix skin/cells: the restart file was written by another version of this fix");
  std::memcpy(list, buf, sizeof(list) - (older ? sizeof(double) : 0));
  go_on(list);
}

/* ---------------------------------------------------------------------- */

void SkinLineage::go_on(const double *list)
{
  next_id = std::max(next_id, (bigint) list[1]);
  births = (bigint) list[2];
  deaths = (bigint) list[3];
  log_position = (bigint) list[4];
  if (list[0] == RESTART_FORMAT) interventions.resume_after(list[5]);
}

/* ---------------------------------------------------------------------- */

FixSkinCellsRecord *SkinLineage::find_record() const
{
  return dynamic_cast<FixSkinCellsRecord *>(modify->get_fix_by_id(FixSkinCellsRecord::ID));
}

/* ----------------------------------------------------------------------
   go on from where an earlier fix skin/cells of these atoms was unfixed, which may have been after
   this one was defined
------------------------------------------------------------------------- */

void SkinLineage::take_record()
{
  FixSkinCellsRecord *const record = find_record();
  if (!record || record->values.empty()) return;
  go_on(record->values.data());
  if (record->log != log.path()) log_position = -1;
  record->values.clear();
}

/* ---------------------------------------------------------------------- */

void SkinLineage::leave_record()
{
  take_record();
  FixSkinCellsRecord *const record = find_record();
  if (!record) return;
  record->values = values(log.position(log_position));
  record->log = log.path();
}
