#include "skin_bend_forces.h"

#include "skin_vector.h"

#include <algorithm>

using namespace LAMMPS_NS;

// numbers from a triangle to the next, and from a pair to the next

static constexpr int TRIANGLE = sizeof(SkinTriangle) / sizeof(int);
static constexpr int PAIR = 2 * TRIANGLE;

// triangles, and pairs of them, for which memory is asked for ahead

static constexpr int AHEAD = 16;

/* ----------------------------------------------------------------------
   normals of one triangle or of four; adds to without what have none
------------------------------------------------------------------------- */

template <class T>
SKIN_INLINE void normals_of(const SkinTriangle *t, const double *x, double *normal, T &without)
{
  const SkinPoint<T> o = load<T>(x, &t->corner[0], TRIANGLE);
  const SkinPoint<T> v = cross(load<T>(x, &t->corner[1], TRIANGLE) - o,
                               load<T>(x, &t->corner[2], TRIANGLE) - o);
  const T zero = {}, one = zero + 1.0, lengthsq = dot(v, v), inverse = 1.0 / root(lengthsq);

  // what is no number counts, too

  without += lengthsq > SKIN_SMALLEST_NORMAL * SKIN_SMALLEST_NORMAL ? zero : one;
  store_rows(normal, inverse * v, inverse);
}

SKIN_INLINE double all_normals(const std::vector<SkinTriangle> &triangles, int begin, int end,
                               const double *x, double *normal)
{
  const SkinTriangle *const all = triangles.data();
  SkinDouble4 four_without = {};
  double without = 0.0;
  int t = begin;
  for (; t + 4 <= end; t += 4) {
    const SkinTriangle *const later = all + smaller(t + AHEAD, end - 4);
    for (int m = 0; m < 4; m++) fetch(x, later[m].corner[0]);
    normals_of(all + t, x, normal + 4 * t, four_without);
  }
  for (; t < end; t++) normals_of(all + t, x, normal + 4 * t, without);
  return without + sum(four_without);
}

/* ----------------------------------------------------------------------
   coefficients of the links of these types
------------------------------------------------------------------------- */

template <class T, bool ONE_TYPE>
SKIN_INLINE T coefficient_of(const double *all, const int *type, int stride)
{
  if constexpr (ONE_TYPE)
    return T{} + all[1];
  else if constexpr (skin_width<T> == 1)
    return all[type[0]];
  else
    return T{all[type[0]], all[type[stride]], all[type[2 * stride]], all[type[3 * stride]]};
}

/* ----------------------------------------------------------------------
   dE/dc of folds with these cosines c, times the normal across the link what they add to dE/dN
------------------------------------------------------------------------- */

template <class T, bool ONE_TYPE, bool LIMITED>
SKIN_INLINE T slope(const SkinFoldLaw &law, const int *type, int stride, const T &cosine)
{
  T each = cosine - 1.0;
  if constexpr (LIMITED) {
    const T limit = coefficient_of<T, ONE_TYPE>(law.limit, type, stride), open = 1.0 + cosine;
    const T diverging = -1.0 / (open * open);
    each = cosine < limit ? diverging : each;
  }
  return coefficient_of<T, ONE_TYPE>(law.stiffness, type, stride) * each;
}

/* ----------------------------------------------------------------------
   g = dE/d(unit normal) as dE/d(unnormalised normal)
------------------------------------------------------------------------- */

template <class T>
SKIN_INLINE SkinPoint<T> turn(const SkinPoint<T> &g, const SkinPoint<T> &normal, const T &inverse)
{
  return inverse * (g - dot(g, normal) * normal);
}

/* ----------------------------------------------------------------------
   forces of one pair of triangles (i1,i2,i3) and (i4,i3,i2), or of four pairs; a and b are their
   normals
------------------------------------------------------------------------- */

