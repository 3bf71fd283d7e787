#include "skin_inverted.h"

#include "skin_bend_forces.h"
#include "skin_gather.h"

#include "atom.h"

#include <algorithm>

using namespace LAMMPS_NS;

/* ----------------------------------------------------------------------
   what is inverted by the links of one list may not be so by those of another
------------------------------------------------------------------------- */

bool SkinInverted::find(const SkinTriangles &triangles, const double *normal, bool whole)
{
  measure(triangles, normal, whole);
  if (!collect()) return false;

  const size_t n = candidates.size();
  std::vector<double> mine(n, -1.0), all(n);
  for (const Known &here : folds) {
    const auto at = std::lower_bound(candidates.begin(), candidates.end(), here.corner);
    if (at == candidates.end() || *at != here.corner) continue;
    double &most = mine[at - candidates.begin()];
    most = std::max(most, here.cosine);
  }
  MPI_Allreduce(mine.data(), all.data(), (int) n, MPI_DOUBLE, MPI_MAX, world);

  for (size_t k = 0; k < n; k++) {
    if (!(all[k] < least)) continue;
    corner = candidates[k];
    cosine = all[k];
    return true;
  }
  return false;
}

/* ----------------------------------------------------------------------
   smallest folds of my triangles that are in other lists, too, and of all if one may be inverted
------------------------------------------------------------------------- */

void SkinInverted::measure(const SkinTriangles &triangles, const double *normal, bool whole)
{
  folds.clear();
  const auto note = [&](int t) {
    const SkinTriangle &mine = triangles.all[t];
    double most = -1.0;
    for (int k = 0; k < 3; k++)
      if (mine.bends(k, t)) most = std::max(most, skin_cosine(triangles, t, k, normal));
    Corners tags;
    for (int k = 0; k < 3; k++) tags[k] = atom->tag[mine.corner[k]];
    std::sort(tags.begin(), tags.end());
    folds.push_back({tags, most});
  };
  if (whole)
    for (int t = 0; t < (int) triangles.all.size(); t++) note(t);
  else
    for (const int t : triangles.partial) note(t);
}

/* ----------------------------------------------------------------------
   triangles that are inverted by the links of some list; false if there are none
------------------------------------------------------------------------- */

bool SkinInverted::collect()
{
  candidates.clear();
  for (const Known &here : folds)
    if (here.cosine < least) candidates.push_back(here.corner);

  std::vector<Corners> found = skin_gather(candidates, world);
  if (found.empty()) return false;

  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  candidates = std::move(found);
  return true;
}
