// forces, mobilities and the reach of neighbor lists in fix skin/motion

#include "fix_skin_motion.h"

#include "bond_skin_stretch.h"
#include "dihedral_skin_bend.h"
#include "fix_skin_cells.h"
#include "skin_margins.h"

#include "atom.h"
#include "bond.h"
#include "comm.h"
#include "dihedral.h"
#include "force.h"
#include "modify.h"
#include "neighbor.h"
#include "pair.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

static double distance_squared(const double *x, const double *y)
{
  const double dx = x[0] - y[0], dy = x[1] - y[1], dz = x[2] - y[2];
  return dx * dx + dy * dy + dz * dz;
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
  if (stretch) stretch->add_stiffness(stiffness.data());
  if (bend) bend->add_stiffness(stiffness.data());
  comm->reverse_comm(this);

  for (int i = 0; i < nlocal; i++) {
    if (!(stiffness[i] > stiffness_limit)) continue;
    mobility[i] = stiffness_limit / stiffness[i];
  }
}

/* ---------------------------------------------------------------------- */

void FixSkinMotion::count_limited()
{
  if (std::isinf(stiffness_limit)) return;
  for (const double m : mobility) {
    if (m >= 1.0) continue;
    slowest = std::min(slowest, m);
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
  within_steps++;
  count_beyond();
  if (cells) cells->within_step(offset);
  comm->forward_comm();

  const int n = atom->nlocal + atom->nghost;
  if (n) std::fill(atom->f[0], atom->f[0] + 3 * (size_t) n, 0.0);

  if (modify->n_pre_force) modify->pre_force(0);
  if (force->pair && force->pair->compute_flag) force->pair->compute(0, 0);
  if (force->bond) force->bond->compute(0, 0);
  if (force->dihedral) force->dihedral->compute(0, 0);
  if (modify->n_pre_reverse) modify->pre_reverse(0, 0);
  comm->reverse_comm();
  if (modify->n_post_force_any) modify->post_force(0);
}

/* ----------------------------------------------------------------------
   neighbor lists hold for particles within a margin from where they were at the build
------------------------------------------------------------------------- */

void FixSkinMotion::note_lists()
{
  if (!build.is_new(neighbor)) return;
  const size_t n = 3 * (size_t) atom->nlocal;
  const double *const x = n ? atom->x[0] : nullptr;
  listed.assign(x, x + n);
  marginsq = skin_margins(lmp);
  for (double &margin : marginsq) margin *= margin;
}

/* ----------------------------------------------------------------------
   LAMMPS itself has the lists built anew where a particle has moved by half of the skin
------------------------------------------------------------------------- */

void FixSkinMotion::post_integrate()
{
  if (margins.empty()) return;
  const double *const x = atom->nlocal ? atom->x[0] : nullptr, *const y = listed.data();
  int mine = 0, any = 0;
  for (size_t n = 0; n < listed.size() && !mine; n += 3)
    mine = distance_squared(x + n, y + n) > marginsq[atom->type[n / 3]];
  MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
  if (any) next_reneighbor = update->ntimestep;
}

/* ---------------------------------------------------------------------- */

void FixSkinMotion::count_beyond()
{
  if (listed.empty()) return;
  const double *const x = atom->x[0], *const y = listed.data();
  for (size_t n = 0; n < listed.size(); n += 3) {
    const double distsq = distance_squared(x + n, y + n), most = marginsq[atom->type[n / 3]];
    if (!(distsq > most)) continue;
    furthest_listed = std::max(furthest_listed, distsq / most);
    beyond++;
  }
}
