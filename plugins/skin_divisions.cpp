#include "skin_divisions.h"

#include "skin_atom_copy.h"
#include "skin_dividing_pairs.h"

#include "domain.h"
#include "error.h"
#include "library.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

/* ----------------------------------------------------------------------
   a cell that can divide but has no schedule is in the first generation: the time since its
   last division is uniform, and the wait that remains is that of the cycle
------------------------------------------------------------------------- */

void SkinDivisions::schedule_first(int i)
{
  const tagint id = atom->tag[i];
  const SkinCellKind &kind = cells.row_of(i);
  const double part = SkinRandom::uniform(seed, id, 0, SkinRandom::FIRST_PHASE);
  const double elapsed = kind.first_phase * part;
  const double exponential = wait(kind, id, 0) - kind.cycle_delay;
  const double delay = std::max(kind.cycle_delay - elapsed, 0.0);
  cells.state.next_division[i] = cells.clock.now() + delay + exponential;
}

/* ---------------------------------------------------------------------- */

void SkinDivisions::schedule_converted(int i, uint64_t key)
{
  const SkinCellKind &kind = cells.row_of(i);
  double &next = cells.state.next_division[i];
  next = SkinCellState::NEVER;
  if (!kind.divides()) return;
  next = cells.clock.now() + wait(kind, atom->tag[i], key, SkinRandom::CONVERTED_WAIT);
}

/* ----------------------------------------------------------------------
   time from a division of a cell to its next: T0 + Exp(gamma)
------------------------------------------------------------------------- */

double SkinDivisions::wait(const SkinCellKind &kind, tagint id, uint64_t event,
                           SkinRandom::Purpose purpose) const
{
  return kind.cycle_delay -
      std::log(SkinRandom::uniform(seed, id, event, purpose)) / kind.cycle_rate;
}

/* ----------------------------------------------------------------------
   time of the division after that of a given time, the last of so many
------------------------------------------------------------------------- */

double SkinDivisions::next_after(int i, double time, int number) const
{
  const SkinCellKind &kind = cells.row_of(i);
  return kind.divides() ? time + wait(kind, atom->tag[i], number) : SkinCellState::NEVER;
}

/* ---------------------------------------------------------------------- */

bool SkinDivisions::due_by(int i, double time) const
{
  return cells.row_of(i).divides() && cells.state.next_division[i] >= 0.0 &&
      cells.state.next_division[i] <= time;
}

/* ----------------------------------------------------------------------
   the two cells lie on both sides of the mother's place, in a direction that is uniform in the
   plane normal to the line from her to her nearest membrane particle
------------------------------------------------------------------------- */

SkinCellEvent SkinDivisions::plan(int i, double earliest,
                                  const SkinNearest::Neighbor &closest) const
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

  const int number = cells.state.divisions_done[i] + 1;
  const double angle = 2.0 * M_PI *
      SkinRandom::uniform(seed, atom->tag[i], number, SkinRandom::ORIENTATION);

  const SkinCellKinds::Stage stage = {cells.kind_of(i), cells.state.divisions_left[i]};
  SkinCellEvent event = cells.event(i, SkinCellEvent::BIRTH, 0.0);
  event.time = std::max(cells.state.next_division[i], earliest);
  event.mother = cells.kinds.after_division(stage);
  event.cell = cells.kinds.newborn(stage);
  for (int d = 0; d < 3; d++) {
    const double step = half_separation * (std::cos(angle) * u[d] + std::sin(angle) * v[d]);
    event.x[d] = x[d] + step;
    event.mother_x[d] = x[d] - step;
  }
  middle_of_subdomain(event.site);
  return event;
}

/* ---------------------------------------------------------------------- */

void SkinDivisions::middle_of_subdomain(double *x) const
{
  const double *const lo = domain->triclinic ? domain->sublo_lamda : domain->sublo;
  const double *const hi = domain->triclinic ? domain->subhi_lamda : domain->subhi;
  for (int d = 0; d < 3; d++) x[d] = 0.5 * (lo[d] + hi[d]);
  if (domain->triclinic) domain->lamda2x(x, x);
}

/* ----------------------------------------------------------------------
   a newborn begins on the rank of her mother, as a copy of her: wherever it is then, the exchange
   that follows brings it to its own
------------------------------------------------------------------------- */

void SkinDivisions::carry_out(const std::vector<SkinCellEvent> &newborn, tagint first_id)
{
  const int n = (int) newborn.size();
  if (n == 0) return;

  std::vector<tagint> ids(n);
  std::vector<int> types(n);
  std::vector<double> sites(3 * n);
  for (int k = 0; k < n; k++) {
    ids[k] = first_id + k;
    types[k] = cells.kinds[newborn[k].cell.kind].type;
    std::copy(newborn[k].site, newborn[k].site + 3, &sites[3 * k]);
  }

  // the old ghosts end here: borders come anew after the exchange

  atom->nghost = 0;
  lammps_create_atoms(lmp, n, ids.data(), types.data(), sites.data(), nullptr, nullptr, 0);
  cells.find_state();

  for (int k = 0; k < n; k++) {
    const int mother = cells.owned_index(newborn[k].id), daughter = cells.owned_index(ids[k]);
    if ((mother < 0) != (daughter < 0))
      error->one(FLERR, "Fix skin/cells: cell {} and its daughter {} are on different ranks",
                 newborn[k].id, ids[k]);
    if (mother < 0) continue;
    SkinAtomCopy::copy(lmp, mother, daughter);
    divide_mother(mother, newborn[k], ids[k]);
    start_daughter(daughter, newborn[k]);
  }
}

/* ---------------------------------------------------------------------- */

void SkinDivisions::divide_mother(int i, const SkinCellEvent &event, tagint daughter)
{
  atom->type[i] = cells.kinds[event.mother.kind].type;
  cells.state.divisions_left[i] = event.mother.divisions_left;
  const int number = ++cells.state.divisions_done[i];
  cells.state.next_division[i] = next_after(i, event.time, number);
  pairs.begin(i, daughter, event.time);
  std::copy(event.mother_x, event.mother_x + 3, atom->x[i]);
}

/* ---------------------------------------------------------------------- */

void SkinDivisions::start_daughter(int i, const SkinCellEvent &event)
{
  atom->mask[i] = 1 | cells.groupbit | (atom->mask[i] & inherited_groups);
  std::copy(event.x, event.x + 3, atom->x[i]);
  cells.state.divisions_left[i] = event.cell.divisions_left;
  cells.state.divisions_done[i] = 0;
  cells.state.parent[i] = event.id;
  pairs.begin(i, event.id, event.time);
  cells.state.birth_time[i] = event.time;
  cells.state.detached_time[i] = SkinCellState::NEVER;
  cells.state.next_division[i] = next_after(i, event.time, 0);
}
