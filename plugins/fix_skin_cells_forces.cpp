// forces of fix skin/cells: attachment to the nearest membrane particle, division springs

#include "fix_skin_cells.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

void FixSkinCells::pre_force(int /*vflag*/)
{
  if (!reach_checked) attachment.check_reach();
  reach_checked = true;
  find_nearest();
  take_away_left();
}

/* ----------------------------------------------------------------------
   a cell that was seen to have left waits for the event step that removes it, and no force knows
   of it: while forces are computed it is far above the box, and far from all others that are
   there. With a bond that the user has given it, it stays where it is.
------------------------------------------------------------------------- */

void FixSkinCells::take_away_left()
{
  away.assign(cells.list.size(), NAN);
  const double now = cells.clock.now();
  int mine = 0;
  for (size_t k = 0; k < cells.list.size(); k++) {
    const int i = cells.list[k];
    if (!cells.left_before(i, now) || pairs.is_bonded(i)) continue;
    away[k] = atom->x[i][2];
    atom->x[i][2] += (1.0 + (double) atom->tag[i]) * domain->prd[2];
    mine = 1;
  }
  MPI_Allreduce(&mine, &any_away, 1, MPI_INT, MPI_MAX, world);
  if (any_away) comm->forward_comm();
}

/* ----------------------------------------------------------------------
   after forces; Monte Carlo fixes, which want energies alone, do without the reverse communication
------------------------------------------------------------------------- */

void FixSkinCells::put_back_left()
{
  if (!any_away) return;
  for (size_t k = 0; k < away.size(); k++)
    if (is_away(k)) atom->x[cells.list[k]][2] = away[k];
  any_away = 0;
  comm->forward_comm();
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::min_pre_force(int vflag)
{
  cells.clock.stand_still();
  pre_force(vflag);
}

/* ----------------------------------------------------------------------
   forces of this fix are added before the reverse communication, which sends those on ghosts home;
   trials of Monte Carlo fixes, in which no cell leaves, do not come here
------------------------------------------------------------------------- */

void FixSkinCells::pre_reverse(int eflag, int vflag)
{
  for (size_t k = 0; k < cells.list.size(); k++) attachment.watch(cells.list[k], closest[k]);
  add_forces(ATTACHMENT | SPRINGS, eflag, vflag);
  put_back_left();
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::min_pre_reverse(int eflag, int vflag)
{
  pre_reverse(eflag, vflag);
}

/* ----------------------------------------------------------------------
   the nearest membrane particles of my cells
------------------------------------------------------------------------- */

void FixSkinCells::find_nearest()
{
  cells.find_state();
  if (rearranged) list_cells();
  closest.resize(cells.list.size());
  for (size_t k = 0; k < closest.size(); k++) closest[k] = attachment.nearest_candidate((int) k);
}

/* ----------------------------------------------------------------------
   forces on cells and on owned and ghost membrane particles
------------------------------------------------------------------------- */

void FixSkinCells::add_forces(int which, int eflag, int vflag)
{
  ev_init(eflag, vflag);
  std::fill(energy, energy + NTERMS, 0.0);
  energy_summed = false;

  for (size_t k = 0; k < cells.list.size(); k++) {
    const int i = cells.list[k];
    if ((which & ATTACHMENT) && !is_away(k)) attach(i, closest[k]);
    if ((which & SPRINGS) && !is_away(k) && cells.state.pair[i])
      parted[k] = pull_pair(i) > pairs.apart;
    if (!cells.clock.is_within_step()) write_row(i, closest[k]);
  }
}

/* ----------------------------------------------------------------------
   the energy of a cell and its membrane particle is the cell's, since that is mine
------------------------------------------------------------------------- */

void FixSkinCells::attach(int i, const SkinNearest::Neighbor &closest)
{
  if (cells.kind_of(i) == SkinCells::NONE) return;
  const SkinAttachment::Pull pull = attachment.pull(i, closest);
  if (pull.energy == 0.0 && pull.factor == 0.0) return;

  const int term = pull.law == SkinCellKind::ADHESIVE ? ADHESION : BINDING;
  const double *const x = atom->x[i];
  double way[3] = {0.0, 0.0, 0.0};
  if (pull.factor != 0.0) {
    const double *const y = atom->x[closest.index];
    double *const f = atom->f[closest.index];
    for (int d = 0; d < 3; d++) {
      way[d] = x[d] - y[d];
      f[d] -= pull.factor * way[d];
    }
  }
  tally(term, i, pull.energy, way, pull.factor, 1.0);
}

/* ----------------------------------------------------------------------
   division spring: each owner computes the force on its own cell, and half of the energy; returns
   the distance of the two
------------------------------------------------------------------------- */

double FixSkinCells::pull_pair(int i)
{
  const SkinDividingPairs::Spring spring = pairs.spring(i);
  tally(DIVISION, i, 0.5 * spring.energy, spring.way, spring.factor, 0.5);
  return spring.distance;
}

/* ----------------------------------------------------------------------
   energy of a term, and force on cell i as a multiple of its way from another particle, of whose
   virial it has this share
------------------------------------------------------------------------- */

void FixSkinCells::tally(int term, int i, double e, const double *way, double factor, double share)
{
  energy[term] += e;
  if (eflag_atom) eatom[i] += e;
  if (factor == 0.0) return;
  for (int d = 0; d < 3; d++) atom->f[i][d] += factor * way[d];

  if (vflag_either) {
    double v[6] = {way[0] * way[0], way[1] * way[1], way[2] * way[2],
                   way[0] * way[1], way[0] * way[2], way[1] * way[2]};
    for (double &w : v) w *= share * factor;
    v_tally(i, v);
  }
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::write_row(int i, const SkinNearest::Neighbor &closest)
{
  const SkinCellState &state = cells.state;
  const bool sure = attachment.is_sure(closest);
  double *row = array_atom[i];
  row[0] = sure ? atom->tag[closest.index] : 0;
  row[1] = state.divisions_left[i];
  row[2] = state.next_division[i];
  row[3] = state.parent[i];
  row[4] = state.pair[i];
  row[5] = state.birth_time[i];
  row[6] = sure ? std::sqrt(closest.distsq) : -1.0;
  row[7] = state.pair[i] ? state.pair_start[i] : SkinCellState::NEVER;
}
