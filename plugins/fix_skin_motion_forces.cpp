// forces, mobilities and the error of a run that is unstable in fix skin/motion

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

using namespace LAMMPS_NS;

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
