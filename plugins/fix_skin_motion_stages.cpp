// stages of a step of fix skin/motion, and where its parts begin

#include "fix_skin_motion.h"

#include "bond_skin_stretch.h"
#include "fix_skin_cells.h"

#include "atom.h"
#include "comm.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

/* ----------------------------------------------------------------------
   one stage: new positions; returns the longest way from the start of this part, or a bound for it
   that is no more than the largest move, infinite for what is no number and if forces were those of
   a broken link
------------------------------------------------------------------------- */

FixSkinMotion::Move FixSkinMotion::stage(const SkinStage &c, double part)
{
  const bool broken = stretch && stretch->had_broken();
  if (stretch) stretch->spare_links(false);
  furthest_particle = -1;
  const int n = 3 * atom->nlocal;

  // all move in the same way

  if (igroup == 0 && method.order == 1 && std::isinf(stiffness_limit)) {
    const double bound = n ? std::sqrt(3.0 * skin_advance(c, part, n, atom->x[0], before.data(),
                                                          start.data(), atom->f[0])) : 0.0;
    if (broken || bound <= largest_move) return furthest(broken ? INFINITY : bound);
  } else {
    advance_each(c, part);
  }

  double longest = 0.0;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    const double *const x = atom->x[i], *const y = &start[3 * (size_t) i];
    double distsq = 0.0;
    for (int d = 0; d < 3; d++) distsq += (x[d] - y[d]) * (x[d] - y[d]);
    if (distsq <= longest) continue;
    longest = std::isnan(distsq) ? INFINITY : distsq;
    furthest_particle = i;
  }
  return furthest(broken ? INFINITY : std::sqrt(longest));
}

/* ----------------------------------------------------------------------
   particles of the group, each with its mobility, in a method of any order
------------------------------------------------------------------------- */

void FixSkinMotion::advance_each(const SkinStage &c, double part)
{
  const double *const at_start = (method.order > 1 ? start_mobility : mobility).data();
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    const double time = part * mobility[i], start_time = part * at_start[i];
    for (int d = 0; d < 3; d++) {
      const int n = 3 * i + d;
      const double old = atom->x[i][d];
      atom->x[i][d] = c.previous * old + c.before * before[n] + c.start * start[n] +
          time * c.force * atom->f[i][d] + start_time * c.first * start_force[n];
      before[n] = old;
    }
  }
}

/* ----------------------------------------------------------------------
   longest of the moves of all ranks, and whose it is; kept
------------------------------------------------------------------------- */

FixSkinMotion::Move FixSkinMotion::furthest(double mine)
{
  Move local = {mine, comm->me}, all = {};
  MPI_Allreduce(&local, &all, 1, MPI_DOUBLE_INT, MPI_MAXLOC, world);
  latest = all;
  return all;
}

/* ---------------------------------------------------------------------- */

void FixSkinMotion::keep_start()
{
  const size_t n = 3 * (size_t) atom->nlocal;
  const double *const x = n ? atom->x[0] : nullptr, *const f = n ? atom->f[0] : nullptr;
  start.assign(x, x + n);
  start_force.assign(f, f + n);
  before.resize(n);
}

/* ----------------------------------------------------------------------
   back to the start of a part, at this time before the end of the step
------------------------------------------------------------------------- */

void FixSkinMotion::restore_start(double offset)
{
  if (atom->nlocal) {
    std::copy(start.begin(), start.end(), atom->x[0]);
    std::copy(start_force.begin(), start_force.end(), atom->f[0]);
    before = start;
  }
  if (cells) cells->forget_detached_after(offset);
}
