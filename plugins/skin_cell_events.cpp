#include "skin_cell_events.h"

#include "skin_gather.h"

#include <algorithm>
#include <tuple>

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

bool SkinCellEvent::operator<(const SkinCellEvent &e) const
{
  return std::tie(time, kind, id) < std::tie(e.time, e.kind, e.id);
}

/* ---------------------------------------------------------------------- */

std::vector<SkinCellEvent> SkinCellEvent::gather(const std::vector<SkinCellEvent> &mine,
                                                 MPI_Comm world)
{
  std::vector<SkinCellEvent> all = skin_gather(mine, world);
  std::sort(all.begin(), all.end());
  return all;
}
