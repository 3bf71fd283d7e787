// births, ends of divisions and deaths in fix skin/cells

#include "fix_skin_cells.h"

#include "skin_random.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "library.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <set>

using namespace LAMMPS_NS;

// the model's number of a kind of cell: 3 stem, 4 TA, 5 exhausted TA, 6 ND

static constexpr int MODEL_TYPE_OFFSET = 2;

/* ----------------------------------------------------------------------
   a cell that can divide but has no schedule is in the first generation: the time since its
   last division is uniform, and the wait that remains is that of the cycle
------------------------------------------------------------------------- */

void FixSkinCells::schedule_first(int i)
{
  const int kind = kind_of(i);
  if ((kind != STEM && kind != TA) || state.next_division[i] >= 0.0) return;

  const tagint id = atom->tag[i];
  const double elapsed = first_phase * SkinRandom::uniform(seed, id, 0, SkinRandom::FIRST_PHASE);
  const double exponential = wait(id, 0) - cycle_delay;
  state.next_division[i] = now() +
      std::max(cycle_delay - elapsed, 0.0) + exponential;
}

/* ----------------------------------------------------------------------
   time from a division of a cell to its next: T0 + Exp(gamma)
------------------------------------------------------------------------- */

double FixSkinCells::wait(tagint id, int event) const
{
  return cycle_delay -
      std::log(SkinRandom::uniform(seed, id, event, SkinRandom::WAIT)) / cycle_rate;
}

/* ---------------------------------------------------------------------- */

double FixSkinCells::pair_end_time(int i) const
{
  return state.pair_start[i] + (spring_end - spring_start) / spring_rate;
}

/* ---------------------------------------------------------------------- */

bool FixSkinCells::divides_by(int i, double time) const
{
  const int kind = kind_of(i);
  return (kind == STEM || kind == TA) && state.next_division[i] >= 0.0 &&
      state.next_division[i] <= time;
}

/* ----------------------------------------------------------------------
   ask for a neighbor build on the given event step if anything is due by then on any rank
------------------------------------------------------------------------- */

