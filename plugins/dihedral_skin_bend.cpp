// Bending of a triangulated membrane: each dihedral (i1,i2,i3,i4) is a link i2-i3 with the
// triangles (i1,i2,i3) and (i4,i3,i2) on its two sides, E = K/2 (1 - N1.N2)^2.
// Normals are computed once per triangle; a second pass gathers those of the triangles across
// its links, which give dE/dN, and turns that into forces on its three corners.

#include "dihedral_skin_bend.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "force.h"
#include "memory.h"
#include "neighbor.h"
#include "update.h"

#include <cmath>

using namespace LAMMPS_NS;

// smallest length of an unnormalised normal (twice a triangle's area) that has a direction

static constexpr double SMALLEST_NORMAL = 1.0e-10;

/* ---------------------------------------------------------------------- */

DihedralSkinBend::DihedralSkinBend(LAMMPS *lmp) :
    Dihedral(lmp), stiffness(nullptr), built_call(-1), built_step(-1)
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
  }
}

/* ---------------------------------------------------------------------- */

void DihedralSkinBend::compute(int eflag, int vflag)
{
  ev_init(eflag, vflag);

  if (built_call != neighbor->ncalls || built_step != neighbor->lastcall) build_triangles();

  compute_normals();
  if (eflag_either || vflag_either) compute_forces<true>();
  else compute_forces<false>();
}

/* ----------------------------------------------------------------------
   list the distinct triangles of all links and which lie across each other, for the atom
   order of this neighbor build
------------------------------------------------------------------------- */

void DihedralSkinBend::build_triangles()
{
  first_of_vertex.assign(atom->nlocal + atom->nghost, -1);
  next_of_triangle.clear();
  triangles.clear();

  for (int n = 0; n < neighbor->ndihedrallist; n++) {
    const int *d = neighbor->dihedrallist[n];
    const int left = find_triangle(d[0], d[1], d[2]);
    const int right = find_triangle(d[3], d[2], d[1]);
    hinge(left, d[0], right, d[4]);
    hinge(right, d[3], left, d[4]);
  }

  normals.resize(triangles.size());
  built_call = neighbor->ncalls;
  built_step = neighbor->lastcall;
}

/* ----------------------------------------------------------------------
   note that a triangle has another one across the link opposite to one of its vertices
------------------------------------------------------------------------- */

void DihedralSkinBend::hinge(int t, int opposite, int other, int type)
{
  Triangle &triangle = triangles[t];
  int k = 0;
  while (triangle.vertex[k] != opposite) k++;
  if (triangle.across[k] != t) {
    const tagint *tag = atom->tag;
    error->one(FLERR, "Dihedral skin/bend: two dihedrals for one link of the triangle of atoms "
               "{} {} {}", tag[triangle.vertex[0]], tag[triangle.vertex[1]],
               tag[triangle.vertex[2]]);
  }
  triangle.across[k] = other;
  triangle.type[k] = type;
}

/* ----------------------------------------------------------------------
   index of the triangle with these corners in this orientation, added if it is new
------------------------------------------------------------------------- */

int DihedralSkinBend::find_triangle(int a, int b, int c)
{
  // cyclic order is orientation: rotate the smallest index to the front

  int v[3] = {a, b, c};
  if (b < a && b < c) {
    v[0] = b; v[1] = c; v[2] = a;
  } else if (c < a && c < b) {
    v[0] = c; v[1] = a; v[2] = b;
  }

  for (int t = first_of_vertex[v[0]]; t >= 0; t = next_of_triangle[t])
    if (triangles[t].vertex[1] == v[1] && triangles[t].vertex[2] == v[2]) return t;

  const int t = (int) triangles.size();

  // across a link that has no dihedral here lies the triangle itself: no fold, no energy

  triangles.push_back({{v[0], v[1], v[2]}, {t, t, t}, {1, 1, 1}});
  next_of_triangle.push_back(first_of_vertex[v[0]]);
  first_of_vertex[v[0]] = t;
  return t;
}

/* ---------------------------------------------------------------------- */

