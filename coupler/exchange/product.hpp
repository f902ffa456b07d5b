// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <vector>

#include "coupler/exchange/transfer.hpp"

namespace couplet::coupler {

/// Entries of the map that does `first` and then `second`, where the targets of the one are the sources of the
/// other, cut over the ranks as `between` says. Entries may be on any rank; those of the product are on the rank that has
/// those of `second`, each pair once there: row by row, so that no rank holds more than its rows of both maps and of the
/// product. Collective.
std::vector<Transfer::Entry> product(MPI_Comm comm, const coupling::Starts& between,
                                     const std::vector<Transfer::Entry>& second,
                                     const std::vector<Transfer::Entry>& first);

}  // namespace couplet::coupler
