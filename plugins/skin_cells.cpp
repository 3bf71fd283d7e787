#include "skin_cells.h"

#include "skin_remedy.h"

#include "error.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <utility>

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

void SkinCells::find_state()
{
  const std::string missing = state.refresh(atom);
  if (!missing.empty())
    error->all(FLERR, "Fix skin/cells needs the per-atom property {}: define fix ID all "
               "property/atom {} first", missing, SkinCellState::PROPERTIES);
}

/* ---------------------------------------------------------------------- */

void SkinCells::check(int i, bigint next_id) const
{
  const int kind = kind_of(i);
  const int m = state.divisions_left[i];
  if (kind == NONE) return;

  if (m < 0 || (kinds[kind].limited() && m == 0) || (kinds[kind].spent && m != 0))
    error->one(FLERR, "Fix skin/cells: cell {} is of kind {} and has {} divisions left",
               atom->tag[i], kinds[kind].name, m);
  if (state.pair[i] == atom->tag[i] || state.pair[i] < 0 || state.pair[i] >= next_id)
    error->one(FLERR, "Fix skin/cells: cell {} is paired with {}, which is no other cell",
               atom->tag[i], state.pair[i]);

  for (const int *bonus : {atom->ellipsoid, atom->line, atom->tri, atom->body})
    if (bonus && bonus[i] >= 0)
      error->one(FLERR, "Fix skin/cells: cell {} is an ellipsoid, a line, a triangle or a body, "
                 "which cannot divide", atom->tag[i]);
  if (state.parent[i] == atom->tag[i])
    error->one(FLERR, "Fix skin/cells: parent = {} of cell {} must be another cell, or 0 for none",
               state.parent[i], atom->tag[i]);
  for (const auto &[name, value] : {std::pair{"divisions_done", state.divisions_done[i]},
                                    std::pair{"parent", state.parent[i]}})
    if (value < 0)
      error->one(FLERR, "Fix skin/cells: {} = {} of cell {} must be >= 0", name, value,
                 atom->tag[i]);
  for (const auto &[name, value] : {std::pair{"next_division", state.next_division[i]},
                                    std::pair{"birth_time", state.birth_time[i]},
                                    std::pair{"pair_start", state.pair_start[i]},
                                    std::pair{"detached_time", state.detached_time[i]}})
    if (!std::isfinite(value))
      error->one(FLERR, "Fix skin/cells: {} = {} of cell {} must be finite", name, value,
                 atom->tag[i]);

  // data files do not hold the time

  const double now = clock.time_of_step(update->ntimestep);
  const double pair_start = state.pair[i] ? state.pair_start[i] : 0.0;
  for (const auto &[name, value] : {std::pair{"birth_time", state.birth_time[i]},
                                    std::pair{"pair_start", pair_start},
                                    std::pair{"detached_time", state.detached_time[i]}})
    if (value > 0.0 && value > now + update->dt)
      error->one(FLERR, "Fix skin/cells: {} = {} of cell {} is after the time of the run, {}: use "
                 "reset_timestep with the step and the time of its state", name, value,
                 atom->tag[i], now);
}

/* ---------------------------------------------------------------------- */

SkinCellEvent SkinCells::event(int i, int what, double time) const
{
  SkinCellEvent event = {};
  event.kind = what;
  event.time = time;
  event.id = atom->tag[i];
  event.other = state.pair[i];
  event.parent = state.parent[i];
  event.cell = {kind_of(i), state.divisions_left[i]};
  std::copy(atom->x[i], atom->x[i] + 3, event.x);
  return event;
}

/* ---------------------------------------------------------------------- */

std::string SkinCells::remedy() const
{
  if (atom->natoms != known_atoms) return "";
  return skin_remedy(update, modify, update->ntimestep == update->firststep);
}