void DihedralSkinBend::compute_normals()
{
  const double *const *const x = atom->x;
  const int ntriangles = (int) triangles.size();

  for (int t = 0; t < ntriangles; t++) {
    const int *v = triangles[t].vertex;
    const double *o = x[v[0]], *p = x[v[1]], *q = x[v[2]];
    const double e1x = p[0] - o[0], e1y = p[1] - o[1], e1z = p[2] - o[2];
    const double e2x = q[0] - o[0], e2y = q[1] - o[1], e2z = q[2] - o[2];
    const double nx = e1y * e2z - e1z * e2y;
    const double ny = e1z * e2x - e1x * e2z;
    const double nz = e1x * e2y - e1y * e2x;
    const double lengthsq = nx * nx + ny * ny + nz * nz;

    // the negated test also catches NaN

    if (!(lengthsq > SMALLEST_NORMAL * SMALLEST_NORMAL)) degenerate(t);

    const double inverse = 1.0 / sqrt(lengthsq);
    normals[t] = {{nx * inverse, ny * inverse, nz * inverse}, inverse};
  }
}

/* ----------------------------------------------------------------------
   each triangle gathers dE/dN over its three links and turns it into forces on its corners
------------------------------------------------------------------------- */

template <bool TALLY> void DihedralSkinBend::compute_forces()
{
  const double *const *const x = atom->x;
  double *const *const f = atom->f;
  const int ntriangles = (int) triangles.size();

  for (int t = 0; t < ntriangles; t++) {
    const Triangle &triangle = triangles[t];
    const double *n = normals[t].unit;
    double g[3] = {0.0, 0.0, 0.0};

    for (int k = 0; k < 3; k++) {
      const double *m = normals[triangle.across[k]].unit;
      const double fold = 1.0 - (n[0] * m[0] + n[1] * m[1] + n[2] * m[2]);
      const double slope = stiffness[triangle.type[k]] * fold;
      g[0] -= slope * m[0];
      g[1] -= slope * m[1];
      g[2] -= slope * m[2];
      if (TALLY && eflag_either) tally_energy(triangle, k, 0.5 * slope * fold);
    }

    const int *v = triangle.vertex;
    const double *o = x[v[0]], *p = x[v[1]], *q = x[v[2]];
    const double e1[3] = {p[0] - o[0], p[1] - o[1], p[2] - o[2]};
    const double e2[3] = {q[0] - o[0], q[1] - o[1], q[2] - o[2]};

    // h = dE/d(unnormalised normal)

    const double along = g[0] * n[0] + g[1] * n[1] + g[2] * n[2];
    const double inverse = normals[t].inverse;
    const double hx = (g[0] - along * n[0]) * inverse;
    const double hy = (g[1] - along * n[1]) * inverse;
    const double hz = (g[2] - along * n[2]) * inverse;

    const double fp[3] = {hy * e2[2] - hz * e2[1], hz * e2[0] - hx * e2[2],
                          hx * e2[1] - hy * e2[0]};
    const double fq[3] = {hz * e1[1] - hy * e1[2], hx * e1[2] - hz * e1[0],
                          hy * e1[0] - hx * e1[1]};

    for (int k = 0; k < 3; k++) {
      f[v[0]][k] -= fp[k] + fq[k];
      f[v[1]][k] += fp[k];
      f[v[2]][k] += fq[k];
    }
    if (TALLY && vflag_either) tally_virial(triangle, e1, fp, e2, fq);
  }
}

/* ----------------------------------------------------------------------
   half of a link's energy, seen from the triangle on one of its sides; of the whole, each of
   the four atoms of the dihedral has a quarter
------------------------------------------------------------------------- */

void DihedralSkinBend::tally_energy(const Triangle &triangle, int opposite, double link)
{
  if (eflag_global) energy += 0.5 * link;
  if (eflag_atom)
    for (int k = 0; k < 3; k++)
      eatom[triangle.vertex[k]] += (k == opposite ? 0.25 : 0.125) * link;
}

/* ----------------------------------------------------------------------
   virial of a triangle, from its two edges and the forces at their ends
------------------------------------------------------------------------- */

