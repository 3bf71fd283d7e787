// Overdamped motion dr/dt = m F by forward Euler or a Runge-Kutta-Legendre method; the mobility m
// is 1, or less where the membrane is too stiff for the timestep. A step in which some particle
// would move too far is divided into shorter ones. Its arguments stand in
// fix_skin_motion_settings.cpp, stages in _stages.cpp, forces and mobilities in _forces.cpp, single
// terms of the forces in _terms.cpp, and what ends a run in _errors.cpp.

#include "fix_skin_motion.h"

#include "bond_skin_stretch.h"
#include "dihedral_skin_bend.h"
#include "fix_skin_cells.h"
#include "pair_skin_base.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <string>

using namespace LAMMPS_NS;
using namespace FixConst;

// a step is never divided into shorter ones than this part of it: what moves faster is unstable

static constexpr double SHORTEST = 1.0e-6;

// nor into more parts than this: it is stable, but no step would ever end

static constexpr int MOST_PARTS = 10000;

// time for which there may be inverted triangles

static constexpr double LONGEST_INVERTED = 2.0;

/* ---------------------------------------------------------------------- */

FixSkinMotion::FixSkinMotion(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), largest_move(INFINITY), stiffness_limit(INFINITY), shortest_link(0.0),
    longest_link(INFINITY), rounding(0.0), round_every(1), cells(nullptr), stretch(nullptr),
    bend(nullptr), left(false), left_as(0), disturbed(false), steps(0), divided(0), parts(0),
    evaluations(0), limited(0), slowest(1.0), beyond(0), beyond_before(0), within_steps(0),
    furthest_listed(0.0), furthest_particle(-1), inverted_time(0.0), inverted_at_start(false)
{
  parse(narg, arg);

  time_integrate = 1;
  vector_flag = 1;
  size_vector = 7;
  extvector = 0;
  global_freq = 1;
  comm_reverse = 1;
  force_reneighbor = 1;
  next_reneighbor = -1;
}

/* ---------------------------------------------------------------------- */

int FixSkinMotion::setmask()
{
  return INITIAL_INTEGRATE | POST_INTEGRATE | PRE_FORCE | FINAL_INTEGRATE;
}

/* ---------------------------------------------------------------------- */

void FixSkinMotion::init()
{
  if (force->angle || force->improper || force->kspace)
    error->all(FLERR, "Fix skin/motion computes pair, bond and dihedral forces alone: it works "
               "without angle, improper and kspace styles");
  if (!force->newton_bond) error->all(FLERR, "Fix skin/motion needs newton on for bonds");
  if (!(update->dt > 0.0))
    error->all(FLERR, "Fix skin/motion needs a timestep greater than 0, but got {}", update->dt);
  if (utils::strmatch(update->integrate_style, "^respa"))
    error->all(FLERR, "Fix skin/motion does not work with run_style respa: use run_style verlet");
  for (const Fix *other : modify->get_fix_by_style("^skin/motion$"))
    if (other != this && (alone() || ((const FixSkinMotion *) other)->alone()))
      error->all(FLERR,
                 "Fix skin/motion {} cannot be used beside fix skin/motion {}: with rkl1, rkl2, "
                 "move or stiffness it must be the only one, for a group of all that move",
                 id, other->id);

  const bool limits = std::isfinite(stiffness_limit);
  stretch = dynamic_cast<BondSkinStretch *>(force->bond_match("skin/stretch"));
  bend = dynamic_cast<DihedralSkinBend *>(force->dihedral_match("skin/bend"));
  if (limits && !stretch && !bend)
    error->all(FLERR, "Fix skin/motion stiffness = {}: needs bond style skin/stretch or dihedral "
               "style skin/bend, which know their stiffness", stiffness_limit);

  find_pairs();
  cells = nullptr;
  for (Fix *fix : modify->get_fix_by_style("^skin/cells$"))
    cells = dynamic_cast<FixSkinCells *>(fix);

  build.forget();
  beyond_before = beyond;
  within_steps = 0;
  furthest_listed = 0.0;
  unproven.clear();
  if (!several()) return;
  if (force->pair && force->pair->compute_flag) unproven.push_back(pair_term());
  for (Fix *fix : modify->get_fix_list())
    if (modify->get_fix_mask(fix) & POST_FORCE) unproven.push_back(fix_term(fix));
}

