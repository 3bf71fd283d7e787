// errors of fix skin/motion: a run that is unstable, and whose fault it is

#include "fix_skin_motion.h"

#include "bond_skin_stretch.h"
#include "dihedral_skin_bend.h"
#include "fix_skin_cells.h"
#include "skin_random.h"
#include "skin_remedy.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FixConst;

// part of all particles at all stages that may be out of the lists' reach without a warning

static constexpr double NOTEWORTHY = 1.0e-4;

/* ---------------------------------------------------------------------- */

void FixSkinMotion::setup_pre_force(int /*vflag*/)
{
  check_links();
}

/* ----------------------------------------------------------------------
   triangles that were inverted by a step of an earlier run are not another command's fault
------------------------------------------------------------------------- */

void FixSkinMotion::setup(int /*vflag*/)
{
  left = false;
  if (inverted_time == 0.0) inverted_at_start = bend && bend->find_inverted();
}

/* ---------------------------------------------------------------------- */

void FixSkinMotion::pre_force(int /*vflag*/)
{
  check_links();
}

/* ----------------------------------------------------------------------
   a bond style that is given as a table may end where its table does
------------------------------------------------------------------------- */

void FixSkinMotion::check_links() const
{
  if (std::isinf(longest_link)) return;

  for (int n = 0; n < neighbor->nbondlist; n++) {
    const int i = neighbor->bondlist[n][0], j = neighbor->bondlist[n][1];
    const double *const x = atom->x[i], *const y = atom->x[j];
    const double r = std::sqrt((x[0] - y[0]) * (x[0] - y[0]) + (x[1] - y[1]) * (x[1] - y[1]) +
                               (x[2] - y[2]) * (x[2] - y[2]));
    if (!(r > shortest_link && r < longest_link))
      error->one(FLERR,
                 "Fix skin/motion: the link of atoms {} and {} has length {} on step {}, it must "
                 "be between {} and {}{}",
                 atom->tag[i], atom->tag[j], r, update->ntimestep, shortest_link, longest_link,
                 skin_remedy(update, modify, false));
  }
}

/* ----------------------------------------------------------------------
   a particle beyond a fixed end of the box would be dropped at the next exchange
------------------------------------------------------------------------- */

void FixSkinMotion::check_box() const
{
  const bool fixed[2] = {domain->boundary[2][0] == 1, domain->boundary[2][1] == 1};
  if (!fixed[0] && !fixed[1]) return;

  for (int i = 0; i < atom->nlocal; i++) {
    const double z = atom->x[i][2];
    if ((z < domain->boxlo[2] && fixed[0]) || (z >= domain->boxhi[2] && fixed[1]))
      error->one(FLERR,
                 "Fix skin/motion: atom {} of type {} leaves the box on step {}: z = {}, the box "
                 "is from {} to {}", atom->tag[i], atom->type[i], update->ntimestep, z,
                 domain->boxlo[2], domain->boxhi[2]);
  }
}

/* ----------------------------------------------------------------------
   whether the next evaluation of forces would end the run, on any rank
------------------------------------------------------------------------- */

bool FixSkinMotion::ends_in_error()
{
  comm->forward_comm();
  int mine = (cells && cells->any_astray()) || (stretch && stretch->any_broken()), any;
  MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
  return any;
}

/* ----------------------------------------------------------------------
   a number that changes with the ID or position of any atom, whatever their order
------------------------------------------------------------------------- */

uint64_t FixSkinMotion::state_of_atoms() const
{
  uint64_t mine = 0, all = 0;
  for (int i = 0; i < atom->nlocal; i++) {
    uint64_t word = (uint64_t) atom->tag[i];
    for (int d = 0; d < 3; d++) {
      uint64_t bits;
      std::memcpy(&bits, &atom->x[i][d], sizeof(bits));
      word = SkinRandom::mix(word ^ bits);
    }
    mine += word;
  }
  MPI_Allreduce(&mine, &all, 1, MPI_UINT64_T, MPI_SUM, world);
  return all;
}

/* ----------------------------------------------------------------------
   whether other commands have moved atoms since the last run, and this is the first step after it,
   without a set-up that would have looked at them
------------------------------------------------------------------------- */

bool FixSkinMotion::begins_disturbed() const
{
  return disturbed && update->ntimestep == update->firststep + 1;
}

/* ----------------------------------------------------------------------
   particles that moved further than the neighbor lists of their step allow: told after the run
------------------------------------------------------------------------- */

void FixSkinMotion::post_run()
{
  left = true;
  left_as = state_of_atoms();
  bigint mine = beyond - beyond_before, all = 0;
  double furthest = 0.0;
  MPI_Allreduce(&mine, &all, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  MPI_Allreduce(&furthest_listed, &furthest, 1, MPI_DOUBLE, MPI_MAX, world);
  const double part = (double) all / std::max((double) within_steps * (double) atom->natoms, 1.0);
  if (part < NOTEWORTHY || comm->me != 0) return;
  error->warning(FLERR,
                 "Fix skin/motion: in {} case{} ({:.2g} of all) a particle was within a step "
                 "further from where it had been listed than the neighbor skin allows: it may have "
                 "missed contacts until the end of that step; use a neighbor skin of {:.4g} "
                 "instead of {} or a smaller timestep than {}",
                 all, all == 1 ? "" : "s", part, std::sqrt(furthest) * neighbor->skin,
                 neighbor->skin, update->dt);
}

/* ---------------------------------------------------------------------- */

void FixSkinMotion::unstable(const Move &move, double part, bool at_start)
{
  double what[3] = {0.0, 0.0, 0.0};
  if (move.rank == comm->me && furthest_particle >= 0) {
    const double *f = atom->f[furthest_particle];
    what[0] = (double) atom->tag[furthest_particle];
    what[1] = atom->type[furthest_particle];
    what[2] = std::sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
  }
  MPI_Bcast(what, 3, MPI_DOUBLE, move.rank, world);
  const std::string term = largest_term(move.rank, furthest_particle);
  error->all(FLERR,
             "Fix skin/motion: the run is unstable on step {}: the force on atom {} of type {} is "
             "{}, most of it from {}, which would need a timestep of {}{}",
             update->ntimestep, (tagint) what[0], (int) what[1], what[2], term, part,
             skin_remedy(update, modify, at_start));
}
