// SPDX-License-Identifier: Apache-2.0
// What is known of this program: rank 0 sends `n` times three messages of 5 doubles to rank 1 (one of them persistent), all call `n`
// times two sums and once a broadcast; with a second argument also `n` gathers.
#include <mpi.h>

#include <cstdlib>

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  int rank, size;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  double data[5] = {}, sum[5], all[500];
  MPI_Request later = MPI_REQUEST_NULL, flying = MPI_REQUEST_NULL;
  if (rank == 0) MPI_Send_init(data, 5, MPI_DOUBLE, 1, 0, MPI_COMM_WORLD, &later);
  MPI_Bcast(data, 5, MPI_DOUBLE, 0, MPI_COMM_WORLD);
  for (int i = 0; i < std::atoi(argv[1]); ++i) {
    if (rank == 0) {
      MPI_Send(data, 5, MPI_DOUBLE, 1, 0, MPI_COMM_WORLD);
      MPI_Isend(data, 5, MPI_DOUBLE, 1, 0, MPI_COMM_WORLD, &flying);
      MPI_Wait(&flying, MPI_STATUS_IGNORE);
      MPI_Start(&later);
      MPI_Wait(&later, MPI_STATUS_IGNORE);
    }
    for (int k = 0; rank == 1 && k < 3; ++k)
      MPI_Recv(sum, 5, MPI_DOUBLE, 0, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    for (int k = 0; k < 2; ++k) MPI_Allreduce(data, sum, 5, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
    MPI_Allreduce(data, sum, 5, MPI_DOUBLE, MPI_SUM, MPI_COMM_SELF);
    if (argc > 2) MPI_Gather(data, 5, MPI_DOUBLE, all, 5, MPI_DOUBLE, 0, MPI_COMM_WORLD);
  }
  if (rank == 0) MPI_Request_free(&later);
  MPI_Finalize();
}
