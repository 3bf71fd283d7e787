// Bending of a triangulated membrane: each dihedral (i1,i2,i3,i4) is a link i2-i3 with the
// triangles (i1,i2,i3) and (i4,i3,i2) on its two sides, E = K/2 (1 - N1.N2)^2.
// Normals are computed once per triangle; the links then only add up dE/dN of their two
// triangles, and one pass over the triangles turns that into forces.

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
  compute_hinges();
  compute_forces();
}

/* ----------------------------------------------------------------------
   list the distinct triangles of all links, for the atom order of this neighbor build
------------------------------------------------------------------------- */

void DihedralSkinBend::build_triangles()
{
  const int nhinges = neighbor->ndihedrallist;
  int **dihedrallist = neighbor->dihedrallist;

  first_of_vertex.assign(atom->nlocal + atom->nghost, -1);
  next_of_triangle.clear();
  triangles.clear();
  hinges.resize(nhinges);

  for (int n = 0; n < nhinges; n++) {
    const int *d = dihedrallist[n];
    hinges[n].side[0] = find_triangle(d[0], d[1], d[2]);
    hinges[n].side[1] = find_triangle(d[3], d[2], d[1]);
    hinges[n].type = d[4];
  }

  normals.resize(triangles.size());
  gradients.resize(triangles.size());
  built_call = neighbor->ncalls;
  built_step = neighbor->lastcall;
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
  triangles.push_back({{v[0], v[1], v[2]}});
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
    gradients[t] = {{0.0, 0.0, 0.0}};
  }
}

/* ----------------------------------------------------------------------
   energy of every link, and dE/dN added to its two triangles
------------------------------------------------------------------------- */

void DihedralSkinBend::compute_hinges()
{
  const int nhinges = (int) hinges.size();
  double total = 0.0;

  for (int n = 0; n < nhinges; n++) {
    const Hinge &hinge = hinges[n];
    const double *a = normals[hinge.side[0]].unit;
    const double *b = normals[hinge.side[1]].unit;
    double *ga = gradients[hinge.side[0]].value;
    double *gb = gradients[hinge.side[1]].value;

    const double fold = 1.0 - (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
    const double slope = stiffness[hinge.type] * fold;

    ga[0] -= slope * b[0];
    ga[1] -= slope * b[1];
    ga[2] -= slope * b[2];
    gb[0] -= slope * a[0];
    gb[1] -= slope * a[1];
    gb[2] -= slope * a[2];

    if (eflag_either) {
      const double e = 0.5 * slope * fold;
      total += e;
      if (eflag_atom)
        for (int k = 0; k < 4; k++) eatom[neighbor->dihedrallist[n][k]] += 0.25 * e;
    }
  }

  if (eflag_global) energy += total;
}

/* ----------------------------------------------------------------------
   forces from dE/dN; both virials follow from the two edges of each triangle
------------------------------------------------------------------------- */

void DihedralSkinBend::compute_forces()
{
  const double *const *const x = atom->x;
  double *const *const f = atom->f;
  const int ntriangles = (int) triangles.size();

  for (int t = 0; t < ntriangles; t++) {
    const int *v = triangles[t].vertex;
    const double *o = x[v[0]], *p = x[v[1]], *q = x[v[2]];
    const double e1[3] = {p[0] - o[0], p[1] - o[1], p[2] - o[2]};
    const double e2[3] = {q[0] - o[0], q[1] - o[1], q[2] - o[2]};
    const double *n = normals[t].unit;
    const double *g = gradients[t].value;

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

    if (vflag_either) {
      const double w[6] = {e1[0] * fp[0] + e2[0] * fq[0], e1[1] * fp[1] + e2[1] * fq[1],
                           e1[2] * fp[2] + e2[2] * fq[2], e1[0] * fp[1] + e2[0] * fq[1],
                           e1[0] * fp[2] + e2[0] * fq[2], e1[1] * fp[2] + e2[1] * fq[2]};
      for (int k = 0; k < 6; k++) {
        if (vflag_global) virial[k] += w[k];
        if (vflag_atom)
          for (int c = 0; c < 3; c++) vatom[v[c]][k] += w[k] / 3.0;
      }
    }
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
      (sizeof(Triangle) + sizeof(Normal) + sizeof(Gradient) + sizeof(int));
  bytes += (double) hinges.capacity() * sizeof(Hinge);
  bytes += (double) first_of_vertex.capacity() * sizeof(int);
  return bytes;
}
