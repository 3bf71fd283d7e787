// Bending of a triangulated membrane: each dihedral (i1,i2,i3,i4) is a link i2-i3 with the
// triangles (i1,i2,i3) and (i4,i3,i2) on its two sides, E = K/2 (1 - N1.N2)^2, or a form of it
// that diverges as the fold closes.

#include "dihedral_skin_bend.h"

#include "skin_remedy.h"
#include "skin_virial.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "force.h"
#include "memory.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

// cosine of the angle by which an inverted triangle is folded against all that are around it

static constexpr double INVERTED = -0.5;

// forms of the energy

static const char COSINE[] = "cosine", DIVERGING[] = "diverging";

static constexpr double DEGREES = 180.0 / 3.14159265358979323846;

/* ---------------------------------------------------------------------- */

DihedralSkinBend::DihedralSkinBend(LAMMPS *lmp) :
    Dihedral(lmp), stiffness(nullptr), limit(nullptr), triangles(lmp), ninverted(0.0),
    inverted_triangles(lmp, INVERTED)
{
  writedata = 1;
  centroidstressflag = CENTROID_NOTAVAIL;
}

/* ---------------------------------------------------------------------- */

DihedralSkinBend::~DihedralSkinBend()
{
  if (allocated) {
    memory->destroy(setflag);
    memory->destroy(stiffness);
    memory->destroy(limit);
  }
}

/* ---------------------------------------------------------------------- */

void DihedralSkinBend::compute(int eflag, int vflag)
{
  ev_init(eflag, vflag);

  if (build.is_new(neighbor)) {
    triangles.build();
    normal.resize(4 * triangles.all.size());
  }
  ninverted = 0.0;
  const int n = (int) triangles.all.size();
  if (n == 0) return;

  const bool each = eflag_atom || vflag_atom;
  if (vflag_global && !each) skin_add_virial(atom, -1.0, virial);
  const SkinFolds folds =
      skin_bend(triangles, atom->x[0], law(), INVERTED, normal.data(), atom->f[0]);
  if (folds.without_normal > 0.0)
    for (int t = 0; t < n; t++)
      if (!(normal[4 * t + 3] < 1.0 / SKIN_SMALLEST_NORMAL)) degenerate(t);
  ninverted = folds.inverted;
  if (each && eflag_either) tally_energy();
  if (each && vflag_either) tally_virial();
  if (vflag_global && !each) skin_add_virial(atom, 1.0, virial);
  if (eflag_global && !each) energy += skin_bend_energy(triangles, law(), normal.data());
}

/* ---------------------------------------------------------------------- */

SkinFoldLaw DihedralSkinBend::law() const
{
  const int n = atom->ndihedraltypes;
  const double *const first = limit + 1;
  const bool limited =
      std::any_of(first, first + n, [](double c) { return c != SkinFoldLaw::NO_LIMIT; });
  return {stiffness, limit, n, limited};
}

/* ---------------------------------------------------------------------- */

double DihedralSkinBend::cosine(int t, int k) const
{
  return skin_cosine(triangles, t, k, normal.data());
}

/* ----------------------------------------------------------------------
   a bound for the stiffness of the corners of the triangles of the last compute(): the second
   derivative by the angle over the squares of the triangle's heights
------------------------------------------------------------------------- */

void DihedralSkinBend::add_stiffness(double *sum) const
{
  const SkinFoldLaw folds = law();
  for (int t = 0; t < (int) triangles.all.size(); t++) {
    const SkinTriangle &mine = triangles.all[t];
    double fold = 0.0;
    for (int k = 0; k < 3; k++)
      if (mine.bends(k, t)) fold += folds.curvature(mine.type[k], cosine(t, k));

    double edges = 0.0;
    for (int k = 0; k < 3; k++) {
      const double *p = atom->x[mine.corner[k]], *q = atom->x[mine.corner[(k + 1) % 3]];
      for (int d = 0; d < 3; d++) edges += (q[d] - p[d]) * (q[d] - p[d]);
    }
    const double bound = fold * edges * normal[4 * t + 3] * normal[4 * t + 3];
    for (const int i : mine.corner) sum[i] += bound;
  }
}

