// Overdamped motion dr/dt = m F by forward Euler or a Runge-Kutta-Legendre method; the mobility m
// is 1, or less where the membrane is too stiff for the timestep. A step in which some particle
// would move too far is divided into shorter ones.

#include "fix_skin_motion.h"

#include "bond_skin_stretch.h"
#include "dihedral_skin_bend.h"
#include "fix_skin_cells.h"

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
#include <cstring>

using namespace LAMMPS_NS;
using namespace FixConst;

// a step is never divided into shorter ones than this part of it: what moves faster is unstable

static constexpr double SHORTEST = 1.0e-6;

static constexpr int MOST_STAGES = 99;

// time for which there may be inverted triangles

static constexpr double LONGEST_INVERTED = 2.0;

/* ---------------------------------------------------------------------- */

FixSkinMotion::FixSkinMotion(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), largest_move(INFINITY), stiffness_limit(INFINITY), cells(nullptr),
    bend(nullptr), steps(0), divided(0), parts(0), evaluations(0), limited(0), slowest(1.0),
    offender(-1), inverted_time(0.0)
{
  parse(narg, arg);

  time_integrate = 1;
  vector_flag = 1;
  size_vector = 6;
  extvector = 0;
  global_freq = 1;
  comm_reverse = 1;
}

/* ---------------------------------------------------------------------- */

void FixSkinMotion::parse(int narg, char **arg)
{
  if (narg < 4) error->all(FLERR, "Fix skin/motion needs a method: euler, rkl1 or rkl2");
  const std::string name = arg[3];
  if (name != "euler" && name != "rkl1" && name != "rkl2")
    error->all(FLERR, "Fix skin/motion method = {}: must be euler, rkl1 or rkl2", name);

  int nstages = (name == "euler") ? 1 : 7;
  for (int n = 4; n < narg; n += 2) {
    const std::string key = arg[n];
    if (key != "stages" && key != "stiffness" && key != "move")
      error->all(FLERR, "Unknown fix skin/motion keyword: {}", key);
    if (n + 1 == narg) error->all(FLERR, "Fix skin/motion keyword {} needs a value", key);
    if (key == "stages") {
      nstages = utils::inumeric(FLERR, arg[n + 1], false, lmp);
      const int least = (name == "euler") ? 1 : (name == "rkl1") ? 2 : 3;
      const int most = (name == "euler") ? 1 : MOST_STAGES;
      if (nstages < least || nstages > most)
        error->all(FLERR, "Fix skin/motion {} stages = {}: must be {} to {}", name, arg[n + 1],
                   least, most);
    } else {
      const double value = utils::numeric(FLERR, arg[n + 1], false, lmp);
      if (!(value > 0.0))
        error->all(FLERR, "Fix skin/motion {} = {}: must be a number > 0", key, arg[n + 1]);
      (key == "move" ? largest_move : stiffness_limit) = value;
    }
  }
  method = name == "rkl2" ? SkinStages::second_order(nstages) : SkinStages::first_order(nstages);
}

/* ---------------------------------------------------------------------- */

int FixSkinMotion::setmask()
{
  return INITIAL_INTEGRATE | FINAL_INTEGRATE;
}

/* ---------------------------------------------------------------------- */

void FixSkinMotion::init()
{
  if (force->angle || force->improper || force->kspace)
    error->all(FLERR, "Fix skin/motion computes pair, bond and dihedral forces alone: it works "
               "without angle, improper and kspace styles");
  if (!force->newton_bond) error->all(FLERR, "Fix skin/motion needs newton on for bonds");

  const bool limits = std::isfinite(stiffness_limit);
  if (limits && !dynamic_cast<BondSkinStretch *>(force->bond) &&
      !dynamic_cast<DihedralSkinBend *>(force->dihedral))
    error->all(FLERR, "Fix skin/motion stiffness = {}: needs bond style skin/stretch or dihedral "
               "style skin/bend, which know their stiffness", stiffness_limit);

  bend = dynamic_cast<DihedralSkinBend *>(force->dihedral);
  cells = nullptr;
  for (Fix *fix : modify->get_fix_by_style("^skin/cells$"))
    cells = dynamic_cast<FixSkinCells *>(fix);
}

/* ----------------------------------------------------------------------
   one step, in as many parts as the largest move needs
------------------------------------------------------------------------- */

void FixSkinMotion::initial_integrate(int /*vflag*/)
{
  const double dt = update->dt;
  double remaining = dt, part = dt;
  int nparts = 0;

  while (remaining > 0.0) {
    keep_start();
    find_mobility();
    part = method.stages.size() > 1 ? std::min(part, remaining) : euler_part(remaining);
    while (!advance(part, dt - remaining)) part *= 0.5;

    nparts++;
    remaining = (part < remaining) ? remaining - part : 0.0;
    if (remaining > 0.0) evaluate_forces(-remaining);
    part *= 2.0;    // a part after a short one may be longer again
  }

  if (cells) cells->within_step(0.0);
  steps++;
  parts += nparts;
  evaluations++;
  if (nparts > 1) divided++;
}

