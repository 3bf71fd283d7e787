// What all ranks say, in the order of ranks.

#ifndef LMP_SKIN_GATHER_H
#define LMP_SKIN_GATHER_H

#include <mpi.h>
#include <type_traits>
#include <vector>

namespace LAMMPS_NS {

template <class T> std::vector<T> skin_gather(const std::vector<T> &mine, MPI_Comm world)
{
  static_assert(std::is_trivially_copyable<T>::value, "they are sent as bytes");
  int nprocs;
  MPI_Comm_size(world, &nprocs);

  const int nbytes = (int) (mine.size() * sizeof(T));
  std::vector<int> counts(nprocs), offsets(nprocs + 1, 0);
  MPI_Allgather(&nbytes, 1, MPI_INT, counts.data(), 1, MPI_INT, world);
  for (int p = 0; p < nprocs; p++) offsets[p + 1] = offsets[p] + counts[p];

  std::vector<T> all(offsets[nprocs] / sizeof(T));
  if (all.empty()) return all;
  MPI_Allgatherv(mine.data(), nbytes, MPI_BYTE, all.data(), counts.data(), offsets.data(),
                 MPI_BYTE, world);
  return all;
}

}    // namespace LAMMPS_NS

#endif