/* ----------------------------------------------------------------------
   whether a step needs forces of all particles at places that this fix alone knows
------------------------------------------------------------------------- */

bool FixSkinMotion::alone() const
{
  return several() || std::isfinite(stiffness_limit);
}

/* ----------------------------------------------------------------------
   pair styles of the skin, on their own or in a hybrid style; the only one of its name is found
   whatever its number
------------------------------------------------------------------------- */

void FixSkinMotion::find_pairs()
{
  pairs.clear();
  for (const char *const name : {"skin/lj", "skin/dermis", "skin/adhesion"})
    for (int n = 1;; n++) {
      auto *const pair = dynamic_cast<PairSkinBase *>(force->pair_match(name, 1, n));
      if (!pair || (n > 1 && pair == pairs.back())) break;
      pairs.push_back(pair);
    }
}

/* ----------------------------------------------------------------------
   one step, in as many parts as the largest move needs
------------------------------------------------------------------------- */

void FixSkinMotion::initial_integrate(int /*vflag*/)
{
  const double dt = update->dt;
  double remaining = dt, part = dt;
  int nparts = 0;

  if (update->ntimestep == update->firststep + 1) disturbed = left && left_as != state_of_atoms();
  note_lists();
  if (!unproven.empty()) check_repeatable();
  while (remaining > 0.0) {
    keep_start();
    find_mobility();
    count_limited();
    if (method.order > 1) start_mobility = mobility;
    part = method.stages.size() > 1 ? std::min(part, remaining) : euler_part(remaining);
    while (!advance(part, dt - remaining)) part *= 0.5;

    nparts++;
    remaining = (part < remaining) ? remaining - part : 0.0;
    if (nparts == MOST_PARTS && remaining > 0.0)
      unstable(latest, (dt - remaining) / nparts, false);
    if (remaining > 0.0) evaluate_forces(-remaining);
    part *= 2.0;    // a part after a short one may be longer again
  }

  if (cells) cells->within_step(0.0);
  check_box();
  if (rounding > 0.0 && update->ntimestep % round_every == 0) round_positions();
  steps++;
  parts += nparts;
  evaluations++;
  if (nparts > 1) divided++;
}

/* ----------------------------------------------------------------------
   positions on a grid that divides the box, the same for all images of a particle: what the order
   of sums did to their last digits is gone. What feels no force, such as what is held, stays.
------------------------------------------------------------------------- */

void FixSkinMotion::round_positions()
{
  double points[3], grid[3];
  for (int d = 0; d < 3; d++) {
    points[d] = std::ceil(domain->prd[d] / rounding);
    grid[d] = domain->prd[d] / points[d];
  }

  for (int i = 0; i < atom->nlocal; i++) {
    const double *const f = atom->f[i];
    const bool moves = f[0] != 0.0 || f[1] != 0.0 || f[2] != 0.0;
    if (!(atom->mask[i] & groupbit) || !moves) continue;
    double *const x = atom->x[i];
    if (domain->triclinic) {
      double fraction[3];
      domain->x2lamda(x, fraction);
      for (int d = 0; d < 3; d++) fraction[d] = std::nearbyint(fraction[d] * points[d]) / points[d];
      domain->lamda2x(fraction, x);
    } else {
      for (int d = 0; d < 3; d++) {
        const double lo = domain->boxlo[d];
        x[d] = lo + grid[d] * std::nearbyint((x[d] - lo) / grid[d]);
      }
    }
  }
}