/* ----------------------------------------------------------------------
   whether there is an inverted triangle at the positions of the last compute(), on any rank
------------------------------------------------------------------------- */

bool DihedralSkinBend::find_inverted()
{
  return inverted_triangles.find(triangles, normal.data(), ninverted > 0.0);
}

/* ----------------------------------------------------------------------
   each link is seen from both of its triangles, half of its energy from each; of the whole,
   each of the four atoms of the dihedral has a quarter
------------------------------------------------------------------------- */

void DihedralSkinBend::tally_energy()
{
  const SkinFoldLaw folds = law();
  for (int t = 0; t < (int) triangles.all.size(); t++) {
    const SkinTriangle &mine = triangles.all[t];
    for (int k = 0; k < 3; k++) {
      const double link = mine.bends(k, t) ? folds.energy(mine.type[k], cosine(t, k)) : 0.0;
      if (eflag_global) energy += 0.5 * link;
      if (eflag_atom)
        for (int c = 0; c < 3; c++) eatom[mine.corner[c]] += (c == k ? 0.25 : 0.125) * link;
    }
  }
}

/* ----------------------------------------------------------------------
   virial of the triangles, from their edges at corner 0 and the forces at the ends of these
------------------------------------------------------------------------- */

void DihedralSkinBend::tally_virial()
{
  for (int t = 0; t < (int) triangles.all.size(); t++) {
    const int *corner = triangles.all[t].corner;
    const SkinPoint<double> o = load<double>(atom->x[0], &corner[0], 1);
    const SkinPoint<double> p = load<double>(atom->x[0], &corner[1], 1) - o;
    const SkinPoint<double> q = load<double>(atom->x[0], &corner[2], 1) - o;
    const SkinCornerForces push =
        skin_corner_forces(triangles, t, atom->x[0], law(), normal.data());
    const SkinPoint<double> &a = push.one, &b = push.two;
    const double w[6] = {p.x * a.x + q.x * b.x, p.y * a.y + q.y * b.y, p.z * a.z + q.z * b.z,
                         p.x * a.y + q.x * b.y, p.x * a.z + q.x * b.z, p.y * a.z + q.y * b.z};
    for (int k = 0; k < 6; k++) {
      if (vflag_global) virial[k] += w[k];
      if (vflag_atom)
        for (int c = 0; c < 3; c++) vatom[corner[c]][k] += w[k] / 3.0;
    }
  }
}

/* ---------------------------------------------------------------------- */

void DihedralSkinBend::inverted(double duration, bool at_start) const
{
  const tagint *const corner = inverted_triangles.corner.data();
  error->all(FLERR,
             "Dihedral skin/bend: the triangle of atoms {} {} {} is inverted on step {}: its "
             "folds against those around it are {} degrees and more, above {}, and there have "
             "been inverted ones for {} time units{}",
             corner[0], corner[1], corner[2], update->ntimestep,
             std::acos(inverted_triangles.cosine) * DEGREES, std::acos(INVERTED) * DEGREES,
             duration,
             skin_remedy(update, modify, at_start));
}

/* ---------------------------------------------------------------------- */

void DihedralSkinBend::degenerate(int t)
{
  const int *corner = triangles.all[t].corner;
  const tagint *tag = atom->tag;
  error->one(FLERR,
             "Dihedral skin/bend: the triangle of atoms {} {} {} has no normal on step {}: its "
             "area is below {}{}",
             tag[corner[0]], tag[corner[1]], tag[corner[2]], update->ntimestep,
             0.5 * SKIN_SMALLEST_NORMAL, skin_remedy(update, modify, false));
}

/* ---------------------------------------------------------------------- */

void DihedralSkinBend::allocate()
{
  allocated = 1;
  const int np1 = atom->ndihedraltypes + 1;

  memory->create(stiffness, np1, "dihedral:stiffness");
  memory->create(limit, np1, "dihedral:limit");
  memory->create(setflag, np1, "dihedral:setflag");
  for (int i = 0; i < np1; i++) {
    setflag[i] = 0;
    stiffness[i] = 0.0;
    limit[i] = SkinFoldLaw::NO_LIMIT;
  }
}

