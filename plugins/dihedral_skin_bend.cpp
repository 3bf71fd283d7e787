// Bending of a triangulated membrane: each dihedral (i1,i2,i3,i4) is a link i2-i3 with the
// triangles (i1,i2,i3) and (i4,i3,i2) on its two sides, E = K/2 (1 - N1.N2)^2.
// Normals are computed once per triangle; a second pass gathers those of the triangles across
// its links, which give dE/dN, and turns that into forces on its three corners.

#include "dihedral_skin_bend.h"

#include "skin_vector.h"

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

// smallest length of an unnormalised normal (twice a triangle's area) that has a direction

static constexpr double SMALLEST_NORMAL = 1.0e-10;

// cosine of the angle by which an inverted triangle is folded against all that are around it

static constexpr double INVERTED = -0.5;

static constexpr double DEGREES = 180.0 / 3.14159265358979323846;

/* ---------------------------------------------------------------------- */

DihedralSkinBend::DihedralSkinBend(LAMMPS *lmp) :
    Dihedral(lmp), stiffness(nullptr), ntriangles(0), built_call(-1), built_step(-1)
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

/* ----------------------------------------------------------------------
   normals of all triangles; returns how many have none
------------------------------------------------------------------------- */

SKIN_VECTOR static int normals_of(int n, const double *__restrict x, const int *__restrict c0,
                                  const int *__restrict c1, const int *__restrict c2,
                                  double *__restrict nx, double *__restrict ny,
                                  double *__restrict nz, double *__restrict inverse)
{
  int without = 0;
  for (int t = 0; t < n; t++) {
    const int o = 3 * c0[t], p = 3 * c1[t], q = 3 * c2[t];
    const double ax = x[p] - x[o], ay = x[p + 1] - x[o + 1], az = x[p + 2] - x[o + 2];
    const double bx = x[q] - x[o], by = x[q + 1] - x[o + 1], bz = x[q + 2] - x[o + 2];
    const double vx = ay * bz - az * by, vy = az * bx - ax * bz, vz = ax * by - ay * bx;
    const double lengthsq = vx * vx + vy * vy + vz * vz;
    const double inv = 1.0 / sqrt(lengthsq);

    // the negated test also catches NaN

    without += !(lengthsq > SMALLEST_NORMAL * SMALLEST_NORMAL);
    nx[t] = vx * inv;
    ny[t] = vy * inv;
    nz[t] = vz * inv;
    inverse[t] = inv;
  }
  return without;
}

/* ----------------------------------------------------------------------
   each triangle gathers dE/dN over its three links and turns it into forces on its corners:
   g = dE/d(unit normal), h = dE/d(unnormalised normal); a and b are its edges from corner 0
------------------------------------------------------------------------- */

