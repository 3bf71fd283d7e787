// Overdamped motion dr/dt = F by forward Euler. A step in which some particle would move too far
// is divided into shorter ones, with the forces computed anew after each.

#include "fix_skin_motion.h"

#include "atom.h"
#include "bond.h"
#include "comm.h"
#include "dihedral.h"
#include "error.h"
#include "force.h"
#include "modify.h"
#include "pair.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FixConst;

// a step is never divided into shorter ones than this part of it: what moves faster is unstable

static constexpr double SHORTEST = 1.0e-6;

/* ---------------------------------------------------------------------- */

FixSkinMotion::FixSkinMotion(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), refined(0), substeps(0)
{
  if (narg != 4) error->all(FLERR, "Fix skin/motion needs one value, the largest move of a step");
  largest_move = utils::numeric(FLERR, arg[3], false, lmp);
  if (!(largest_move > 0.0) || std::isinf(largest_move))
    error->all(FLERR, "Fix skin/motion largest move = {}: must be a number > 0", arg[3]);

  time_integrate = 1;
  vector_flag = 1;
  size_vector = 2;
  extvector = 0;
  global_freq = 1;
}

/* ---------------------------------------------------------------------- */

int FixSkinMotion::setmask()
{
  return INITIAL_INTEGRATE;
}

/* ---------------------------------------------------------------------- */

void FixSkinMotion::init()
{
  if (force->angle || force->improper || force->kspace)
    error->all(FLERR, "Fix skin/motion computes pair, bond and dihedral forces alone: it works "
               "without angle, improper and kspace styles");
}

/* ---------------------------------------------------------------------- */

void FixSkinMotion::initial_integrate(int /*vflag*/)
{
  double remaining = update->dt;
  bigint pieces = 0;

  while (remaining > 0.0) {
    int fastest_atom;
    const Fastest fastest = find_fastest(fastest_atom);
    double piece = remaining;
    if (!(fastest.force * remaining <= largest_move)) {
      piece = largest_move / fastest.force;
      if (!(piece > SHORTEST * update->dt)) unstable(fastest, fastest_atom, piece);
    }

    move(piece);
    pieces++;
    remaining = (piece < remaining) ? remaining - piece : 0.0;
    if (remaining > 0.0) evaluate_forces();
  }

  if (pieces > 1) {
    refined++;
    substeps += pieces;
  }
}

/* ----------------------------------------------------------------------
   largest force on any particle of any rank, and which of mine it is on if it is mine;
   a force that is no number is the largest of all
------------------------------------------------------------------------- */

FixSkinMotion::Fastest FixSkinMotion::find_fastest(int &mine) const
{
  const double *const *const f = atom->f;
  double largest = 0.0;
  mine = -1;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    const double fsq = f[i][0] * f[i][0] + f[i][1] * f[i][1] + f[i][2] * f[i][2];
    if (fsq <= largest) continue;
    largest = std::isnan(fsq) ? INFINITY : fsq;
    mine = i;
  }

  Fastest local = {std::sqrt(largest), comm->me}, fastest;
  MPI_Allreduce(&local, &fastest, 1, MPI_DOUBLE_INT, MPI_MAXLOC, world);
  return fastest;
}

/* ---------------------------------------------------------------------- */

void FixSkinMotion::move(double time)
{
  double *const *const x = atom->x;
  const double *const *const f = atom->f;
  for (int i = 0; i < atom->nlocal; i++)
    if (atom->mask[i] & groupbit)
      for (int d = 0; d < 3; d++) x[i][d] += time * f[i][d];
}

/* ----------------------------------------------------------------------
   all forces at the current positions, in the order of a time step
------------------------------------------------------------------------- */

void FixSkinMotion::evaluate_forces()
{
  comm->forward_comm();

  const int n = atom->nlocal + (force->newton ? atom->nghost : 0);
  if (n) std::fill(atom->f[0], atom->f[0] + 3 * (size_t) n, 0.0);

  if (modify->n_pre_force) modify->pre_force(0);
  if (force->pair) force->pair->compute(0, 0);
  if (force->bond) force->bond->compute(0, 0);
  if (force->dihedral) force->dihedral->compute(0, 0);
  if (modify->n_pre_reverse) modify->pre_reverse(0, 0);
  if (force->newton) comm->reverse_comm();
  if (modify->n_post_force_any) modify->post_force(0);
}

/* ---------------------------------------------------------------------- */

void FixSkinMotion::unstable(const Fastest &fastest, int i, double piece) const
{
  int which[2] = {0, 0};
  if (i >= 0) {
    which[0] = (int) atom->tag[i];
    which[1] = atom->type[i];
  }
  MPI_Bcast(which, 2, MPI_INT, fastest.rank, world);
  error->all(FLERR,
             "Fix skin/motion: the run is unstable on step {}: the force on atom {} of type {} is "
             "{}, which would need a timestep of {}; try a smaller timestep than {}",
             update->ntimestep, which[0], which[1], fastest.force, piece, update->dt);
}

/* ----------------------------------------------------------------------
   number of steps that were divided, and of the substeps of these
------------------------------------------------------------------------- */

double FixSkinMotion::compute_vector(int n)
{
  return n == 0 ? (double) refined : (double) substeps;
}
