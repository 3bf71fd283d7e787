// births in fix skin/cells

#include "fix_skin_cells.h"

#include "skin_atom_copy.h"
#include "skin_random.h"

#include "atom.h"
#include "domain.h"
#include "error.h"
#include "library.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

/* ----------------------------------------------------------------------
   the two cells lie on both sides of the mother's place, in a direction that is uniform in the
   plane normal to the line from her to her nearest membrane particle
------------------------------------------------------------------------- */

SkinCellEvent FixSkinCells::division_of(int i, double earliest,
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

  const int number = state.divisions_done[i] + 1;
  const double angle = 2.0 * M_PI *
      SkinRandom::uniform(seed, atom->tag[i], number, SkinRandom::ORIENTATION);

  const SkinCellKinds::Stage stage = {kind_of(i), state.divisions_left[i]};
  SkinCellEvent event = death_of(i);
  event.kind = SkinCellEvent::BIRTH;
  event.time = std::max(state.next_division[i], earliest);
  event.mother = kinds.after_division(stage);
  event.cell = kinds.newborn(stage);
  for (int d = 0; d < 3; d++) {
    const double step = half_separation * (std::cos(angle) * u[d] + std::sin(angle) * v[d]);
    event.x[d] = x[d] + step;
    event.mother_x[d] = x[d] - step;
  }
  middle_of_subdomain(event.site);
  return event;
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::middle_of_subdomain(double *x) const
{
  const double *const lo = domain->triclinic ? domain->sublo_lamda : domain->sublo;
  const double *const hi = domain->triclinic ? domain->subhi_lamda : domain->subhi;
  for (int d = 0; d < 3; d++) x[d] = 0.5 * (lo[d] + hi[d]);
  if (domain->triclinic) domain->lamda2x(x, x);
}

/* ----------------------------------------------------------------------
   ids are never used twice, also not those of the dead, nor those that other commands give
------------------------------------------------------------------------- */

void FixSkinCells::skip_used_ids()
{
  tagint highest = 0, highest_all;
  for (int i = 0; i < atom->nlocal; i++) highest = std::max(highest, atom->tag[i]);
  MPI_Allreduce(&highest, &highest_all, 1, MPI_LMP_TAGINT, MPI_MAX, world);
  next_id = std::max(next_id, (bigint) highest_all + 1);
}

/* ---------------------------------------------------------------------- */

tagint FixSkinCells::new_id()
{
  if (next_id > MAXTAGINT)
    error->all(FLERR, "Fix skin/cells: out of atom IDs on step {}, the largest is {}",
               update->ntimestep, MAXTAGINT);
  return (tagint) next_id++;
}

/* ----------------------------------------------------------------------
   a newborn begins on the rank of her mother, as a copy of her: wherever it is then, the exchange
   that follows brings it to its own
------------------------------------------------------------------------- */

void FixSkinCells::give_birth(const std::vector<SkinCellEvent> &newborn)
{
  const int n = (int) newborn.size();
  if (n == 0) return;

  // the log gave them the last n ids, in this order

  std::vector<tagint> ids(n);
  std::vector<int> types(n);
  std::vector<double> sites(3 * n);
  for (int k = 0; k < n; k++) {
    ids[k] = (tagint) (next_id - n + k);
    types[k] = kinds[newborn[k].cell.kind].type;
    std::copy(newborn[k].site, newborn[k].site + 3, &sites[3 * k]);
  }

  // the old ghosts end here: borders come anew after the exchange

  atom->nghost = 0;
  lammps_create_atoms(lmp, n, ids.data(), types.data(), sites.data(), nullptr, nullptr, 0);
  refresh_state();

  for (int k = 0; k < n; k++) {
    const int mother = owned_index(newborn[k].id), daughter = owned_index(ids[k]);
    if ((mother < 0) != (daughter < 0))
      error->one(FLERR, "Fix skin/cells: cell {} and its daughter {} are on different ranks",
                 newborn[k].id, ids[k]);
    if (mother < 0) continue;
    SkinAtomCopy::copy(lmp, mother, daughter);
    divide_mother(mother, newborn[k], ids[k]);
    start_daughter(daughter, newborn[k]);
  }
  births += n;
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::divide_mother(int i, const SkinCellEvent &event, tagint daughter)
{
  atom->type[i] = kinds[event.mother.kind].type;
  state.divisions_left[i] = event.mother.divisions_left;
  const int number = ++state.divisions_done[i];
  state.next_division[i] = next_division(i, event.time, number);
  state.pair[i] = daughter;
  state.pair_start[i] = event.time;
  hide(i, daughter);
  std::copy(event.mother_x, event.mother_x + 3, atom->x[i]);
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::start_daughter(int i, const SkinCellEvent &event)
{
  atom->mask[i] = 1 | groupbit | (atom->mask[i] & inherited_groups);
  std::copy(event.x, event.x + 3, atom->x[i]);
  state.divisions_left[i] = event.cell.divisions_left;
  state.divisions_done[i] = 0;
  state.parent[i] = event.id;
  state.pair[i] = event.id;
  state.pair_start[i] = event.time;
  hide(i, event.id);
  state.birth_time[i] = event.time;
  state.detached_time[i] = SkinCellState::NEVER;
  state.next_division[i] = next_division(i, event.time, 0);
}