void FixSkinCells::plan_events(bigint step)
{
  const double time = time_of_step(step);
  refresh_state();

  int due = 0, due_anywhere;
  for (int i : cells) {
    if (state.detached_time[i] >= 0.0 || divides_by(i, time) ||
        (state.pair[i] && pair_end_time(i) <= time)) {
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

  std::vector<SkinCellEvent> events = SkinCellEvent::gather(due_events(), world);
  const std::vector<SkinCellEvent> ends = SkinCellEvent::gather(pairs_ended_by(events), world);
  events.insert(events.end(), ends.begin(), ends.end());
  std::sort(events.begin(), events.end());

  std::vector<SkinCellEvent> newborn;
  std::set<tagint> dissolved;
  bigint removed = 0;
  for (SkinCellEvent &event : events) {
    domain->remap(event.x);
    if (event.kind == SkinCellEvent::BIRTH) {
      newborn.push_back(event);
      log_event(event, "birth", new_id(), event.id, "division");
    } else if (event.kind == SkinCellEvent::DEATH) {
      log_event(event, "death", event.id, event.parent, "detached");
      remove(event);
      removed++;
    } else if (dissolved.insert(event.id).second) {
      dissolve(event);
      log_event(event, "division_end", event.id, event.other,
                event.kind == SkinCellEvent::GROWN ? "grown" : "partner_removed");
    }
  }

  log.flush();
  give_birth(newborn);
  deaths += removed;
  atom->natoms -= removed;
}

/* ----------------------------------------------------------------------
   my events; detachment was noticed with the forces of earlier steps, while divisions need the
   nearest membrane particles of the current positions
------------------------------------------------------------------------- */

std::vector<SkinCellEvent> FixSkinCells::due_events()
{
  comm->forward_comm();
  nearest.bin(atom, membrane_type);
  refresh_state();

  const double time = now();
  std::vector<SkinCellEvent> events;

  for (int i : cells) {
    const bool grown = state.pair[i] && pair_end_time(i) <= time;
    if (grown && atom->tag[i] > state.pair[i])
      events.push_back(end_of_pair(i, pair_end_time(i), SkinCellEvent::GROWN));

    if (state.detached_time[i] >= 0.0) {
      events.push_back(death_of(i));
    } else if ((grown || !state.pair[i]) && divides_by(i, time)) {
      const SkinNearest::Neighbor closest = nearest.find(atom->x[i]);
      if (closest.index >= 0) events.push_back(division_of(i, closest));
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
  event.type = atom->type[i];
  event.divisions_left = state.divisions_left[i];
  std::copy(atom->x[i], atom->x[i] + 3, event.x);
  return event;
}

/* ----------------------------------------------------------------------
   made by the owner of the younger cell of the pair
------------------------------------------------------------------------- */

SkinCellEvent FixSkinCells::end_of_pair(int i, double time, int cause) const
{
  SkinCellEvent event = death_of(i);
  event.kind = cause;
  event.time = time;
  return event;
}

/* ----------------------------------------------------------------------
   my ends of pairs that follow from deaths on any rank
------------------------------------------------------------------------- */

std::vector<SkinCellEvent>
FixSkinCells::pairs_ended_by(const std::vector<SkinCellEvent> &events) const
{
  std::vector<SkinCellEvent> ends;
  for (const SkinCellEvent &event : events) {
    if (event.kind != SkinCellEvent::DEATH || !event.other) continue;
    const int i = atom->map(std::max(event.id, event.other));
    if (i >= 0 && i < atom->nlocal)
      ends.push_back(end_of_pair(i, event.time, SkinCellEvent::PARTNER_REMOVED));
  }
  return ends;
}

/* ----------------------------------------------------------------------
   the two cells lie on both sides of the mother's place, in a direction that is uniform in the
   plane normal to the line from her to her nearest membrane particle
------------------------------------------------------------------------- */

SkinCellEvent FixSkinCells::division_of(int i, const SkinNearest::Neighbor &closest) const
{
  const double *x = atom->x[i], *y = atom->x[closest.index];
  const double r = std::sqrt(closest.distsq);
  const double n[3] = {(x[0] - y[0]) / r, (x[1] - y[1]) / r, (x[2] - y[2]) / r};

  // u: x axis, or y axis where that is almost n, made normal to n; v completes the frame

  const int axis = std::fabs(n[0]) > 0.9 ? 1 : 0;
  double u[3] = {-n[axis] * n[0], -n[axis] * n[1], -n[axis] * n[2]};
  u[axis] += 1.0;
  const double length = std::sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
  for (double &component : u) component /= length;
  const double v[3] = {n[1] * u[2] - n[2] * u[1], n[2] * u[0] - n[0] * u[2],
                       n[0] * u[1] - n[1] * u[0]};

  const int number = state.divisions_done[i] + 1;
  const double angle = 2.0 * M_PI *
      SkinRandom::uniform(seed, atom->tag[i], number, SkinRandom::ORIENTATION);

  const bool stem = kind_of(i) == STEM;
  SkinCellEvent event = death_of(i);
  event.kind = SkinCellEvent::BIRTH;
  event.time = state.next_division[i];
  if (state.pair[i]) event.time = std::max(event.time, pair_end_time(i));
  event.divisions_left = stem ? generations : state.divisions_left[i] - 1;
  event.type = type_of_kind[event.divisions_left > 0 ? TA : EXHAUSTED];
  event.mask = atom->mask[i];
  for (int d = 0; d < 3; d++) {
    const double step = half_separation * (std::cos(angle) * u[d] + std::sin(angle) * v[d]);
    event.x[d] = x[d] + step;
    event.mother_x[d] = x[d] - step;
  }
  return event;
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::log_event(const SkinCellEvent &event, const char *kind, tagint id,
                             tagint parent, const char *cause)
{
  log.write(event.time, kind, id, parent, kind_of_type[event.type] + MODEL_TYPE_OFFSET, event.x,
            event.divisions_left, cause);
}

/* ----------------------------------------------------------------------
   a removed cell is put above the fixed top of the box: the exchange that follows drops it
------------------------------------------------------------------------- */

void FixSkinCells::remove(const SkinCellEvent &event)
{
  const int i = atom->map(event.id);
  if (i >= 0 && i < atom->nlocal) atom->x[i][2] = domain->boxhi[2] + domain->prd[2];
}

/* ----------------------------------------------------------------------
   end a dividing pair for those of its cells that I own
------------------------------------------------------------------------- */

void FixSkinCells::dissolve(const SkinCellEvent &event)
{
  for (tagint id : {event.id, event.other}) {
    const int i = atom->map(id);
    if (i < 0 || i >= atom->nlocal) continue;
    state.pair[i] = 0;
    hide_pair(i);
    if (state.next_division[i] >= 0.0)
      state.next_division[i] = std::max(state.next_division[i], event.time);
  }
}

/* ----------------------------------------------------------------------
   the cells of a dividing pair are special neighbors of each other, as if there were a bond
   between them: the pair styles do not see them
------------------------------------------------------------------------- */

void FixSkinCells::hide_pair(int i)
{
  const int n = state.pair[i] ? 1 : 0;
  std::fill(atom->nspecial[i], atom->nspecial[i] + 3, n);
  if (n) atom->special[i][0] = state.pair[i];
}

/* ---------------------------------------------------------------------- */

tagint FixSkinCells::new_id()
{
  if (next_id > MAXTAGINT)
    error->all(FLERR, "Fix skin/cells: out of atom IDs on step {}, the largest is {}",
               update->ntimestep, MAXTAGINT);
  return (tagint) next_id++;
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::give_birth(const std::vector<SkinCellEvent> &newborn)
{
  const int n = (int) newborn.size();
  if (n == 0) return;

  // the log gave them the last n ids, in this order

  std::vector<tagint> ids(n);
  std::vector<int> types(n);
  std::vector<double> x(3 * n);
  for (int k = 0; k < n; k++) {
    ids[k] = (tagint) (next_id - n + k);
    types[k] = newborn[k].type;
    std::copy(newborn[k].x, newborn[k].x + 3, &x[3 * k]);
  }

  // the old ghosts end here: borders come anew after the exchange

  atom->nghost = 0;
  lammps_create_atoms(lmp, n, ids.data(), types.data(), x.data(), nullptr, nullptr, 0);
  refresh_state();

  for (int k = 0; k < n; k++) {
    const int mother = atom->map(newborn[k].id), daughter = atom->map(ids[k]);
    if (mother >= 0 && mother < atom->nlocal) divide_mother(mother, newborn[k], ids[k]);
    if (daughter >= 0 && daughter < atom->nlocal) start_daughter(daughter, newborn[k], ids[k]);
  }
  births += n;
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::divide_mother(int i, const SkinCellEvent &event, tagint daughter)
{
  if (kind_of(i) == TA) {
    state.divisions_left[i] = event.divisions_left;
    atom->type[i] = event.type;
  }
  const int number = ++state.divisions_done[i];
  state.next_division[i] = (kind_of(i) == EXHAUSTED) ? SkinCellState::NEVER
                                                     : event.time + wait(event.id, number);
  state.pair[i] = daughter;
  state.pair_start[i] = event.time;
  hide_pair(i);
  std::copy(event.mother_x, event.mother_x + 3, atom->x[i]);
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::start_daughter(int i, const SkinCellEvent &event, tagint id)
{
  atom->mask[i] = event.mask;
  state.divisions_left[i] = event.divisions_left;
  state.divisions_done[i] = 0;
  state.parent[i] = event.id;
  state.pair[i] = event.id;
  state.pair_start[i] = event.time;
  hide_pair(i);
  state.birth_time[i] = event.time;
  state.detached_time[i] = SkinCellState::NEVER;
  state.next_division[i] = (kind_of(i) == EXHAUSTED) ? SkinCellState::NEVER
                                                     : event.time + wait(id, 0);
}
