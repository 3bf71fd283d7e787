#include "skin_cell_events.h"

#include <algorithm>
#include <tuple>
#include <type_traits>

using namespace LAMMPS_NS;

static_assert(std::is_trivially_copyable<SkinCellEvent>::value, "events are sent as bytes");

/* ---------------------------------------------------------------------- */

bool SkinCellEvent::operator<(const SkinCellEvent &e) const
{
  return std::tie(time, kind, id) < std::tie(e.time, e.kind, e.id);
}

/* ---------------------------------------------------------------------- */

std::vector<SkinCellEvent> SkinCellEvent::gather(const std::vector<SkinCellEvent> &mine,
                                                 MPI_Comm world)
{
  int nprocs;
  MPI_Comm_size(world, &nprocs);

  int nbytes = (int) (mine.size() * sizeof(SkinCellEvent));
  std::vector<int> counts(nprocs), offsets(nprocs + 1, 0);
  MPI_Allgather(&nbytes, 1, MPI_INT, counts.data(), 1, MPI_INT, world);
  for (int p = 0; p < nprocs; p++) offsets[p + 1] = offsets[p] + counts[p];

  std::vector<SkinCellEvent> all(offsets[nprocs] / sizeof(SkinCellEvent));
  MPI_Allgatherv(mine.data(), nbytes, MPI_BYTE, all.data(), counts.data(), offsets.data(),
                 MPI_BYTE, world);
  std::sort(all.begin(), all.end());
  return all;
}
