// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

namespace couplet {

inline const MPI_Comm world = MPI_COMM_WORLD;

}  // namespace couplet
