// state and settings with which cells cannot be, in fix skin/cells

#include "fix_skin_cells.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "neighbor.h"

#include <algorithm>
#include <cmath>
#include <utility>

using namespace LAMMPS_NS;

static const char *const KIND_NAMES[] = {"none", "stem", "ta", "exhausted", "nd"};

/* ----------------------------------------------------------------------
   what a cell says of itself
------------------------------------------------------------------------- */

void FixSkinCells::check_cell(int i) const
{
  const int kind = kind_of(i);
  const int m = state.divisions_left[i];
  if (kind == NONE) return;

  if ((kind == TA && m <= 0) || (kind == EXHAUSTED && m != 0) || m < 0)
    error->one(FLERR, "Fix skin/cells: cell {} is of kind {} and has {} divisions left",
               atom->tag[i], KIND_NAMES[kind], m);
  if (state.pair[i] == atom->tag[i] || state.pair[i] < 0 || state.pair[i] > atom->map_tag_max)
    error->one(FLERR, "Fix skin/cells: cell {} is paired with {}, which is no other cell",
               atom->tag[i], state.pair[i]);

  if (state.parent[i] == atom->tag[i])
    error->one(FLERR, "Fix skin/cells: parent = {} of cell {} must be another cell, or 0 for none",
               state.parent[i], atom->tag[i]);
  for (const auto &[name, value] : {std::pair{"divisions_done", state.divisions_done[i]},
                                    std::pair{"parent", state.parent[i]}})
    if (value < 0)
      error->one(FLERR, "Fix skin/cells: {} = {} of cell {} must be >= 0", name, value,
                 atom->tag[i]);
  for (const auto &[name, value] : {std::pair{"next_division", state.next_division[i]},
                                    std::pair{"birth_time", state.birth_time[i]},
                                    std::pair{"pair_start", state.pair_start[i]},
                                    std::pair{"detached_time", state.detached_time[i]}})
    if (!std::isfinite(value))
      error->one(FLERR, "Fix skin/cells: {} = {} of cell {} must be finite", name, value,
                 atom->tag[i]);
}

/* ----------------------------------------------------------------------
   both cells of a dividing pair name each other, on whatever ranks they are
------------------------------------------------------------------------- */

void FixSkinCells::check_pairs() const
{
  std::vector<tagint> mine;
  for (int i = 0; i < atom->nlocal; i++)
    if (kind_of(i) != NONE && state.pair[i]) {
      mine.push_back(atom->tag[i]);
      mine.push_back(state.pair[i]);
    }

  int n = (int) mine.size();
  std::vector<int> counts(comm->nprocs), offsets(comm->nprocs + 1, 0);
  MPI_Allgather(&n, 1, MPI_INT, counts.data(), 1, MPI_INT, world);
  for (int p = 0; p < comm->nprocs; p++) offsets[p + 1] = offsets[p] + counts[p];
  std::vector<tagint> told(offsets[comm->nprocs]);
  MPI_Allgatherv(mine.data(), n, MPI_LMP_TAGINT, told.data(), counts.data(), offsets.data(),
                 MPI_LMP_TAGINT, world);

  std::vector<std::pair<tagint, tagint>> all;
  for (size_t k = 0; k < told.size(); k += 2) all.emplace_back(told[k], told[k + 1]);
  std::sort(all.begin(), all.end());
  for (const auto &[id, other] : all)
    if (!std::binary_search(all.begin(), all.end(), std::pair(other, id)))
      error->all(FLERR, "Fix skin/cells: cell {} is paired with {}, which is no cell that is "
                 "paired with it", id, other);
}

/* ----------------------------------------------------------------------
   ghost particles must reach far enough to hold the nearest membrane particle of any cell
   that is not yet detached, now and until the next neighbor build
------------------------------------------------------------------------- */

void FixSkinCells::check_reach() const
{
  const double reach = adhesion_range * contact + 2.0 * neighbor->skin;
  const double cutoff = std::min({comm->cutghost[0], comm->cutghost[1], comm->cutghost[2]});
  if (cutoff < reach)
    error->all(FLERR, "Fix skin/cells needs a communication cutoff of at least {} but has {}: use "
               "comm_modify cutoff", reach, cutoff);
}
