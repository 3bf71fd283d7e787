// Vectors in space of one particle, or of four at a time: T is double or SkinDouble4, which
// holds one number of each of the four and becomes the instructions that SKIN_VECTOR chooses.
// Indices of the four lie stride apart.

#ifndef LMP_SKIN_DOUBLE4_H
#define LMP_SKIN_DOUBLE4_H

#include <cmath>

// everything here is inlined: no vector is handed to a function

#pragma GCC diagnostic ignored "-Wpsabi"
#define SKIN_INLINE static inline __attribute__((always_inline))
#define SKIN_METHOD inline __attribute__((always_inline))

namespace LAMMPS_NS {

typedef double SkinDouble2 __attribute__((vector_size(16)));
typedef double SkinDouble4 __attribute__((vector_size(32)));
typedef double SkinDouble2InMemory __attribute__((vector_size(16), aligned(8), may_alias));
typedef double SkinDouble4InMemory __attribute__((vector_size(32), aligned(8), may_alias));

template <class T> struct SkinPoint {
  T x, y, z;
};

// NOLINTNEXTLINE(bugprone-sizeof-expression): T may be double itself
template <class T> constexpr int skin_width = sizeof(T) / sizeof(double);

/* ---------------------------------------------------------------------- */

template <class T>
SKIN_INLINE SkinPoint<T> operator+(const SkinPoint<T> &a, const SkinPoint<T> &b)
{
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}

template <class T>
SKIN_INLINE SkinPoint<T> operator-(const SkinPoint<T> &a, const SkinPoint<T> &b)
{
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

template <class T> SKIN_INLINE SkinPoint<T> operator*(const T &a, const SkinPoint<T> &b)
{
  return {a * b.x, a * b.y, a * b.z};
}

template <class T> SKIN_INLINE T dot(const SkinPoint<T> &a, const SkinPoint<T> &b)
{
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class T>
SKIN_INLINE SkinPoint<T> cross(const SkinPoint<T> &a, const SkinPoint<T> &b)
{
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/* ---------------------------------------------------------------------- */

SKIN_INLINE double root(double a)
{
  return std::sqrt(a);
}

SKIN_INLINE SkinDouble4 root(const SkinDouble4 &a)
{
  SkinDouble4 roots;
  for (int k = 0; k < 4; k++) roots[k] = std::sqrt(a[k]);
  return roots;
}

template <class T> SKIN_INLINE T larger(const T &a, const T &b)
{
  return a < b ? b : a;
}

template <class T> SKIN_INLINE T smaller(const T &a, const T &b)
{
  return b < a ? b : a;
}

SKIN_INLINE double sum(double a)
{
  return a;
}

SKIN_INLINE double sum(const SkinDouble4 &a)
{
  return a[0] + a[1] + a[2] + a[3];
}

SKIN_INLINE SkinPoint<double> sum(const SkinPoint<SkinDouble4> &p)
{
  return {sum(p.x), sum(p.y), sum(p.z)};
}

/* ----------------------------------------------------------------------
   numbers of a followed by those of b, in this order
------------------------------------------------------------------------- */

#if defined(__clang__) || __GNUC__ >= 12
template <int... ORDER, class V> SKIN_INLINE SkinDouble4 shuffle4(const V &a, const V &b)
{
  return __builtin_shufflevector(a, b, ORDER...);
}

template <int... ORDER> SKIN_INLINE SkinDouble2 shuffle2(const SkinDouble4 &a)
{
  return __builtin_shufflevector(a, a, ORDER...);
}
#else
template <int... ORDER, class V> SKIN_INLINE SkinDouble4 shuffle4(const V &a, const V &b)
{
  constexpr int n = skin_width<V>;
  return SkinDouble4{(ORDER < n ? a[ORDER % n] : b[ORDER % n])...};
}

template <int... ORDER> SKIN_INLINE SkinDouble2 shuffle2(const SkinDouble4 &a)
{
  return SkinDouble2{a[ORDER]...};
}
#endif

/* ----------------------------------------------------------------------
   vectors that are stored three by three
------------------------------------------------------------------------- */

template <class T> SKIN_INLINE SkinPoint<T> load(const double *all, const int *i, int stride)
{
  const double *a = all + 3L * i[0];
  if constexpr (skin_width<T> == 1) {
    return {a[0], a[1], a[2]};
  } else {
    // NOLINTNEXTLINE(clang-analyzer-security.ArrayBound): i goes on in the next of four structures
    const double *b = all + 3L * i[stride];
    const double *c = all + 3L * i[2 * stride], *d = all + 3L * i[3 * stride];
    const SkinDouble2 axy = *(const SkinDouble2InMemory *) a;
    const SkinDouble2 bxy = *(const SkinDouble2InMemory *) b;
    const SkinDouble2 cxy = *(const SkinDouble2InMemory *) c;
    const SkinDouble2 dxy = *(const SkinDouble2InMemory *) d;
    const SkinDouble4 ac = shuffle4<0, 1, 2, 3>(axy, cxy), bd = shuffle4<0, 1, 2, 3>(bxy, dxy);
    const SkinDouble2 abz = {a[2], b[2]}, cdz = {c[2], d[2]};
    return {shuffle4<0, 4, 2, 6>(ac, bd), shuffle4<1, 5, 3, 7>(ac, bd),
            shuffle4<0, 1, 2, 3>(abz, cdz)};
  }
}

// the same vector four times

SKIN_INLINE SkinPoint<SkinDouble4> spread(const SkinPoint<double> &p)
{
  const SkinDouble4 zero = {};
  return {zero + p.x, zero + p.y, zero + p.z};
}

// ask for a vector from memory, some time before it is needed

SKIN_INLINE void fetch(const double *all, int i)
{
  __builtin_prefetch(all + 3L * i);
}

SKIN_INLINE void add(double *all, const int *i, int, const SkinPoint<double> &p)
{
  double *a = all + 3L * i[0];
  a[0] += p.x;
  a[1] += p.y;
  a[2] += p.z;
}

SKIN_INLINE void add(double *all, const int *i, int stride, const SkinPoint<SkinDouble4> &p)
{
  const SkinDouble4 ac = shuffle4<0, 4, 2, 6>(p.x, p.y), bd = shuffle4<1, 5, 3, 7>(p.x, p.y);
  const SkinDouble2 xy[] = {shuffle2<0, 1>(ac), shuffle2<0, 1>(bd), shuffle2<2, 3>(ac),
                            shuffle2<2, 3>(bd)};
  for (int k = 0; k < 4; k++) {
    double *a = all + 3L * i[k * stride];
    *(SkinDouble2InMemory *) a += xy[k];
    a[2] += p.z[k];
  }
}

/* ----------------------------------------------------------------------
   numbers that are stored one after the other
------------------------------------------------------------------------- */

template <class T> SKIN_INLINE T load_row(const double *row)
{
  if constexpr (skin_width<T> == 1) return row[0];
  else return *(const SkinDouble4InMemory *) row;
}

SKIN_INLINE void store_row(double *row, double a)
{
  row[0] = a;
}

SKIN_INLINE void store_row(double *row, const SkinDouble4 &a)
{
  *(SkinDouble4InMemory *) row = a;
}

/* ----------------------------------------------------------------------
   vectors and a number with each, stored four by four
------------------------------------------------------------------------- */

template <class T>
SKIN_INLINE SkinPoint<T> load_rows(const double *all, const int *i, int stride, T &w)
{
  if constexpr (skin_width<T> == 1) {
    const double *a = all + 4L * i[0];
    w = a[3];
    return {a[0], a[1], a[2]};
  } else {
    SkinDouble2 xy[4], zw[4];
    for (int k = 0; k < 4; k++) {
      // NOLINTNEXTLINE(clang-analyzer-security.ArrayBound): the same
      const SkinDouble2InMemory *a = (const SkinDouble2InMemory *) (all + 4L * i[k * stride]);
      xy[k] = a[0];
      zw[k] = a[1];
    }
    const SkinDouble4 acxy = shuffle4<0, 1, 2, 3>(xy[0], xy[2]);
    const SkinDouble4 bdxy = shuffle4<0, 1, 2, 3>(xy[1], xy[3]);
    const SkinDouble4 aczw = shuffle4<0, 1, 2, 3>(zw[0], zw[2]);
    const SkinDouble4 bdzw = shuffle4<0, 1, 2, 3>(zw[1], zw[3]);
    w = shuffle4<1, 5, 3, 7>(aczw, bdzw);
    return {shuffle4<0, 4, 2, 6>(acxy, bdxy), shuffle4<1, 5, 3, 7>(acxy, bdxy),
            shuffle4<0, 4, 2, 6>(aczw, bdzw)};
  }
}

SKIN_INLINE void fetch_row(const double *all, int i)
{
  __builtin_prefetch(all + 4L * i);
}

SKIN_INLINE void store_rows(double *rows, const SkinPoint<double> &p, double w)
{
  rows[0] = p.x;
  rows[1] = p.y;
  rows[2] = p.z;
  rows[3] = w;
}

SKIN_INLINE void store_rows(double *rows, const SkinPoint<SkinDouble4> &p, const SkinDouble4 &w)
{
  const SkinDouble4 acxy = shuffle4<0, 4, 2, 6>(p.x, p.y), bdxy = shuffle4<1, 5, 3, 7>(p.x, p.y);
  const SkinDouble4 aczw = shuffle4<0, 4, 2, 6>(p.z, w), bdzw = shuffle4<1, 5, 3, 7>(p.z, w);
  SkinDouble2InMemory *to = (SkinDouble2InMemory *) rows;
  to[0] = shuffle2<0, 1>(acxy);
  to[1] = shuffle2<0, 1>(aczw);
  to[2] = shuffle2<0, 1>(bdxy);
  to[3] = shuffle2<0, 1>(bdzw);
  to[4] = shuffle2<2, 3>(acxy);
  to[5] = shuffle2<2, 3>(aczw);
  to[6] = shuffle2<2, 3>(bdxy);
  to[7] = shuffle2<2, 3>(bdzw);
}

}    // namespace LAMMPS_NS

#endif