template <bool ONE_TYPE>
static inline __attribute__((always_inline)) void
forces_loop(int n, const double *__restrict x, const int *const *corner, const int *const *across,
            const int *const *type, const double *__restrict stiffness,
            const double *const *normal, const double *__restrict inverse, double *const *push)
{
  const int *__restrict c0 = corner[0], *__restrict c1 = corner[1], *__restrict c2 = corner[2];
  const double *__restrict nx = normal[0], *__restrict ny = normal[1], *__restrict nz = normal[2];
  double *__restrict px = push[0], *__restrict py = push[1], *__restrict pz = push[2];
  double *__restrict qx = push[3], *__restrict qy = push[4], *__restrict qz = push[5];
  const int *__restrict m0 = across[0], *__restrict m1 = across[1], *__restrict m2 = across[2];
  const int *__restrict k0 = type[0], *__restrict k1 = type[1], *__restrict k2 = type[2];
  const double common = stiffness[1];

  for (int t = 0; t < n; t++) {
    const double ux = nx[t], uy = ny[t], uz = nz[t];
    const int i = m0[t], j = m1[t], k = m2[t];
    const double ix = nx[i], iy = ny[i], iz = nz[i];
    const double jx = nx[j], jy = ny[j], jz = nz[j];
    const double kx = nx[k], ky = ny[k], kz = nz[k];
    const double si = (ONE_TYPE ? common : stiffness[k0[t]]) * (ux * ix + uy * iy + uz * iz - 1.0);
    const double sj = (ONE_TYPE ? common : stiffness[k1[t]]) * (ux * jx + uy * jy + uz * jz - 1.0);
    const double sk = (ONE_TYPE ? common : stiffness[k2[t]]) * (ux * kx + uy * ky + uz * kz - 1.0);
    const double gx = si * ix + sj * jx + sk * kx;
    const double gy = si * iy + sj * jy + sk * ky;
    const double gz = si * iz + sj * jz + sk * kz;

    const double along = gx * ux + gy * uy + gz * uz;
    const double hx = (gx - along * ux) * inverse[t];
    const double hy = (gy - along * uy) * inverse[t];
    const double hz = (gz - along * uz) * inverse[t];

    const int o = 3 * c0[t], p = 3 * c1[t], q = 3 * c2[t];
    const double ax = x[p] - x[o], ay = x[p + 1] - x[o + 1], az = x[p + 2] - x[o + 2];
    const double bx = x[q] - x[o], by = x[q + 1] - x[o + 1], bz = x[q + 2] - x[o + 2];
    px[t] = hy * bz - hz * by;
    py[t] = hz * bx - hx * bz;
    pz[t] = hx * by - hy * bx;
    qx[t] = hz * ay - hy * az;
    qy[t] = hx * az - hz * ax;
    qz[t] = hy * ax - hx * ay;
  }
}

SKIN_VECTOR static void forces_of(int n, int ntypes, const double *x, const int *const *corner,
                                  const int *const *across, const int *const *type,
                                  const double *stiffness, const double *const *normal,
                                  const double *inverse, double *const *push)
{
  if (ntypes == 1)
    forces_loop<true>(n, x, corner, across, type, stiffness, normal, inverse, push);
  else
    forces_loop<false>(n, x, corner, across, type, stiffness, normal, inverse, push);
}

/* ---------------------------------------------------------------------- */

void DihedralSkinBend::compute(int eflag, int vflag)
{
  ev_init(eflag, vflag);

  if (built_call != neighbor->ncalls || built_step != neighbor->lastcall) build_triangles();
  if (ntriangles == 0) return;

  const double *x = atom->x[0];
  if (normals_of(ntriangles, x, corner[0].data(), corner[1].data(), corner[2].data(),
                 normal[0].data(), normal[1].data(), normal[2].data(), inverse.data()))
    for (int t = 0; t < ntriangles; t++)
      if (!(inverse[t] < 1.0 / SMALLEST_NORMAL)) degenerate(t);

  const int *corners[] = {corner[0].data(), corner[1].data(), corner[2].data()};
  const int *others[] = {across[0].data(), across[1].data(), across[2].data()};
  const int *types[] = {type[0].data(), type[1].data(), type[2].data()};
  const double *units[] = {normal[0].data(), normal[1].data(), normal[2].data()};
  double *pushes[] = {push[0].data(), push[1].data(), push[2].data(),
                      push[3].data(), push[4].data(), push[5].data()};
  forces_of(ntriangles, atom->ndihedraltypes, x, corners, others, types, stiffness, units,
            inverse.data(), pushes);

  add_forces();
  if (eflag_either) tally_energy();
  if (vflag_either) tally_virial();
}

/* ----------------------------------------------------------------------
   list the distinct triangles of all links and which lie across each other, for the atom
   order of this neighbor build
------------------------------------------------------------------------- */

