/* Counts what a rank sends, for LD_PRELOAD: see scaling.py. A line for each rank at its end:
   rank, messages, their bytes, collective calls, seconds in MPI. */

#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>

static double messages, bytes, collectives, seconds;

static void sent(int count, MPI_Datatype type)
{
  int size;
  PMPI_Type_size(type, &size);
  messages += 1;
  bytes += (double) count * size;
}

#define TIMED(call)                    \
  double began = PMPI_Wtime();         \
  int status = call;                   \
  seconds += PMPI_Wtime() - began;     \
  return status

int MPI_Send(const void *buf, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm)
{
  sent(n, type);
  TIMED(PMPI_Send(buf, n, type, to, tag, comm));
}

int MPI_Rsend(const void *buf, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm)
{
  sent(n, type);
  TIMED(PMPI_Rsend(buf, n, type, to, tag, comm));
}

int MPI_Isend(const void *buf, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm,
              MPI_Request *request)
{
  sent(n, type);
  TIMED(PMPI_Isend(buf, n, type, to, tag, comm, request));
}

int MPI_Sendrecv(const void *buf, int n, MPI_Datatype type, int to, int tag, void *other, int m,
                 MPI_Datatype other_type, int from, int other_tag, MPI_Comm comm, MPI_Status *s)
{
  sent(n, type);
  TIMED(PMPI_Sendrecv(buf, n, type, to, tag, other, m, other_type, from, other_tag, comm, s));
}

int MPI_Recv(void *buf, int n, MPI_Datatype type, int from, int tag, MPI_Comm comm, MPI_Status *s)
{
  TIMED(PMPI_Recv(buf, n, type, from, tag, comm, s));
}

int MPI_Wait(MPI_Request *request, MPI_Status *s)
{
  TIMED(PMPI_Wait(request, s));
}

int MPI_Waitany(int n, MPI_Request requests[], int *index, MPI_Status *s)
{
  TIMED(PMPI_Waitany(n, requests, index, s));
}

int MPI_Waitall(int n, MPI_Request requests[], MPI_Status s[])
{
  TIMED(PMPI_Waitall(n, requests, s));
}

int MPI_Barrier(MPI_Comm comm)
{
  TIMED(PMPI_Barrier(comm));
}

int MPI_Allreduce(const void *buf, void *all, int n, MPI_Datatype type, MPI_Op op, MPI_Comm comm)
{
  collectives += 1;
  TIMED(PMPI_Allreduce(buf, all, n, type, op, comm));
}

int MPI_Allgather(const void *buf, int n, MPI_Datatype type, void *all, int m,
                  MPI_Datatype all_type, MPI_Comm comm)
{
  collectives += 1;
  TIMED(PMPI_Allgather(buf, n, type, all, m, all_type, comm));
}

int MPI_Allgatherv(const void *buf, int n, MPI_Datatype type, void *all, const int counts[],
                   const int places[], MPI_Datatype all_type, MPI_Comm comm)
{
  collectives += 1;
  TIMED(PMPI_Allgatherv(buf, n, type, all, counts, places, all_type, comm));
}

int MPI_Bcast(void *buf, int n, MPI_Datatype type, int root, MPI_Comm comm)
{
  collectives += 1;
  TIMED(PMPI_Bcast(buf, n, type, root, comm));
}

int MPI_Finalize(void)
{
  int rank;
  PMPI_Comm_rank(MPI_COMM_WORLD, &rank);
  char name[4096];
  snprintf(name, sizeof(name), "%s.%d", getenv("SKIN_MPI_COUNT"), rank);
  FILE *file = fopen(name, "w");
  if (file) {
    fprintf(file, "%d %.0f %.0f %.0f %.6f\n", rank, messages, bytes, collectives, seconds);
    fclose(file);
  }
  return PMPI_Finalize();
}
