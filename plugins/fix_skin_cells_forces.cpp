// forces of fix skin/cells: adhesion or binding to the nearest membrane particle, division springs

#include "fix_skin_cells.h"

#include "skin_remedy.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <string>

using namespace LAMMPS_NS;

/* ----------------------------------------------------------------------
   added before the reverse communication, which sends forces on ghosts home
------------------------------------------------------------------------- */

void FixSkinCells::pre_reverse(int eflag, int vflag)
{
  add_forces(ATTACHMENT | SPRINGS, eflag, vflag);
}

/* ----------------------------------------------------------------------
   forces on cells and on owned and ghost membrane particles
------------------------------------------------------------------------- */

void FixSkinCells::add_forces(int which, int eflag, int vflag)
{
  refresh_state();
  if (rearranged) list_cells();
  ev_init(eflag, vflag);
  std::fill(energy, energy + NTERMS, 0.0);
  energy_summed = false;
  parted.assign(cells.size(), 0);

  for (int k = 0; k < (int) cells.size(); k++) {
    const int i = cells[k];
    const SkinNearest::Neighbor closest =
        nearest.nearest_candidate(k, atom->x[i], atom->x[0], atom->tag);
    if (which & ATTACHMENT) attach(i, closest);
    if ((which & SPRINGS) && state.pair[i]) parted[k] = pull_pair(i) > apart;
    write_row(i, closest);
  }
}

/* ----------------------------------------------------------------------
   the iterations of a minimisation are no time, in restart files neither
------------------------------------------------------------------------- */

void FixSkinCells::min_pre_reverse(int eflag, int vflag)
{
  update->atime = setup_time;
  update->atimestep = update->ntimestep;
  pre_reverse(eflag, vflag);
}

/* ----------------------------------------------------------------------
   adhesion or binding of cell i to its nearest membrane particle
------------------------------------------------------------------------- */

void FixSkinCells::attach(int i, const SkinNearest::Neighbor &closest)
{
  if (kind_of(i) == NONE) return;
  const SkinCellKind &kind = kinds[kind_of(i)];
  const double r = closest.index < 0 ? INFINITY : std::sqrt(closest.distsq);
  const double stretch = r / contact - 1.0;
  if (r < core && time_offset == 0.0) pierced(i, closest, r);
  const double end = kind.detachment - 1.0;

  if (!kind.detaches()) {
    if (!(r <= reach()) && time_offset == 0.0) lost(i, r);
  } else if (!(stretch <= end) && state.detached_time[i] < 0.0 && update->whichflag == 1 &&
             !(pairs_stay && state.pair[i])) {
    state.detached_time[i] = now();
  }
  if (kind.law == SkinCellKind::NO_LAW || !(stretch > 0.0)) return;

  // no force beyond the range of the law, nor on a cell that has left

  const double width = kind.range - 1.0, s = std::min({stretch, width, end});
  const double q = kind.law == SkinCellKind::ADHESIVE ? s * s / (width * width) : 0.0;
  const int term = kind.law == SkinCellKind::ADHESIVE ? ADHESION : BINDING;
  const double stiffness = stiffness_of(i);
  tally_energy(term, i, 0.5 * stiffness * s * s * (1.0 - 0.5 * q));
  const double slope = stretch > end ? 0.0 : stiffness * s * (1.0 - q);
  if (slope != 0.0 && closest.index >= 0) add_pair_force(i, closest.index, -slope / (contact * r));
}

/* ----------------------------------------------------------------------
   K of the law of a cell, which may be another one in a dividing pair
------------------------------------------------------------------------- */

double FixSkinCells::stiffness_of(int i) const
{
  const SkinCellKind &kind = kinds[kind_of(i)];
  const bool other = kind.paired && state.pair[i] && kind_of(partner_of(i)) == kind.paired;
  return other ? kind.paired_stiffness : kind.stiffness;
}

/* ----------------------------------------------------------------------
   how far from its owner the nearest membrane particle of a cell is sure to be known
------------------------------------------------------------------------- */

double FixSkinCells::reach() const
{
  return ghost_cutoff() - 2.0 * neighbor->skin;
}

/* ----------------------------------------------------------------------
   whether any of my cells is lost or has pierced the membrane at the current positions, also of
   ghosts
------------------------------------------------------------------------- */

bool FixSkinCells::any_astray()
{
  for (int k = 0; k < (int) cells.size(); k++) {
    const SkinNearest::Neighbor closest =
        nearest.nearest_candidate(k, atom->x[cells[k]], atom->x[0], atom->tag);
    const bool stays = !kinds[kind_of(cells[k])].detaches();
    const bool known = closest.index >= 0 && closest.distsq <= reach() * reach();
    if ((stays && !known) ||
        (closest.index >= 0 && closest.distsq < core * core))
      return true;
  }
  return false;
}