void DihedralSkinBend::tally_virial(const Triangle &triangle, const double *e1, const double *f1,
                                    const double *e2, const double *f2)
{
  const double w[6] = {e1[0] * f1[0] + e2[0] * f2[0], e1[1] * f1[1] + e2[1] * f2[1],
                       e1[2] * f1[2] + e2[2] * f2[2], e1[0] * f1[1] + e2[0] * f2[1],
                       e1[0] * f1[2] + e2[0] * f2[2], e1[1] * f1[2] + e2[1] * f2[2]};
  for (int k = 0; k < 6; k++) {
    if (vflag_global) virial[k] += w[k];
    if (vflag_atom)
      for (int c = 0; c < 3; c++) vatom[triangle.vertex[c]][k] += w[k] / 3.0;
  }
}

/* ---------------------------------------------------------------------- */

void DihedralSkinBend::degenerate(int t)
{
  const int *v = triangles[t].vertex;
  const tagint *tag = atom->tag;
  error->one(FLERR,
             "Dihedral skin/bend: the triangle of atoms {} {} {} has no normal on step {}: its "
             "area is below {}; try a smaller timestep than {}",
             tag[v[0]], tag[v[1]], tag[v[2]], update->ntimestep, 0.5 * SMALLEST_NORMAL, update->dt);
}

/* ---------------------------------------------------------------------- */

void DihedralSkinBend::allocate()
{
  allocated = 1;
  const int np1 = atom->ndihedraltypes + 1;

  memory->create(stiffness, np1, "dihedral:stiffness");
  memory->create(setflag, np1, "dihedral:setflag");
  for (int i = 1; i < np1; i++) setflag[i] = 0;
}

/* ----------------------------------------------------------------------
   set coeffs for one or more types
------------------------------------------------------------------------- */

void DihedralSkinBend::coeff(int narg, char **arg)
{
  if (narg != 2)
    error->all(FLERR, "Dihedral style skin/bend needs one coefficient, K, but got {}", narg - 1);
  if (!allocated) allocate();

  int ilo, ihi;
  utils::bounds_typelabel(FLERR, arg[0], 1, atom->ndihedraltypes, ilo, ihi, lmp, Atom::DIHEDRAL);

  const double k = utils::numeric(FLERR, arg[1], false, lmp);
  if (!(k >= 0.0) || std::isinf(k))
    error->all(FLERR, "Dihedral style skin/bend: K = {} must be a number >= 0", arg[1]);

  for (int i = ilo; i <= ihi; i++) {
    stiffness[i] = k;
    setflag[i] = 1;
  }
}

/* ---------------------------------------------------------------------- */

void DihedralSkinBend::init_style()
{
  if (!force->newton_bond) error->all(FLERR, "Dihedral style skin/bend needs newton on for bonds");
  built_call = built_step = -1;
}

/* ---------------------------------------------------------------------- */

void DihedralSkinBend::write_restart(FILE *fp)
{
  fwrite(&stiffness[1], sizeof(double), atom->ndihedraltypes, fp);
}

/* ---------------------------------------------------------------------- */

void DihedralSkinBend::read_restart(FILE *fp)
{
  allocate();

  if (comm->me == 0)
    utils::sfread(FLERR, &stiffness[1], sizeof(double), atom->ndihedraltypes, fp, nullptr, error);
  MPI_Bcast(&stiffness[1], atom->ndihedraltypes, MPI_DOUBLE, 0, world);

  for (int i = 1; i <= atom->ndihedraltypes; i++) setflag[i] = 1;
}

/* ---------------------------------------------------------------------- */

void DihedralSkinBend::write_data(FILE *fp)
{
  for (int i = 1; i <= atom->ndihedraltypes; i++) fprintf(fp, "%d %.17g\n", i, stiffness[i]);
}

/* ---------------------------------------------------------------------- */

double DihedralSkinBend::memory_usage()
{
  double bytes = Dihedral::memory_usage();
  bytes += (double) triangles.capacity() *
      (sizeof(Triangle) + sizeof(Normal) + sizeof(int));
  bytes += (double) first_of_vertex.capacity() * sizeof(int);
  return bytes;
}