/* ----------------------------------------------------------------------
   where the membrane collapses a triangle may turn over and back; it may not stay like that
------------------------------------------------------------------------- */

void FixSkinMotion::final_integrate()
{
  const int t = bend ? bend->find_inverted() : -1;
  inverted_time = t < 0 ? 0.0 : inverted_time + update->dt;
  if (inverted_time > LONGEST_INVERTED) bend->inverted(t, inverted_time);
}

/* ----------------------------------------------------------------------
   with one stage the move is known beforehand: the longest part that is allowed
------------------------------------------------------------------------- */

double FixSkinMotion::euler_part(double longest)
{
  if (std::isinf(largest_move)) return longest;

  double fastest = 0.0;
  offender = -1;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    const double *f = atom->f[i];
    const double speed = mobility[i] * std::sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
    if (speed <= fastest) continue;
    fastest = std::isnan(speed) ? INFINITY : speed;
    offender = i;
  }

  const Move move = furthest(fastest);
  if (move.length * longest <= largest_move) return longest;
  const double part = largest_move / move.length;
  if (!(part > SHORTEST * update->dt)) unstable(move, part);
  return part;
}

/* ----------------------------------------------------------------------
   the stages of a part of a step; false, and all as before, if a particle moved too far
------------------------------------------------------------------------- */

bool FixSkinMotion::advance(double part, double since)
{
  const int nstages = (int) method.stages.size();

  for (int s = 0; s < nstages; s++) {
    const Move move = stage(method.stages[s], part);
    const bool too_far = nstages > 1 && move.length > largest_move;
    if (too_far || std::isinf(move.length)) {
      restore_start(since - update->dt);
      if (nstages == 1 || !(0.5 * part > SHORTEST * update->dt)) unstable(move, part);
      return false;
    }
    if (s + 1 < nstages)
      evaluate_forces(since + method.stages[s].time * part - update->dt);
  }
  return true;
}

/* ----------------------------------------------------------------------
   one stage: new positions; returns the longest way from the start of this part, infinite for
   what is no number
------------------------------------------------------------------------- */

FixSkinMotion::Move FixSkinMotion::stage(const SkinStage &c, double part)
{
  const int *const mask = atom->mask;
  double *const x = atom->nlocal ? atom->x[0] : nullptr;
  const double *const f = atom->nlocal ? atom->f[0] : nullptr;
  double longest = 0.0;
  offender = -1;

  for (int i = 0; i < atom->nlocal; i++) {
    if (!(mask[i] & groupbit)) continue;
    const double time = part * mobility[i];
    double distsq = 0.0;
    for (int n = 3 * i; n < 3 * i + 3; n++) {
      const double old = x[n];
      x[n] = c.previous * old + c.before * before[n] + c.start * start[n] +
          time * (c.force * f[n] + c.first * start_force[n]);
      before[n] = old;
      distsq += (x[n] - start[n]) * (x[n] - start[n]);
    }
    if (distsq <= longest) continue;
    longest = std::isnan(distsq) ? INFINITY : distsq;
    offender = i;
  }
  return furthest(std::sqrt(longest));
}

/* ----------------------------------------------------------------------
   longest of the moves of all ranks, and whose it is
------------------------------------------------------------------------- */

FixSkinMotion::Move FixSkinMotion::furthest(double mine)
{
  Move local = {mine, comm->me}, all = {};
  MPI_Allreduce(&local, &all, 1, MPI_DOUBLE_INT, MPI_MAXLOC, world);
  return all;
}

/* ---------------------------------------------------------------------- */