/* ----------------------------------------------------------------------
   set coeffs for one or more types
------------------------------------------------------------------------- */

void DihedralSkinBend::coeff(int narg, char **arg)
{
  if (narg != 2 && narg != 3)
    error->all(FLERR, "Dihedral style skin/bend needs K and may have a form, but got {} "
               "coefficients", narg - 1);
  if (!allocated) allocate();

  int ilo, ihi;
  utils::bounds_typelabel(FLERR, arg[0], 1, atom->ndihedraltypes, ilo, ihi, lmp, Atom::DIHEDRAL);

  const double k = utils::numeric(FLERR, arg[1], false, lmp);
  check(k, arg[1]);
  const std::string form = narg == 3 ? arg[2] : COSINE;
  if (form != COSINE && form != DIVERGING)
    error->all(FLERR, "Dihedral style skin/bend: form = {} must be {} or {}", form, COSINE,
               DIVERGING);

  for (int i = ilo; i <= ihi; i++) {
    stiffness[i] = k;
    limit[i] = form == DIVERGING ? 0.0 : SkinFoldLaw::NO_LIMIT;
    setflag[i] = 1;
  }
}

/* ---------------------------------------------------------------------- */

void DihedralSkinBend::check(double k, const std::string &text) const
{
  if (!(k >= 0.0) || std::isinf(k))
    error->all(FLERR, "Dihedral style skin/bend: K = {} must be a number >= 0", text);
}

/* ----------------------------------------------------------------------
   also after a command has changed coefficients; in a hybrid style, which does not call it at the
   begin of a run, other types have none here
------------------------------------------------------------------------- */

void DihedralSkinBend::init()
{
  if (force->dihedral == this) Dihedral::init();
  else init_style();
}

/* ---------------------------------------------------------------------- */

void DihedralSkinBend::init_style()
{
  if (!force->newton_bond) error->all(FLERR, "Dihedral style skin/bend needs newton on for bonds");
  for (int i = 1; allocated && i <= atom->ndihedraltypes; i++)
    if (setflag[i]) check(stiffness[i], fmt::format("{}", stiffness[i]));
  build.forget();
}

/* ----------------------------------------------------------------------
   K of each type, with a minus sign for the diverging form
------------------------------------------------------------------------- */

void DihedralSkinBend::write_restart(FILE *fp)
{
  for (int i = 1; i <= atom->ndihedraltypes; i++) {
    const double k = std::copysign(stiffness[i], diverges(i) ? -1.0 : 1.0);
    if (fwrite(&k, sizeof(double), 1, fp) != 1)
      error->one(FLERR, "Dihedral skin/bend: cannot write to the restart file: {}",
                 utils::getsyserror());
  }
}

/* ---------------------------------------------------------------------- */

void DihedralSkinBend::read_restart(FILE *fp)
{
  allocate();

  const int n = atom->ndihedraltypes;
  if (comm->me == 0) utils::sfread(FLERR, &stiffness[1], sizeof(double), n, fp, nullptr, error);
  MPI_Bcast(&stiffness[1], n, MPI_DOUBLE, 0, world);
  for (int i = 1; i <= n; i++) {
    limit[i] = std::signbit(stiffness[i]) ? 0.0 : SkinFoldLaw::NO_LIMIT;
    stiffness[i] = std::fabs(stiffness[i]);
    setflag[i] = 1;
  }
}

/* ---------------------------------------------------------------------- */

void DihedralSkinBend::write_data(FILE *fp)
{
  for (int i = 1; i <= atom->ndihedraltypes; i++)
    utils::print(fp, "{} {:.17g} {}\n", i, stiffness[i], diverges(i) ? DIVERGING : COSINE);
}

/* ----------------------------------------------------------------------
   for commands that change coefficients
------------------------------------------------------------------------- */

void *DihedralSkinBend::extract(const char *which, int &dim)
{
  dim = 1;
  return std::string(which) == "K" ? stiffness : nullptr;
}

/* ---------------------------------------------------------------------- */

double DihedralSkinBend::memory_usage()
{
  return Dihedral::memory_usage() + triangles.memory_usage() +
      (double) normal.capacity() * sizeof(double);
}
