// event steps of fix skin/cells: what is due, and what happens in which order

#include "fix_skin_cells.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "update.h"

#include <algorithm>
#include <map>
#include <set>

using namespace LAMMPS_NS;

/* ----------------------------------------------------------------------
   ask for a neighbor build on an event step if anything is due on any rank
------------------------------------------------------------------------- */

void FixSkinCells::post_integrate()
{
  if (update->ntimestep % every) return;
  const double time = cells.clock.now();
  cells.find_state();

  int due = !interventions.due(time).empty(), due_anywhere;
  for (size_t k = 0; k < cells.list.size() && !due; k++) {
    const int i = cells.list[k];
    const bool ends = pairs.grown_by(i, time) && (parted[k] || pairs.apart == 0.0);
    due = cells.detached(i) || divisions.due_by(i, time) || ends;
  }
  MPI_Allreduce(&due, &due_anywhere, 1, MPI_INT, MPI_MAX, world);
  if (due_anywhere) next_reneighbor = update->ntimestep;
}

/* ----------------------------------------------------------------------
   all events of this step, on all ranks in one order: atoms migrate right after
------------------------------------------------------------------------- */

void FixSkinCells::pre_exchange()
{
  if (update->ntimestep != next_reneighbor) return;

  int here = rearranged, anywhere;
  MPI_Allreduce(&here, &anywhere, 1, MPI_INT, MPI_MAX, world);
  if (anywhere) {
    migrate(true);
    pre_neighbor();
  }

  comm->forward_comm();
  attachment.sort_membrane();
  cells.find_state();
  std::vector<SkinCellEvent> events = SkinCellEvent::gather(pairs.grown(), world);
  const std::vector<SkinCellEvent> others =
      SkinCellEvent::gather(deaths_and_births(events), world);
  events.insert(events.end(), others.begin(), others.end());
  const std::vector<SkinCellEvent> ends = SkinCellEvent::gather(pairs.ended_by(events), world);
  events.insert(events.end(), ends.begin(), ends.end());
  std::sort(events.begin(), events.end());

  std::vector<SkinCellEvent> newborn;
  std::set<tagint> dissolved;
  bigint removed = 0;
  if (std::any_of(events.begin(), events.end(),
                  [](const SkinCellEvent &e) { return e.kind == SkinCellEvent::BIRTH; }))
    lineage.skip_used_ids();
  for (const SkinCellEvent &event : events) {
    if (event.kind == SkinCellEvent::BIRTH) {
      newborn.push_back(event);
      lineage.write(event, "birth", lineage.new_id(), event.id, "division");
    } else if (event.kind == SkinCellEvent::DEATH) {
      lineage.write(event, "death", event.id, event.parent, "detached");
      remove(event);
      removed++;
    } else if (dissolved.insert(event.id).second) {
      pairs.dissolve(event);
      lineage.write(event, "division_end", event.id, event.other,
                    event.kind == SkinCellEvent::GROWN ? "grown" : "partner_removed");
    }
  }

  const bigint born = (bigint) newborn.size();
  lineage.log.flush();
  divisions.carry_out(newborn, (tagint) (lineage.next_id - born));
  lineage.births += born;
  lineage.deaths += removed;
  atom->natoms -= removed;
  cells.known_atoms += born - removed;

  // fixes that come next must not count those that have left

  if (removed) migrate(false);
  intervene();
}

/* ----------------------------------------------------------------------
   mine; detachment was noticed with the forces of earlier steps, while divisions need the nearest
   membrane particles of the current positions. A cell of a pair divides if the pair is among those
   that end.
------------------------------------------------------------------------- */

std::vector<SkinCellEvent>
FixSkinCells::deaths_and_births(const std::vector<SkinCellEvent> &pair_ends) const
{
  std::map<tagint, double> ended;
  for (const SkinCellEvent &end : pair_ends) ended[end.id] = ended[end.other] = end.time;

  const double now = cells.clock.now();
  std::vector<SkinCellEvent> events;
  for (int i : cells.list) {
    const bool paired = cells.state.pair[i] != 0;
    const auto end = ended.find(atom->tag[i]);
    if (cells.detached(i)) {
      events.push_back(cells.event(i, SkinCellEvent::DEATH, cells.state.detached_time[i]));
    } else if ((!paired || end != ended.end()) && divisions.due_by(i, now)) {
      const SkinNearest::Neighbor closest = attachment.find_nearest(i);
      const double earliest = paired ? end->second : 0.0;
      if (attachment.is_sure(closest)) events.push_back(divisions.plan(i, earliest, closest));
    }
  }
  return events;
}

/* ----------------------------------------------------------------------
   a removed cell is put above the fixed top of the box: the exchange that follows drops it
------------------------------------------------------------------------- */

void FixSkinCells::remove(const SkinCellEvent &event)
{
  const int i = cells.owned_index(event.id);
  if (i >= 0) atom->x[i][2] = domain->boxhi[2] + domain->prd[2];
}