void DihedralSkinBend::build_triangles()
{
  first_of_vertex.assign(atom->nlocal + atom->nghost, -1);
  next_of_triangle.clear();
  for (int k = 0; k < 3; k++) {
    corner[k].clear();
    across[k].clear();
    type[k].clear();
  }
  ntriangles = 0;

  for (int n = 0; n < neighbor->ndihedrallist; n++) {
    const int *d = neighbor->dihedrallist[n];
    const int left = find_triangle(d[0], d[1], d[2]);
    const int right = find_triangle(d[3], d[2], d[1]);
    hinge(left, d[0], right, d[4]);
    hinge(right, d[3], left, d[4]);
  }

  for (auto &component : normal) component.resize(ntriangles);
  for (auto &component : push) component.resize(ntriangles);
  inverse.resize(ntriangles);
  built_call = neighbor->ncalls;
  built_step = neighbor->lastcall;
}

/* ----------------------------------------------------------------------
   note that a triangle has another one across the link opposite to one of its vertices
------------------------------------------------------------------------- */

void DihedralSkinBend::hinge(int t, int opposite, int other, int dihedral_type)
{
  int k = 0;
  while (corner[k][t] != opposite) k++;
  if (across[k][t] != t)
    error->one(FLERR, "Dihedral skin/bend: two dihedrals for one link of the triangle of atoms "
               "{} {} {}", atom->tag[corner[0][t]], atom->tag[corner[1][t]],
               atom->tag[corner[2][t]]);
  across[k][t] = other;
  type[k][t] = dihedral_type;
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
    if (corner[1][t] == v[1] && corner[2][t] == v[2]) return t;

  // across a link that has no dihedral here lies the triangle itself: no fold, no energy

  const int t = ntriangles++;
  for (int k = 0; k < 3; k++) {
    corner[k].push_back(v[k]);
    across[k].push_back(t);
    type[k].push_back(1);
  }
  next_of_triangle.push_back(first_of_vertex[v[0]]);
  first_of_vertex[v[0]] = t;
  return t;
}

/* ---------------------------------------------------------------------- */

void DihedralSkinBend::add_forces()
{
  double *const f = atom->f[0];
  for (int t = 0; t < ntriangles; t++) {
    double *o = f + 3 * corner[0][t], *p = f + 3 * corner[1][t], *q = f + 3 * corner[2][t];
    for (int d = 0; d < 3; d++) {
      o[d] -= push[d][t] + push[3 + d][t];
      p[d] += push[d][t];
      q[d] += push[3 + d][t];
    }
  }
}

/* ----------------------------------------------------------------------
   a bound for the stiffness of the corners of the triangles of the last compute(): the second
   derivative by the angle over the squares of the triangle's heights
------------------------------------------------------------------------- */

void DihedralSkinBend::add_stiffness(double *sum) const
{
  for (int t = 0; t < ntriangles; t++) {
    double fold = 0.0;
    for (int k = 0; k < 3; k++) {
      const int m = across[k][t];
      const double c = normal[0][t] * normal[0][m] + normal[1][t] * normal[1][m] +
          normal[2][t] * normal[2][m];
      if (m != t) fold += stiffness[type[k][t]] * (1.0 - c) * (2.0 + c);
    }

    double edges = 0.0;
    for (int k = 0; k < 3; k++) {
      const double *p = atom->x[corner[k][t]], *q = atom->x[corner[(k + 1) % 3][t]];
      for (int d = 0; d < 3; d++) edges += (q[d] - p[d]) * (q[d] - p[d]);
    }
    const double bound = fold * edges * inverse[t] * inverse[t];
    for (int k = 0; k < 3; k++) sum[corner[k][t]] += bound;
  }
}

/* ----------------------------------------------------------------------
   cosine of the angle of the smallest fold of a triangle against the three around it
------------------------------------------------------------------------- */

double DihedralSkinBend::least_fold(int t) const
{
  double least = -1.0;
  for (int k = 0; k < 3; k++) {
    const int m = across[k][t];
    least = std::max(least, normal[0][t] * normal[0][m] + normal[1][t] * normal[1][m] +
                                normal[2][t] * normal[2][m]);
  }
  return least;
}

/* ----------------------------------------------------------------------
   a triangle of the last compute() that is folded far over against all three around it, so
   that it has been turned over, or -1
------------------------------------------------------------------------- */

