#include "skin_attachment.h"

#include "skin_dividing_pairs.h"
#include "skin_margins.h"

#include "comm.h"
#include "domain.h"
#include "error.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

void SkinAttachment::list_candidates()
{
  nearest.clear_candidates();
  if (cells.list.empty()) return;
  sort_membrane();
  const std::vector<double> margins = skin_margins(lmp);
  for (int i : cells.list)
    nearest.add_candidates(atom->x[i], margins[atom->type[i]] + margins[membrane_type], atom->tag);
}

/* ---------------------------------------------------------------------- */

SkinNearest::Neighbor SkinAttachment::nearest_candidate(int k)
{
  return nearest.nearest_candidate(k, atom->x[cells.list[k]], atom->x[0], atom->tag);
}

/* ----------------------------------------------------------------------
   how far ghost atoms reach; LAMMPS has it in fractions of a triclinic box
------------------------------------------------------------------------- */

double SkinAttachment::ghost_cutoff() const
{
  const double *const cutoff = comm->cutghost;
  if (domain->triclinic) return cutoff[2] * domain->prd[2];
  return std::min({cutoff[0], cutoff[1], cutoff[2]});
}

/* ----------------------------------------------------------------------
   how far from its owner the nearest membrane particle of a cell is sure to be known
------------------------------------------------------------------------- */

double SkinAttachment::reach() const
{
  return ghost_cutoff() - 2.0 * neighbor->skin;
}

/* ---------------------------------------------------------------------- */

bool SkinAttachment::is_sure(const SkinNearest::Neighbor &closest) const
{
  return closest.index >= 0 && closest.distsq <= reach() * reach();
}

/* ----------------------------------------------------------------------
   ghost particles must reach far enough to hold the nearest membrane particle of any cell
   that is not yet detached, now and until the next neighbor build
------------------------------------------------------------------------- */

void SkinAttachment::check_reach() const
{
  const double needed = cells.kinds.longest_range() * contact + 2.0 * neighbor->skin;
  if (comm->mode != Comm::SINGLE)
    error->all(FLERR, "Fix skin/cells needs one communication cutoff for all types: use "
               "comm_modify mode single");
  if (ghost_cutoff() < needed)
    error->all(FLERR, "Fix skin/cells needs a communication cutoff of at least {} but has {}: use "
               "comm_modify cutoff", needed, ghost_cutoff());
}

/* ----------------------------------------------------------------------
   how far out of contact, as part of the contact length
------------------------------------------------------------------------- */

double SkinAttachment::stretch(const SkinNearest::Neighbor &closest) const
{
  return closest.index < 0 ? INFINITY : std::sqrt(closest.distsq) / contact - 1.0;
}

/* ----------------------------------------------------------------------
   no force beyond the range of the law, nor on a cell that has left
------------------------------------------------------------------------- */

SkinAttachment::Pull SkinAttachment::pull(int i, const SkinNearest::Neighbor &closest) const
{
  const SkinCellKind &kind = cells.row_of(i);
  const double x = stretch(closest);
  if (kind.law == SkinCellKind::NO_LAW || !(x > 0.0)) return {kind.law, 0.0, 0.0};

  const double width = kind.range - 1.0, end = kind.detachment - 1.0;
  const double s = std::min({x, width, end}), stiffness = stiffness_of(i);
  const double q = kind.law == SkinCellKind::ADHESIVE ? s * s / (width * width) : 0.0;
  const double slope = x > end ? 0.0 : stiffness * s * (1.0 - q);
  const double energy = 0.5 * stiffness * s * s * (1.0 - 0.5 * q);
  const bool pulls = slope != 0.0 && closest.index >= 0;
  return {kind.law, pulls ? -slope / (contact * std::sqrt(closest.distsq)) : 0.0, energy};
}

/* ----------------------------------------------------------------------
   K of the law of a cell, which may be another one in a dividing pair
------------------------------------------------------------------------- */

double SkinAttachment::stiffness_of(int i) const
{
  const SkinCellKind &kind = cells.row_of(i);
  const bool paired = kind.paired && cells.state.pair[i] &&
      cells.kind_of(pairs.partner_of(i)) == kind.paired;
  return paired ? kind.paired_stiffness : kind.stiffness;
}

/* ---------------------------------------------------------------------- */

void SkinAttachment::watch(int i, const SkinNearest::Neighbor &closest)
{
  const SkinCellKind &kind = cells.row_of(i);
  const bool at_end = !cells.clock.is_within_step();
  const double r = closest.index < 0 ? INFINITY : std::sqrt(closest.distsq);
  double &detached_time = cells.state.detached_time[i];

  if (r < core && at_end && !cells.detached(i)) pierced(i, closest, r);
  if (kind.always_pulled()) {
    if (!(r <= reach()) && at_end) lost(i, r);
  } else if (kind.detaches() && !(stretch(closest) <= kind.detachment - 1.0) &&
             detached_time < 0.0 && update->whichflag == 1 &&
             !(pairs.stay && cells.state.pair[i])) {
    detached_time = cells.clock.now();
  }
}

/* ----------------------------------------------------------------------
   what was noted at the start of a part of a step itself stays
------------------------------------------------------------------------- */

void SkinAttachment::forget_detached_after(double time)
{
  for (int i = 0; i < atom->nlocal; i++)
    if (cells.kind_of(i) != SkinCells::NONE &&
        cells.clock.is_before(time, cells.state.detached_time[i]))
      cells.state.detached_time[i] = SkinCellState::NEVER;
}

/* ----------------------------------------------------------------------
   whether any of my cells is lost or has pierced the membrane at the current positions, also of
   ghosts
------------------------------------------------------------------------- */

bool SkinAttachment::any_astray()
{
  for (int k = 0; k < (int) cells.list.size(); k++) {
    const SkinNearest::Neighbor closest = nearest_candidate(k);
    if (cells.row_of(cells.list[k]).always_pulled() && !is_sure(closest)) return true;
    const bool close = closest.index >= 0 && closest.distsq < core * core;
    if (close && !cells.detached(cells.list[k])) return true;
  }
  return false;
}

/* ---------------------------------------------------------------------- */

void SkinAttachment::lost(int i, double r) const
{
  error->one(FLERR, "Fix skin/cells: {} cell {} has lost the membrane on step {}: its nearest "
             "membrane particle is at {} but the ghost particles reach to {}, which comm_modify "
             "cutoff can extend{}",
             cells.row_of(i).name, atom->tag[i], update->ntimestep, r, reach(), cells.remedy());
}

/* ----------------------------------------------------------------------
   no force lets a cell come so close: it is on its way through the membrane
------------------------------------------------------------------------- */

void SkinAttachment::pierced(int i, const SkinNearest::Neighbor &closest, double r) const
{
  error->one(FLERR, "Fix skin/cells: cell {} of type {} breaks through the membrane on step {}: it "
             "is at {} from membrane particle {}, less than {}{}",
             atom->tag[i], atom->type[i], update->ntimestep, r, atom->tag[closest.index], core,
             cells.remedy());
}
