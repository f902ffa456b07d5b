// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <vector>

#include "common/coupling/participant.hpp"
#include "coupler/exchange/transfer.hpp"
#include "coupler/parameters/parameters.hpp"

namespace couplet::coupler {

/// Map from faces of `structure` to vertices of `surface`. Each vertex takes the mean of the structure's
/// field, linear over each face, weighted by the function biorthogonal to the corner functions on each face
/// (dual Lagrange multipliers, Wohlmuth 2000). Exact for linear fields; the transpose maps a uniform traction
/// to a uniform one. Both: this rank's parts, with corners. Collective.
std::vector<Transfer::Entry> faces_to_vertices(MPI_Comm comm, const coupling::Interface& structure,
                                               const coupling::Interface& surface,
                                               MappingParameters::Type type);

/// Map to the means over the faces of `surface`, for amounts without a corresponding motion.
std::vector<Transfer::Entry> faces_to_faces(MPI_Comm comm, const coupling::Interface& structure,
                                            const coupling::Interface& surface, MappingParameters::Type type);

}  // namespace couplet::coupler