int DihedralSkinBend::find_inverted() const
{
  for (int t = 0; t < ntriangles; t++)
    if (least_fold(t) < INVERTED) return t;
  return -1;
}

/* ----------------------------------------------------------------------
   each link is seen from both of its triangles, half of its energy from each; of the whole,
   each of the four atoms of the dihedral has a quarter
------------------------------------------------------------------------- */

void DihedralSkinBend::tally_energy()
{
  for (int t = 0; t < ntriangles; t++) {
    for (int k = 0; k < 3; k++) {
      const int m = across[k][t];
      const double fold = 1.0 - normal[0][t] * normal[0][m] - normal[1][t] * normal[1][m] -
          normal[2][t] * normal[2][m];
      const double link = m == t ? 0.0 : 0.5 * stiffness[type[k][t]] * fold * fold;
      if (eflag_global) energy += 0.5 * link;
      if (eflag_atom)
        for (int c = 0; c < 3; c++) eatom[corner[c][t]] += (c == k ? 0.25 : 0.125) * link;
    }
  }
}

/* ----------------------------------------------------------------------
   virial of the triangles, from their edges at corner 0 and the forces at the ends of these
------------------------------------------------------------------------- */

void DihedralSkinBend::tally_virial()
{
  static constexpr int FIRST[] = {0, 1, 2, 0, 0, 1}, SECOND[] = {0, 1, 2, 1, 2, 2};

  for (int t = 0; t < ntriangles; t++) {
    const double *o = atom->x[corner[0][t]];
    const double *p = atom->x[corner[1][t]], *q = atom->x[corner[2][t]];
    for (int k = 0; k < 6; k++) {
      const int i = FIRST[k], j = SECOND[k];
      const double w = (p[i] - o[i]) * push[j][t] + (q[i] - o[i]) * push[3 + j][t];
      if (vflag_global) virial[k] += w;
      if (vflag_atom)
        for (int c = 0; c < 3; c++) vatom[corner[c][t]][k] += w / 3.0;
    }
  }
}

/* ---------------------------------------------------------------------- */

void DihedralSkinBend::inverted(int t, double duration) const
{
  const tagint *tag = atom->tag;
  error->one(FLERR,
             "Dihedral skin/bend: the triangle of atoms {} {} {} is inverted on step {}: its "
             "folds against the three around it are {} degrees and more, above {}, and there have "
             "been inverted ones for {} time units; try a smaller timestep than {}",
             tag[corner[0][t]], tag[corner[1][t]], tag[corner[2][t]], update->ntimestep,
             std::acos(least_fold(t)) * DEGREES, std::acos(INVERTED) * DEGREES, duration,
             update->dt);
}

/* ---------------------------------------------------------------------- */

void DihedralSkinBend::degenerate(int t)
{
  const tagint *tag = atom->tag;
  error->one(FLERR,
             "Dihedral skin/bend: the triangle of atoms {} {} {} has no normal on step {}: its "
             "area is below {}; try a smaller timestep than {}",
             tag[corner[0][t]], tag[corner[1][t]], tag[corner[2][t]], update->ntimestep,
             0.5 * SMALLEST_NORMAL, update->dt);
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
  const size_t n = atom->ndihedraltypes;
  if (fwrite(&stiffness[1], sizeof(double), n, fp) != n)
    error->one(FLERR, "Dihedral skin/bend: cannot write to the restart file: {}",
               utils::getsyserror());
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
  for (int i = 1; i <= atom->ndihedraltypes; i++)
    utils::print(fp, "{} {:.17g}\n", i, stiffness[i]);
}

/* ---------------------------------------------------------------------- */

double DihedralSkinBend::memory_usage()
{
  double bytes = Dihedral::memory_usage();
  bytes += (double) ntriangles * (10 * sizeof(int) + 10 * sizeof(double));
  bytes += (double) first_of_vertex.capacity() * sizeof(int);
  return bytes;
}