/* ----------------------------------------------------------------------
   overlaps end the run; where the membrane collapses a triangle may turn over and back, but may not
   stay like that
------------------------------------------------------------------------- */

void FixSkinMotion::final_integrate()
{
  if (cells && !pairs.empty()) cells->take_away_left();
  for (const PairSkinBase *pair : pairs) pair->check_overlap();
  if (cells && !pairs.empty()) cells->put_back_left();
  if (!bend) return;
  const bool found = bend->find_inverted();
  inverted_time = found ? inverted_time + update->dt : 0.0;
  inverted_at_start = inverted_at_start && found;
  if (inverted_time > LONGEST_INVERTED) bend->inverted(inverted_time, inverted_at_start);
}

/* ----------------------------------------------------------------------
   with one stage the move is known beforehand: the longest part that is allowed
------------------------------------------------------------------------- */

double FixSkinMotion::euler_part(double longest)
{
  if (std::isinf(largest_move)) return longest;

  double fastest = 0.0;
  furthest_particle = -1;
  for (int i = 0; i < atom->nlocal; i++) {
    if (!(atom->mask[i] & groupbit)) continue;
    const double *f = atom->f[i];
    const double speed = mobility[i] * std::sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
    if (speed <= fastest) continue;
    fastest = std::isnan(speed) ? INFINITY : speed;
    furthest_particle = i;
  }

  const Move move = furthest(fastest);
  if (move.length * longest <= largest_move) return longest;
  const double part = largest_move / move.length;
  if (!(part > SHORTEST * update->dt)) unstable(move, part, unmoved(update->dt - longest));
  return part;
}

/* ----------------------------------------------------------------------
   whether at this time in the step particles are still where the run began
------------------------------------------------------------------------- */

bool FixSkinMotion::unmoved(double since) const
{
  return update->ntimestep == update->firststep + 1 && since == 0.0;
}

/* ----------------------------------------------------------------------
   the stages of a part of a step; false, and all as before, if a shorter part may do better: a
   particle moved too far, a link broke, or a cell would end within the membrane or lose it
------------------------------------------------------------------------- */

bool FixSkinMotion::advance(double part, double since)
{
  const int nstages = (int) method.stages.size();
  const bool may_divide = nstages > 1 && std::isfinite(largest_move);
  const bool divisible = may_divide && 0.5 * part > SHORTEST * update->dt;
  if (method.order > 1) mobility = start_mobility;

  for (int s = 0; s < nstages; s++) {
    const Move move = stage(method.stages[s], part);
    if ((may_divide && move.length > largest_move) || std::isinf(move.length)) {
      restore_start(since - update->dt);
      if (!divisible) unstable(move, part, unmoved(since) && (may_divide || s == 0));
      return false;
    }
    if (s + 1 < nstages) {
      if (stretch) stretch->spare_links(divisible);
      evaluate_forces(since + method.stages[s].time * part - update->dt);
      if (method.order > 1) find_mobility();
    } else if (may_divide && ends_in_error()) {
      if (!divisible) evaluate_forces(0.0);    // ends the run with the error of that cell or link
      restore_start(since - update->dt);
      return false;
    }
  }
  return true;
}

/* ----------------------------------------------------------------------
   numbers of divided steps, of parts of steps and of force evaluations; fraction of the
   particles whose mobility was limited, in the mean over parts; the lowest mobility of any;
   steps; particles that the neighbor lists did not reach, summed over stages
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
  if (n == 5) return (double) steps;
  bigint all = 0;
  MPI_Allreduce(&beyond, &all, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  return (double) all;
}

/* ---------------------------------------------------------------------- */

double FixSkinMotion::memory_usage()
{
  return (double) (start.capacity() + start_force.capacity() + before.capacity() +
                   stiffness.capacity() + mobility.capacity() + start_mobility.capacity() +
                   listed.capacity()) * sizeof(double);
}