template <class T, bool ONE_TYPE, bool LIMITED>
SKIN_INLINE void bend_pair(const SkinTriangle *t, const double *x, const SkinFoldLaw &law,
                           const double *normal, double least, double *f, T &inverted)
{
  const SkinTriangle &first = t[0], &second = t[1];
  T of_a, of_b, unused;
  const SkinPoint<T> a = load_rows<T>(normal, &second.across[0], PAIR, of_a);
  const SkinPoint<T> b = load_rows<T>(normal, &first.across[0], PAIR, of_b);
  const T between = dot(a, b);
  const T shared = slope<T, ONE_TYPE, LIMITED>(law, &first.type[0], PAIR, between);

  SkinPoint<T> ga = shared * b, gb = shared * a;
  T most_a = between, most_b = between;
  for (int k = 1; k < 3; k++) {
    const SkinPoint<T> c = load_rows<T>(normal, &first.across[k], PAIR, unused);
    const SkinPoint<T> d = load_rows<T>(normal, &second.across[k], PAIR, unused);
    const T ac = dot(a, c), bd = dot(b, d);
    ga = ga + slope<T, ONE_TYPE, LIMITED>(law, &first.type[k], PAIR, ac) * c;
    gb = gb + slope<T, ONE_TYPE, LIMITED>(law, &second.type[k], PAIR, bd) * d;
    most_a = larger(most_a, ac);
    most_b = larger(most_b, bd);
  }
  const T zero = {}, one = zero + 1.0;
  inverted += smaller(most_a, most_b) < least ? one : zero;

  const SkinPoint<T> ha = turn(ga, a, of_a), hb = turn(gb, b, of_b);
  const SkinPoint<T> x1 = load<T>(x, &first.corner[0], PAIR);
  const SkinPoint<T> x2 = load<T>(x, &first.corner[1], PAIR);
  const SkinPoint<T> x3 = load<T>(x, &first.corner[2], PAIR);
  const SkinPoint<T> x4 = load<T>(x, &second.corner[0], PAIR);
  const SkinPoint<T> a2 = cross(ha, x3 - x1), a3 = cross(x2 - x1, ha);
  const SkinPoint<T> b3 = cross(hb, x2 - x4), b2 = cross(x3 - x4, hb);
  add(f, &first.corner[0], PAIR, SkinPoint<T>{} - (a2 + a3));
  add(f, &first.corner[1], PAIR, a2 + b2);
  add(f, &first.corner[2], PAIR, a3 + b3);
  add(f, &second.corner[0], PAIR, SkinPoint<T>{} - (b2 + b3));
}

/* ---------------------------------------------------------------------- */

template <bool ONE_TYPE, bool LIMITED>
SKIN_INLINE double bend_pairs(const std::vector<SkinTriangle> &triangles, int begin, int end,
                              const double *x, const SkinFoldLaw &law, const double *normal,
                              double least, double *f)
{
  const SkinTriangle *const all = triangles.data();
  SkinDouble4 four_inverted = {};
  double inverted = 0.0;
  int k = begin;
  for (; k + 4 <= end; k += 4) {
    const SkinTriangle *const later = all + 2 * smaller(k + AHEAD, end - 4);
    for (int m = 0; m < 8; m++) {
      fetch_row(normal, later[m].across[1]);
      fetch_row(normal, later[m].across[2]);
      fetch(f, later[m].corner[0]);
    }
    bend_pair<SkinDouble4, ONE_TYPE, LIMITED>(all + 2 * k, x, law, normal, least, f, four_inverted);
  }
  for (; k < end; k++)
    bend_pair<double, ONE_TYPE, LIMITED>(all + 2 * k, x, law, normal, least, f, inverted);
  return inverted + sum(four_inverted);
}

/* ----------------------------------------------------------------------
   block by block, so that normals are still at hand when they are used
------------------------------------------------------------------------- */

