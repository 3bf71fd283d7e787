// schedules, event steps and removals in fix skin/cells

#include "fix_skin_cells.h"

#include "skin_random.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

using namespace LAMMPS_NS;

/* ----------------------------------------------------------------------
   a cell that can divide but has no schedule is in the first generation: the time since its
   last division is uniform, and the wait that remains is that of the cycle
------------------------------------------------------------------------- */

void FixSkinCells::schedule_first(int i)
{
  const tagint id = atom->tag[i];
  const SkinCellKind &kind = kinds[kind_of(i)];
  const double elapsed = kind.first_phase * SkinRandom::uniform(seed, id, 0, SkinRandom::FIRST_PHASE);
  const double exponential = wait(kind, id, 0) - kind.cycle_delay;
  state.next_division[i] = now() + std::max(kind.cycle_delay - elapsed, 0.0) + exponential;
}

/* ----------------------------------------------------------------------
   time from a division of a cell to its next: T0 + Exp(gamma)
------------------------------------------------------------------------- */

double FixSkinCells::wait(const SkinCellKind &kind, tagint id, uint64_t event,
                          SkinRandom::Purpose purpose) const
{
  return kind.cycle_delay -
      std::log(SkinRandom::uniform(seed, id, event, purpose)) / kind.cycle_rate;
}

/* ----------------------------------------------------------------------
   time of the division after that of a given time, the last of so many
------------------------------------------------------------------------- */

double FixSkinCells::next_division(int i, double time, int number) const
{
  const SkinCellKind &kind = kinds[kind_of(i)];
  return kind.divides() ? time + wait(kind, atom->tag[i], number) : SkinCellState::NEVER;
}

/* ---------------------------------------------------------------------- */

double FixSkinCells::pair_end_time(int i) const
{
  return state.pair_start[i] + (spring_end - spring_start) / spring_rate;
}

/* ---------------------------------------------------------------------- */

bool FixSkinCells::detached(int i) const
{
  return kinds[kind_of(i)].detaches() && state.detached_time[i] >= 0.0;
}

/* ---------------------------------------------------------------------- */

bool FixSkinCells::divides_by(int i, double time) const
{
  return kinds[kind_of(i)].divides() && state.next_division[i] >= 0.0 &&
      state.next_division[i] <= time;
}

/* ----------------------------------------------------------------------
   ask for a neighbor build on the given event step if anything is due by then on any rank
------------------------------------------------------------------------- */

void FixSkinCells::plan_events(bigint step)
{
  const double time = time_of_step(step);
  refresh_state();

  int due = !interventions.due(time).empty(), due_anywhere;
  for (size_t k = 0; k < cells.size(); k++) {
    const int i = cells[k];
    const bool ends = state.pair[i] && pair_end_time(i) <= time && (parted[k] || apart == 0.0);
    if (detached(i) || divides_by(i, time) || ends) {
      due = 1;
      break;
    }
  }
  MPI_Allreduce(&due, &due_anywhere, 1, MPI_INT, MPI_MAX, world);
  if (due_anywhere) next_reneighbor = step;
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
  nearest.bin(atom, membrane_type);
  refresh_state();
  std::vector<SkinCellEvent> events = SkinCellEvent::gather(grown_pairs(), world);
  const std::vector<SkinCellEvent> others = SkinCellEvent::gather(due_events(events), world);
  events.insert(events.end(), others.begin(), others.end());
  const std::vector<SkinCellEvent> ends = SkinCellEvent::gather(pairs_ended_by(events), world);
  events.insert(events.end(), ends.begin(), ends.end());
  std::sort(events.begin(), events.end());

  std::vector<SkinCellEvent> newborn;
  std::set<tagint> dissolved;
  bigint removed = 0;
  if (std::any_of(events.begin(), events.end(),
                  [](const SkinCellEvent &e) { return e.kind == SkinCellEvent::BIRTH; }))
    skip_used_ids();
  for (const SkinCellEvent &event : events) {
    if (event.kind == SkinCellEvent::BIRTH) {
      newborn.push_back(event);
      log_event(event, "birth", new_id(), event.id, "division");
    } else if (event.kind == SkinCellEvent::DEATH) {
      log_event(event, "death", event.id, event.parent, "detached");
      remove(event);
      removed++;
    } else if (dissolved.insert(event.id).second) {
      dissolve(event, have_bond(event.id, event.other));
      log_event(event, "division_end", event.id, event.other,
                event.kind == SkinCellEvent::GROWN ? "grown" : "partner_removed");
    }
  }

  log.flush();
  give_birth(newborn);
  deaths += removed;
  atom->natoms -= removed;
  known_atoms += (bigint) newborn.size() - removed;

  // fixes that come next must not count those that have left

  if (removed) migrate(false);
  intervene();
}

/* ----------------------------------------------------------------------
   my deaths and births; detachment was noticed with the forces of earlier steps, while divisions
   need the nearest membrane particles of the current positions. A cell of a pair divides if the
   pair is among those that end.
------------------------------------------------------------------------- */

std::vector<SkinCellEvent>
FixSkinCells::due_events(const std::vector<SkinCellEvent> &pair_ends) const
{
  std::map<tagint, double> ended;
  for (const SkinCellEvent &end : pair_ends) ended[end.id] = ended[end.other] = end.time;

  const double time = now();
  std::vector<SkinCellEvent> events;
  for (int i : cells) {
    const auto end = ended.find(atom->tag[i]);
    const bool single = !state.pair[i] || end != ended.end();
    if (detached(i)) {
      events.push_back(death_of(i));
    } else if (single && divides_by(i, time)) {
      const SkinNearest::Neighbor closest = nearest.find(atom->x[i]);
      const double earliest = state.pair[i] ? end->second : 0.0;
      if (closest.index >= 0 && closest.distsq <= reach() * reach())
        events.push_back(division_of(i, earliest, closest));
    }
  }
  return events;
}

/* ---------------------------------------------------------------------- */

SkinCellEvent FixSkinCells::death_of(int i) const
{
  SkinCellEvent event = {};
  event.kind = SkinCellEvent::DEATH;
  event.time = state.detached_time[i];
  event.id = atom->tag[i];
  event.other = state.pair[i];
  event.parent = state.parent[i];
  event.cell = {kind_of(i), state.divisions_left[i]};
  std::copy(atom->x[i], atom->x[i] + 3, event.x);
  return event;
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::log_event(const SkinCellEvent &event, const char *kind, tagint id,
                             tagint parent, const std::string &cause)
{
  double x[3] = {event.x[0], event.x[1], event.x[2]};
  domain->remap(x);
  log.write(event.time, kind, id, parent, kinds[event.cell.kind].number, x,
            event.cell.divisions_left, cause.c_str());
}

/* ----------------------------------------------------------------------
   a removed cell is put above the fixed top of the box: the exchange that follows drops it
------------------------------------------------------------------------- */

void FixSkinCells::remove(const SkinCellEvent &event)
{
  const int i = owned_index(event.id);
  if (i >= 0) atom->x[i][2] = domain->boxhi[2] + domain->prd[2];
}
