#include "skin_contacts.h"

#include "skin_margins.h"

#include "atom.h"
#include "domain.h"
#include "group.h"
#include "neighbor.h"

#include <algorithm>
#include <tuple>

using namespace LAMMPS_NS;

// particles between one and that whose special neighbors are fetched meanwhile

static constexpr int AHEAD = 6;

/* ---------------------------------------------------------------------- */

void SkinContacts::set_kinds(const std::vector<int> &kind_of_types,
                             const std::vector<double> &distance)
{
  ntypes = atom->ntypes;
  kinds = kind_of_types;
  distances = distance;
  choose_centers();
  one_kind = all_of_one_kind();
  regroup();
}

/* ---------------------------------------------------------------------- */

void SkinContacts::regroup()
{
  std::vector<std::vector<SkinAtomPair>> listed(distances.size());
  std::swap(listed, of_kind);
  for (const std::vector<SkinAtomPair> &pairs : listed)
    for (const SkinAtomPair &pair : pairs) {
      const int kind = kinds[atom->type[pair[0]] * (ntypes + 1) + atom->type[pair[1]]];
      if (kind >= 0) of_kind[kind].push_back(pair);
    }
}

/* ---------------------------------------------------------------------- */

void SkinContacts::clear()
{
  for (std::vector<SkinAtomPair> &pairs : of_kind) pairs.clear();
}

/* ----------------------------------------------------------------------
   all types on both sides; or, where no type would be on both, the side of which there are fewer
   particles in the middle
------------------------------------------------------------------------- */

void SkinContacts::choose_centers()
{
  std::vector<char> lower(ntypes + 1, 0), upper(ntypes + 1, 0);
  for (int a = 1; a <= ntypes; a++)
    for (int b = a; b <= ntypes; b++)
      if (kinds[a * (ntypes + 1) + b] >= 0) lower[a] = upper[b] = 1;

  bigint mine[2] = {0, 0}, all[2];
  for (int i = 0; i < atom->nlocal; i++) {
    mine[0] += lower[atom->type[i]];
    mine[1] += upper[atom->type[i]];
  }
  MPI_Allreduce(mine, all, 2, MPI_LMP_BIGINT, MPI_SUM, world);

  one_way = true;
  for (int a = 1; a <= ntypes; a++) one_way = one_way && !(lower[a] && upper[a]);
  centers = lower;
  partners = upper;
  if (one_way && all[1] < all[0]) std::swap(centers, partners);
  if (one_way) return;
  for (int a = 1; a <= ntypes; a++) centers[a] = partners[a] = lower[a] || upper[a];
}

/* ---------------------------------------------------------------------- */

bool SkinContacts::all_of_one_kind() const
{
  for (int a = 1; a <= ntypes; a++)
    for (int b = 1; b <= ntypes; b++)
      if (centers[a] && partners[b] && kinds[a * (ntypes + 1) + b] != 0) return false;
  return true;
}

/* ----------------------------------------------------------------------
   list the pairs for the atom order of this neighbor build
------------------------------------------------------------------------- */

void SkinContacts::build()
{
  clear();
  if (of_kind.empty()) return;

  const std::vector<double> margins = skin_margins(lmp);
  radii.assign(distances.size(), 0.0);
  for (int a = 1; a <= ntypes; a++)
    for (int b = 1; b <= ntypes; b++) {
      const int kind = kinds[a * (ntypes + 1) + b];
      if (kind < 0) continue;
      radii[kind] = std::max(radii[kind], distances[kind] + margins[a] + margins[b]);
    }
  const double furthest = *std::max_element(radii.begin(), radii.end());
  all_nearest = !domain->triclinic;
  for (int d = 0; d < 3; d++)
    all_nearest = all_nearest && (!domain->periodicity[d] || furthest < 0.5 * domain->prd[d]);

  columns.sort(atom, partners);
  if (one_way) center_columns.sort(atom, centers);
  const SkinColumns &all = one_way ? center_columns : columns;
  for (int c = 0; c + 1 < (int) all.first.size(); c++)
    if (all.first[c] < all.first[c + 1]) add_column(all, c, furthest);
}

/* ----------------------------------------------------------------------
   pairs of my particles in one column
------------------------------------------------------------------------- */