/* ----------------------------------------------------------------------
   no timestep is to blame where other commands have made or removed atoms
------------------------------------------------------------------------- */

std::string FixSkinCells::remedy() const
{
  if (atom->natoms != known_atoms) return "";
  return skin_remedy(update, update->ntimestep == update->firststep);
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::lost(int i, double r) const
{
  error->one(FLERR, "Fix skin/cells: {} cell {} has lost the membrane on step {}: its nearest "
             "membrane particle is at {} but the ghost particles reach to {}, which comm_modify "
             "cutoff can extend{}",
             kinds[kind_of(i)].name, atom->tag[i], update->ntimestep, r, reach(),
             remedy());
}

/* ----------------------------------------------------------------------
   no force lets a cell come so close: it is on its way through the membrane
------------------------------------------------------------------------- */

void FixSkinCells::pierced(int i, const SkinNearest::Neighbor &closest, double r) const
{
  error->one(FLERR, "Fix skin/cells: cell {} of type {} breaks through the membrane on step {}: it "
             "is at {} from membrane particle {}, less than {}{}",
             atom->tag[i], atom->type[i], update->ntimestep, r, atom->tag[closest.index], core,
             remedy());
}

/* ----------------------------------------------------------------------
   the other cell of a dividing pair, at its image closest to this one
------------------------------------------------------------------------- */

int FixSkinCells::partner_of(int i) const
{
  const int j = local_index(state.pair[i]);
  if (j < 0)
    error->one(FLERR, "Fix skin/cells: the cells {} and {} of a dividing pair have lost each other "
               "on step {}{}",
               atom->tag[i], state.pair[i], update->ntimestep, remedy());
  return domain->closest_image(i, j);
}

/* ----------------------------------------------------------------------
   division spring: each owner computes the force on its own cell, and half of the energy; returns
   the distance of the two
------------------------------------------------------------------------- */

double FixSkinCells::pull_pair(int i)
{
  const int j = partner_of(i);
  const double *xi = atom->x[i], *xj = atom->x[j];
  const double delta[3] = {xi[0] - xj[0], xi[1] - xj[1], xi[2] - xj[2]};
  const double r = std::sqrt(delta[0] * delta[0] + delta[1] * delta[1] + delta[2] * delta[2]);
  if (r == 0.0)
    error->one(FLERR, "Fix skin/cells: the cells {} and {} of a dividing pair are at one point",
               atom->tag[i], state.pair[i]);

  const double age = now() - state.pair_start[i];
  const double length = std::min(spring_start + spring_rate * age, spring_end);
  const double stretch = r - length;
  const double fpair = -spring_stiffness * stretch / r;

  tally_energy(DIVISION, i, 0.25 * spring_stiffness * stretch * stretch);
  for (int d = 0; d < 3; d++) atom->f[i][d] += fpair * delta[d];

  if (vflag_either) {
    double half[6] = {delta[0] * delta[0], delta[1] * delta[1], delta[2] * delta[2],
                      delta[0] * delta[1], delta[0] * delta[2], delta[1] * delta[2]};
    for (double &h : half) h *= 0.5 * fpair;
    v_tally(i, half);
  }
  return r;
}

/* ----------------------------------------------------------------------
   the energy of a cell and its membrane particle is the cell's, since that is mine
------------------------------------------------------------------------- */

void FixSkinCells::tally_energy(int term, int i, double e)
{
  energy[term] += e;
  if (eflag_atom) eatom[i] += e;
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::add_pair_force(int i, int j, double fpair)
{
  double **x = atom->x, **f = atom->f;
  const double delta[3] = {x[i][0] - x[j][0], x[i][1] - x[j][1], x[i][2] - x[j][2]};
  for (int d = 0; d < 3; d++) {
    f[i][d] += fpair * delta[d];
    f[j][d] -= fpair * delta[d];
  }

  if (vflag_either) {
    double v[6] = {delta[0] * delta[0], delta[1] * delta[1], delta[2] * delta[2],
                   delta[0] * delta[1], delta[0] * delta[2], delta[1] * delta[2]};
    for (double &w : v) w *= fpair;
    v_tally(i, v);
  }
}

/* ---------------------------------------------------------------------- */

void FixSkinCells::write_row(int i, const SkinNearest::Neighbor &closest)
{
  double *row = array_atom[i];
  row[0] = closest.index < 0 ? 0 : atom->tag[closest.index];
  row[1] = state.divisions_left[i];
  row[2] = state.next_division[i];
  row[3] = state.parent[i];
  row[4] = state.pair[i];
  row[5] = state.birth_time[i];
  row[6] = closest.index < 0 ? -1.0 : std::sqrt(closest.distsq);
  row[7] = state.pair[i] ? state.pair_start[i] : SkinCellState::NEVER;
}
