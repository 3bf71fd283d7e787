// single terms of the forces in fix skin/motion: which is the largest, and whether they are the
// same when they are computed again

#include "fix_skin_motion.h"

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
using namespace FixConst;

// forces that are computed twice may differ by rounding, as part of the largest

static constexpr double ROUNDING = 1.0e-9;

/* ---------------------------------------------------------------------- */

FixSkinMotion::Term FixSkinMotion::pair_term() const
{
  return {"pair forces", [this] { force->pair->compute(0, 0); }};
}

/* ---------------------------------------------------------------------- */

FixSkinMotion::Term FixSkinMotion::fix_term(Fix *fix) const
{
  return {fmt::format("fix {} of style {}", fix->id, fix->style), [fix] { fix->post_force(0); },
          std::max(1, fix->nevery)};
}

/* ----------------------------------------------------------------------
   what a term alone does to my particles; atom->f is not what it was
------------------------------------------------------------------------- */

std::vector<double> FixSkinMotion::forces_of(const Term &term) const
{
  const size_t n = 3 * (size_t) (atom->nlocal + atom->nghost);
  if (n) std::fill(atom->f[0], atom->f[0] + n, 0.0);
  term.compute();
  comm->reverse_comm();
  if (!n) return {};
  const double *const f = atom->f[0];
  return std::vector<double>(f, f + 3 * (size_t) atom->nlocal);
}

/* ----------------------------------------------------------------------
   in the first step of a run; what works on some steps alone is asked on the first of these
------------------------------------------------------------------------- */

void FixSkinMotion::check_repeatable()
{
  keep_start();
  const auto due = [&](const Term &term) { return update->ntimestep % term.every == 0; };
  for (const Term &term : unproven)
    if (due(term)) check_repeatable(term);
  unproven.erase(std::remove_if(unproven.begin(), unproven.end(), due), unproven.end());
  if (atom->nlocal) std::copy(start_force.begin(), start_force.end(), atom->f[0]);
}

/* ----------------------------------------------------------------------
   forces are computed several times in a step: those that are drawn at random, or that count how
   often they were computed, would be wrong
------------------------------------------------------------------------- */

void FixSkinMotion::check_repeatable(const Term &term) const
{
  const std::vector<double> once = forces_of(term), again = forces_of(term);
  double mine[2] = {0.0, 0.0}, all[2];
  for (size_t n = 0; n < once.size(); n++) {
    mine[0] = std::max(mine[0], std::fabs(again[n] - once[n]));
    mine[1] = std::max(mine[1], std::fabs(once[n]));
  }
  MPI_Allreduce(mine, all, 2, MPI_DOUBLE, MPI_MAX, world);
  if (all[0] > ROUNDING * all[1])
    error->all(FLERR,
               "Fix skin/motion computes forces several times in a step with rkl1, rkl2 or move, "
               "but those of {} differ when they are computed again, as random forces do: use "
               "euler without move", term.name);
}

/* ----------------------------------------------------------------------
   which forces are the largest on the particle i of a rank: those of pair, bond and dihedral
   styles, of cells, or of another fix
------------------------------------------------------------------------- */

std::string FixSkinMotion::largest_term(int rank, int i)
{
  std::vector<Term> terms;
  if (force->pair) terms.push_back(pair_term());
  if (force->bond) terms.push_back({"stretch", [&] { force->bond->compute(0, 0); }});
  if (force->dihedral) terms.push_back({"bend", [&] { force->dihedral->compute(0, 0); }});
  if (cells) {
    cells->find_nearest();
    const auto attach = [&] { cells->add_forces(FixSkinCells::ATTACHMENT, 0); };
    const auto pull = [&] { cells->add_forces(FixSkinCells::SPRINGS, 0); };
    terms.push_back({"adhesion or binding", attach});
    terms.push_back({"division springs", pull});
  }
  for (Fix *fix : modify->get_fix_list())
    if (modify->get_fix_mask(fix) & POST_FORCE) terms.push_back(fix_term(fix));
  if (terms.empty()) return "nothing";

  comm->forward_comm();
  std::vector<double> sizes;
  for (const Term &term : terms) {
    const std::vector<double> forces = forces_of(term);
    const double *const f = (rank == comm->me && i >= 0) ? &forces[3 * (size_t) i] : nullptr;
    const double size = f ? f[0] * f[0] + f[1] * f[1] + f[2] * f[2] : 0.0;
    sizes.push_back(std::isnan(size) ? INFINITY : size);
  }

  int which = (int) (std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
  MPI_Bcast(&which, 1, MPI_INT, rank, world);
  return terms[which].name + (force->pair && which == 0 ? strongest_pair(rank, i) : "");
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