void SkinContacts::add_column(const SkinColumns &all, int c, double furthest)
{
  const int begin = all.first[c], end = all.first[c + 1];
  double lo[3], hi[3];
  for (int d = 0; d < 3; d++) {
    const double *const x = all.x[d].data();
    const auto [least, most] = std::minmax_element(x + begin, x + end);
    lo[d] = *least;
    hi[d] = *most;
  }
  // a pair of two particles of one set is found at the one that is first in the order of columns

  columns.around(lo, hi, furthest, near, one_way ? 0 : c);

  for (int n = begin; n < end; n++) {
    const int i = all.index[n], later = all.index[std::min(n + AHEAD, (int) all.index.size() - 1)];
    if (atom->nspecial && later < atom->nlocal) {
      __builtin_prefetch(atom->nspecial[later]);
      __builtin_prefetch(atom->special[later]);
    }
    if (one_way && i >= atom->nlocal) continue;
    const double point[3] = {all.x[0][n], all.x[1][n], all.x[2][n]};
    const auto [first, last] = near.within(point, furthest, one_way ? 0 : n - begin + 1);
    const int *const row = &kinds[atom->type[i] * (ntypes + 1)];

    // a ghost has no list of special neighbors; who has none sees all

    const bool owned = i < atom->nlocal;
    const bool sees_all = owned && !neighbor->exclude && !neighbor->includegroup &&
        (!atom->nspecial || atom->nspecial[i][0] == 0);
    if (one_way && one_kind && sees_all) {
      for (const int *k = first; k < last; k++) of_kind[0].push_back({i, near.index[*k]});
      continue;
    }
    for (const int *k = first; k < last; k++) {
      const int j = near.index[*k];
      if (!one_way && !mine(i, j)) continue;
      const int kind = one_kind ? 0 : row[atom->type[j]];
      if (kind < 0 || near.distsq[*k] > radii[kind] * radii[kind]) continue;
      const SkinAtomPair pair = {owned ? i : j, owned ? j : i};
      if (sees_all || !hidden(pair[0], pair[1])) of_kind[kind].push_back(pair);
    }
  }
}

/* ----------------------------------------------------------------------
   a pair that two ranks find, or one rank twice, is that of the rank or image that owns the one of
   lower ID, if both IDs are of one parity, and else the one of higher ID, as if by lot; of the two
   images of a particle on opposite sides of it, it has the upper one
------------------------------------------------------------------------- */

bool SkinContacts::mine(int i, int j) const
{
  const int nlocal = atom->nlocal;
  if (i < nlocal && j < nlocal) return true;
  if (i >= nlocal && j >= nlocal) return false;
  const tagint owned = atom->tag[std::min(i, j)], ghost = atom->tag[std::max(i, j)];
  if (owned == ghost) return above(std::max(i, j), std::min(i, j));
  return (owned < ghost) == (((owned ^ ghost) & 1) == 0);
}

/* ---------------------------------------------------------------------- */

bool SkinContacts::above(int i, int j) const
{
  const double *const x = atom->x[i], *const y = atom->x[j];
  return std::tie(x[2], x[1], x[0]) > std::tie(y[2], y[1], y[0]);
}

/* ----------------------------------------------------------------------
   pairs that LAMMPS leaves out of its lists, too: special neighbors, and what neigh_modify include
   and exclude say
------------------------------------------------------------------------- */

bool SkinContacts::hidden(int i, int j) const
{
  const int n = atom->nspecial ? atom->nspecial[i][0] : 0;
  const tagint *const special = n ? atom->special[i] : nullptr;

  // all are looked at, since it could not be foreseen which is the one

  bool found = false;
  for (int k = 0; k < n; k++) found |= special[k] == atom->tag[j];
  if (found) {
    if (all_nearest) return true;
    const double *const x = atom->x[i], *const y = atom->x[j];
    if (!domain->minimum_image_check(x[0] - y[0], x[1] - y[1], x[2] - y[2])) return true;
  }
  if (neighbor->includegroup) {
    const int bit = group->bitmask[neighbor->includegroup];
    if (!(atom->mask[i] & atom->mask[j] & bit)) return true;
  }
  return neighbor->exclude && excluded(i, j);
}

/* ----------------------------------------------------------------------
   neigh_modify exclude
------------------------------------------------------------------------- */

bool SkinContacts::excluded(int i, int j) const
{
  const int *const mask = atom->mask;
  if (neighbor->nex_type && neighbor->ex_type[atom->type[i]][atom->type[j]]) return true;
  for (int m = 0; m < neighbor->nex_group; m++) {
    const int one = neighbor->ex1_bit[m], two = neighbor->ex2_bit[m];
    if (((mask[i] & one) && (mask[j] & two)) || ((mask[i] & two) && (mask[j] & one))) return true;
  }
  for (int m = 0; m < neighbor->nex_mol; m++) {
    const int bit = neighbor->ex_mol_bit[m];
    const bool same = atom->molecule[i] == atom->molecule[j];
    if ((mask[i] & bit) && (mask[j] & bit) && same == (neighbor->ex_mol_intra[m] == 1))
      return true;
  }
  return false;
}

/* ---------------------------------------------------------------------- */

double SkinContacts::memory_usage() const
{
  double bytes = columns.memory_usage() + center_columns.memory_usage() + near.memory_usage();
  for (const std::vector<SkinAtomPair> &pairs : of_kind)
    bytes += (double) pairs.capacity() * sizeof(SkinAtomPair);
  return bytes;
}