SKIN_VECTOR static SkinFolds bend_blocks(const SkinTriangles &triangles, const double *x,
                                         const SkinFoldLaw &law, double least, double *normal,
                                         double *f)
{
  const std::vector<SkinTriangle> &all = triangles.all;
  const int npairs = triangles.npairs;
  SkinFolds folds = {all_normals(all, 2 * npairs, (int) all.size(), x, normal), 0.0};
  int known = 0;
  for (int begin = 0, block = 0; begin < npairs; begin += SkinTriangles::BLOCK, block++) {
    folds.without_normal += all_normals(all, known, triangles.reach[block], x, normal);
    known = triangles.reach[block];

    const int end = std::min(begin + SkinTriangles::BLOCK, npairs);
    folds.inverted += law.limited ?
        bend_pairs<false, true>(all, begin, end, x, law, normal, least, f) : law.ntypes == 1 ?
        bend_pairs<true, false>(all, begin, end, x, law, normal, least, f) :
        bend_pairs<false, false>(all, begin, end, x, law, normal, least, f);
  }
  return folds;
}

/* ---------------------------------------------------------------------- */

SkinFolds LAMMPS_NS::skin_bend(const SkinTriangles &triangles, const double *x,
                               const SkinFoldLaw &law, double least, double *normal, double *f)
{
  SkinFolds folds = bend_blocks(triangles, x, law, least, normal, f);

  // triangles without a partner are few

  for (int t = 2 * triangles.npairs; t < (int) triangles.all.size(); t++) {
    const SkinTriangle &mine = triangles.all[t];
    const SkinCornerForces push = skin_corner_forces(triangles, t, x, law, normal);
    add(f, &mine.corner[0], 1, SkinPoint<double>{} - (push.one + push.two));
    add(f, &mine.corner[1], 1, push.one);
    add(f, &mine.corner[2], 1, push.two);

    double most = -1.0;
    for (int k = 0; k < 3; k++) most = larger(most, skin_cosine(triangles, t, k, normal));
    folds.inverted += most < least;
  }
  return folds;
}

/* ----------------------------------------------------------------------
   each fold is seen from both of its triangles; without another one across, a triangle sees itself
------------------------------------------------------------------------- */

SKIN_VECTOR static double energy_of_all(const std::vector<SkinTriangle> &all,
                                        const SkinFoldLaw &law, const double *normal)
{
  double sum = 0.0;
  for (int t = 0; t < (int) all.size(); t++) {
    const double *const a = normal + 4L * t;
    for (int k = 0; k < 3; k++) {
      const double *const b = normal + 4L * all[t].across[k];
      sum += law.energy(all[t].type[k], a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
    }
  }
  return 0.5 * sum;
}

/* ---------------------------------------------------------------------- */

double LAMMPS_NS::skin_bend_energy(const SkinTriangles &triangles, const SkinFoldLaw &law,
                                   const double *normal)
{
  return energy_of_all(triangles.all, law, normal);
}

/* ---------------------------------------------------------------------- */

SkinCornerForces LAMMPS_NS::skin_corner_forces(const SkinTriangles &triangles, int t,
                                               const double *x, const SkinFoldLaw &law,
                                               const double *normal)
{
  const SkinTriangle &mine = triangles.all[t];
  double inverse, unused;
  const SkinPoint<double> a = load_rows<double>(normal, &t, 1, inverse);
  SkinPoint<double> g = {};
  for (int k = 0; k < 3; k++) {
    const SkinPoint<double> b = load_rows<double>(normal, &mine.across[k], 1, unused);
    g = g + slope<double, false, true>(law, &mine.type[k], 1, dot(a, b)) * b;
  }

  const SkinPoint<double> h = turn(g, a, inverse), o = load<double>(x, &mine.corner[0], 1);
  return {cross(h, load<double>(x, &mine.corner[2], 1) - o),
          cross(load<double>(x, &mine.corner[1], 1) - o, h)};
}

/* ---------------------------------------------------------------------- */

double LAMMPS_NS::skin_cosine(const SkinTriangles &triangles, int t, int corner,
                              const double *normal)
{
  double unused;
  return dot(load_rows<double>(normal, &t, 1, unused),
             load_rows<double>(normal, &triangles.all[t].across[corner], 1, unused));
}