void FixSkinMotion::keep_start()
{
  const size_t n = 3 * (size_t) atom->nlocal;
  const double *const x = n ? atom->x[0] : nullptr, *const f = n ? atom->f[0] : nullptr;
  start.assign(x, x + n);
  start_force.assign(f, f + n);
  before.assign(x, x + n);
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

/* ----------------------------------------------------------------------
   mobility of my particles: lower where the membrane is stiffer than allowed
------------------------------------------------------------------------- */

void FixSkinMotion::find_mobility()
{
  const int nlocal = atom->nlocal;
  mobility.assign(nlocal, 1.0);
  if (std::isinf(stiffness_limit)) return;

  stiffness.assign(nlocal + atom->nghost, 0.0);
  if (auto *stretch = dynamic_cast<BondSkinStretch *>(force->bond))
    stretch->add_stiffness(stiffness.data());
  if (bend) bend->add_stiffness(stiffness.data());
  comm->reverse_comm(this);

  for (int i = 0; i < nlocal; i++) {
    if (!(stiffness[i] > stiffness_limit)) continue;
    mobility[i] = stiffness_limit / stiffness[i];
    slowest = std::min(slowest, mobility[i]);
    limited++;
  }
}

/* ---------------------------------------------------------------------- */

int FixSkinMotion::pack_reverse_comm(int n, int first, double *buf)
{
  std::copy_n(stiffness.begin() + first, n, buf);
  return n;
}

/* ---------------------------------------------------------------------- */

void FixSkinMotion::unpack_reverse_comm(int n, int *list, double *buf)
{
  for (int i = 0; i < n; i++) stiffness[list[i]] += buf[i];
}

/* ----------------------------------------------------------------------
   all forces at the current positions, in the order of a time step, at a time counted from the
   end of this step
------------------------------------------------------------------------- */

void FixSkinMotion::evaluate_forces(double offset)
{
  evaluations++;
  if (cells) cells->within_step(offset);
  comm->forward_comm();

  const int n = atom->nlocal + atom->nghost;
  if (n) std::fill(atom->f[0], atom->f[0] + 3 * (size_t) n, 0.0);

  if (modify->n_pre_force) modify->pre_force(0);
  if (force->pair) force->pair->compute(0, 0);
  if (force->bond) force->bond->compute(0, 0);
  if (force->dihedral) force->dihedral->compute(0, 0);
  if (modify->n_pre_reverse) modify->pre_reverse(0, 0);
  comm->reverse_comm();
  if (modify->n_post_force_any) modify->post_force(0);
}

/* ---------------------------------------------------------------------- */

void FixSkinMotion::unstable(const Move &move, double part)
{
  double what[3] = {0.0, 0.0, 0.0};
  if (move.rank == comm->me && offender >= 0) {
    const double *f = atom->f[offender];
    what[0] = (double) atom->tag[offender];
    what[1] = atom->type[offender];
    what[2] = std::sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
  }
  MPI_Bcast(what, 3, MPI_DOUBLE, move.rank, world);
  const std::string term = largest_term(move.rank, offender);
  error->all(FLERR,
             "Fix skin/motion: the run is unstable on step {}: the force on atom {} of type {} is "
             "{}, most of it from {}, which would need a timestep of {}; try a smaller timestep "
             "than {}",
             update->ntimestep, (tagint) what[0], (int) what[1], what[2], term, part, update->dt);
}

/* ----------------------------------------------------------------------
   which kind of forces is the largest on the particle i of a rank
------------------------------------------------------------------------- */

std::string FixSkinMotion::largest_term(int rank, int i)
{
  static const char *const NAMES[] = {"pair forces", "stretch", "bend", "cells"};
  const size_t n = 3 * (size_t) (atom->nlocal + atom->nghost);
  double largest = -1.0;
  int which = 0;

  for (int term = 0; term < 4; term++) {
    if (n) std::fill(atom->f[0], atom->f[0] + n, 0.0);
    if (term == 0 && force->pair) force->pair->compute(0, 0);
    if (term == 1 && force->bond) force->bond->compute(0, 0);
    if (term == 2 && force->dihedral) force->dihedral->compute(0, 0);
    if (term == 3 && cells) cells->pre_reverse(0, 0);
    comm->reverse_comm();
    if (rank != comm->me || i < 0) continue;
    const double *f = atom->f[i];
    const double size = f[0] * f[0] + f[1] * f[1] + f[2] * f[2];
    if (!(size <= largest)) {
      largest = std::isnan(size) ? INFINITY : size;
      which = term;
    }
  }
  MPI_Bcast(&which, 1, MPI_INT, rank, world);
  return NAMES[which];
}

/* ----------------------------------------------------------------------
   numbers of divided steps, of parts of steps and of force evaluations; fraction of the
   particles whose mobility was limited, in the mean over parts; the lowest mobility of any;
   steps
------------------------------------------------------------------------- */

double FixSkinMotion::compute_vector(int n)
{
  if (n == 0) return (double) divided;
  if (n == 1) return (double) parts;
  if (n == 2) return (double) evaluations;
  if (n == 3) {
    bigint all = 0;
    MPI_Allreduce(&limited, &all, 1, MPI_LMP_BIGINT, MPI_SUM, world);
    return parts ? (double) all / ((double) parts * (double) atom->natoms) : 0.0;
  }
  if (n == 4) {
    double all = 1.0;
    MPI_Allreduce(&slowest, &all, 1, MPI_DOUBLE, MPI_MIN, world);
    return all;
  }
  return (double) steps;
}

/* ---------------------------------------------------------------------- */

double FixSkinMotion::memory_usage()
{
  return (double) (start.capacity() + start_force.capacity() + before.capacity() +
                   stiffness.capacity() + mobility.capacity()) * sizeof(double);
}
