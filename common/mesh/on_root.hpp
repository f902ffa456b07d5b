// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <algorithm>
#include <exception>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/mesh/mesh.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::mesh {

/// Runs `work` on rank 0; what it throws there is thrown on every rank (as Error, with the same text).
/// Collective.
template <class Work>
void on_root(MPI_Comm comm, Work&& work) {
  int failed = 0;
  std::string text;
  if (parallel::comm_rank(comm) == 0) {
    try {
      work();
    } catch (const std::exception& e) {
      failed = 1;
      text = e.what();
    }
  }
  MPI_Bcast(&failed, 1, MPI_INT, 0, comm);
  if (failed == 0) return;
  parallel::broadcast(comm, text);
  throw Error(text);
}

/// Runs `work` on every rank; what it throws on the lowest rank that throws is thrown on all. `work` must not use MPI.
/// Collective.
template <class Work>
void on_all(MPI_Comm comm, Work&& work) {
  int thrower = parallel::comm_size(comm);
  std::string text;
  try {
    work();
  } catch (const std::exception& e) {
    thrower = parallel::comm_rank(comm);
    text = e.what();
  }
  MPI_Allreduce(MPI_IN_PLACE, &thrower, 1, MPI_INT, MPI_MIN, comm);
  if (thrower == parallel::comm_size(comm)) return;
  parallel::broadcast(comm, text, thrower);
  throw Error(text);
}

/// Rank 0's values on every rank, in pieces that MPI's int counts can hold. Collective.
template <class T>
void broadcast(MPI_Comm comm, std::vector<T>& values) {
  GlobalIndex size = static_cast<GlobalIndex>(values.size());
  MPI_Bcast(&size, 1, MPI_INT64_T, 0, comm);
  values.resize(size);
  char* data = reinterpret_cast<char*>(values.data());
  const GlobalIndex bytes = size * GlobalIndex(sizeof(T)), piece = GlobalIndex(1) << 30;
  for (GlobalIndex at = 0; at < bytes; at += piece)
    MPI_Bcast(data + at, static_cast<int>(std::min(piece, bytes - at)), MPI_BYTE, 0, comm);
}

inline void broadcast(MPI_Comm comm, std::vector<std::string>& texts) {
  int size = static_cast<int>(texts.size());
  MPI_Bcast(&size, 1, MPI_INT, 0, comm);
  texts.resize(size);
  for (std::string& text : texts) parallel::broadcast(comm, text);
}

}  // namespace couplet::mesh
