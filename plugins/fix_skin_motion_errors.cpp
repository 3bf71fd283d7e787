// errors of fix skin/motion: a run that is unstable, and whose fault it is

#include "fix_skin_motion.h"

#include "bond_skin_stretch.h"
#include "fix_skin_cells.h"

#include "atom.h"
#include "bond.h"
#include "comm.h"
#include "dihedral.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "modify.h"
#include "neighbor.h"
#include "pair.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace FixConst;

/* ---------------------------------------------------------------------- */

void FixSkinMotion::setup_pre_force(int /*vflag*/)
{
  check_links();
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
                 "be between {} and {}; try a smaller timestep than {}",
                 atom->tag[i], atom->tag[j], r, update->ntimestep, shortest_link, longest_link,
                 update->dt);
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

bool FixSkinMotion::ends_badly()
{
  comm->forward_comm();
  int mine = (cells && cells->any_astray()) || (stretch && stretch->any_broken()), any;
  MPI_Allreduce(&mine, &any, 1, MPI_INT, MPI_MAX, world);
  return any;
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
   which forces are the largest on the particle i of a rank: those of pair, bond and dihedral
   styles, of cells, or of another fix
------------------------------------------------------------------------- */

std::string FixSkinMotion::largest_term(int rank, int i)
{
  std::vector<std::string> names;
  std::vector<double> sizes;
  const auto measure = [&](const std::string &name, auto &&compute) {
    const size_t n = 3 * (size_t) (atom->nlocal + atom->nghost);
    if (n) std::fill(atom->f[0], atom->f[0] + n, 0.0);
    compute();
    comm->reverse_comm();
    const double *f = (rank == comm->me && i >= 0) ? atom->f[i] : nullptr;
    const double size = f ? f[0] * f[0] + f[1] * f[1] + f[2] * f[2] : 0.0;
    names.push_back(name);
    sizes.push_back(std::isnan(size) ? INFINITY : size);
  };

  comm->forward_comm();
  if (force->pair) measure("pair forces", [&] { force->pair->compute(0, 0); });
  if (force->bond) measure("stretch", [&] { force->bond->compute(0, 0); });
  if (force->dihedral) measure("bend", [&] { force->dihedral->compute(0, 0); });
  if (cells) {
    measure("adhesion or binding", [&] { cells->add_forces(FixSkinCells::ATTACHMENT, 0); });
    measure("division springs", [&] { cells->add_forces(FixSkinCells::SPRINGS, 0); });
  }
  for (Fix *fix : modify->get_fix_list())
    if (modify->get_fix_mask(fix) & POST_FORCE)
      measure(fmt::format("fix {} of style {}", fix->id, fix->style), [&] { fix->post_force(0); });

  int which = (int) (std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
  MPI_Bcast(&which, 1, MPI_INT, rank, world);
  if (names.empty()) return "nothing";
  return names[which] + (force->pair && which == 0 ? strongest_pair(rank, i) : "");
}

/* ----------------------------------------------------------------------
   with whom the particle i of a rank has the largest pair force
------------------------------------------------------------------------- */

std::string FixSkinMotion::strongest_pair(int rank, int i)
{
  double other[3] = {0.0, 0.0, 0.0}, largest = 0.0;
  const bool here = rank == comm->me && i >= 0 && force->pair->single_enable;

  for (int j = 0; here && j < atom->nlocal + atom->nghost; j++) {
    const double *const x = atom->x[i], *const y = atom->x[j];
    const double rsq = (x[0] - y[0]) * (x[0] - y[0]) + (x[1] - y[1]) * (x[1] - y[1]) +
        (x[2] - y[2]) * (x[2] - y[2]);
    const int itype = atom->type[i], jtype = atom->type[j];
    const int n = atom->nspecial ? atom->nspecial[i][0] : 0;
    const tagint *const special = n ? atom->special[i] : nullptr;
    if (j == i || !(rsq < force->pair->cutsq[itype][jtype])) continue;
    if (n && std::find(special, special + n, atom->tag[j]) != special + n) continue;
    double slope = 0.0;
    force->pair->single(i, j, itype, jtype, rsq, 1.0, 1.0, slope);
    if (!(std::fabs(slope) * std::sqrt(rsq) > largest)) continue;
    largest = std::fabs(slope) * std::sqrt(rsq);
    other[0] = (double) atom->tag[j];
    other[1] = jtype;
    other[2] = std::sqrt(rsq);
  }
  MPI_Bcast(other, 3, MPI_DOUBLE, rank, world);
  if (other[0] == 0.0) return "";
  return fmt::format(" with atom {} of type {} at a distance of {}", (tagint) other[0],
                     (int) other[1], other[2]);
}
