#include "skin_inverted.h"

#include "skin_bend_forces.h"

#include "atom.h"
#include "comm.h"

#include <algorithm>

using namespace LAMMPS_NS;

/* ----------------------------------------------------------------------
   what is inverted by the links of one list may not be so by those of another
------------------------------------------------------------------------- */

bool SkinInverted::find(const SkinTriangles &triangles, const double *normal, bool whole)
{
  look(triangles, normal, whole);
  if (!gather()) return false;

  const size_t n = doubtful.size();
  std::vector<double> mine(n, -1.0), all(n);
  for (const Known &here : known) {
    const auto at = std::lower_bound(doubtful.begin(), doubtful.end(), here.corner);
    if (at == doubtful.end() || *at != here.corner) continue;
    double &most = mine[at - doubtful.begin()];
    most = std::max(most, here.cosine);
  }
  MPI_Allreduce(mine.data(), all.data(), (int) n, MPI_DOUBLE, MPI_MAX, world);

  for (size_t k = 0; k < n; k++) {
    if (!(all[k] < least)) continue;
    corner = doubtful[k];
    cosine = all[k];
    return true;
  }
  return false;
}

/* ----------------------------------------------------------------------
   smallest folds of my triangles that are in other lists, too, and of all if one may be inverted
------------------------------------------------------------------------- */

void SkinInverted::look(const SkinTriangles &triangles, const double *normal, bool whole)
{
  known.clear();
  const auto note = [&](int t) {
    const SkinTriangle &mine = triangles.all[t];
    double most = -1.0;
    for (int k = 0; k < 3; k++)
      if (mine.across[k] != t) most = std::max(most, skin_cosine(triangles, t, k, normal));
    Corners tags;
    for (int k = 0; k < 3; k++) tags[k] = atom->tag[mine.corner[k]];
    std::sort(tags.begin(), tags.end());
    known.push_back({tags, most});
  };
  if (whole)
    for (int t = 0; t < (int) triangles.all.size(); t++) note(t);
  else
    for (const int t : triangles.partial) note(t);
}

/* ----------------------------------------------------------------------
   triangles that are inverted by the links of some list; false if there are none
------------------------------------------------------------------------- */

bool SkinInverted::gather()
{
  doubtful.clear();
  for (const Known &here : known)
    if (here.cosine < least) doubtful.push_back(here.corner);

  int mine = 3 * (int) doubtful.size(), all = 0;
  MPI_Allreduce(&mine, &all, 1, MPI_INT, MPI_SUM, world);
  if (all == 0) return false;

  std::vector<int> counts(comm->nprocs), displs(comm->nprocs, 0);
  MPI_Allgather(&mine, 1, MPI_INT, counts.data(), 1, MPI_INT, world);
  for (int n = 1; n < comm->nprocs; n++) displs[n] = displs[n - 1] + counts[n - 1];
  std::vector<Corners> found(all / 3);
  MPI_Allgatherv(doubtful.data(), mine, MPI_LMP_TAGINT, found.data(), counts.data(),
                 displs.data(), MPI_LMP_TAGINT, world);
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  doubtful = found;
  return true;
}
