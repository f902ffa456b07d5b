// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <vector>

#include "common/coupling/participant.hpp"
#include "coupler/exchange/transfer.hpp"
#include "coupler/parameters/parameters.hpp"

namespace couplet::coupler {

/// From values at the faces of `structure` to those at the vertices of `surface`: at each vertex the mean of the
/// structure's field, linear over each of its faces, weighted by the function that is biorthogonal to the corner
/// functions of `surface` on each of its faces (dual Lagrange multipliers, Wohlmuth 2000). Linear fields are exact,
/// and the transpose makes a uniform traction of a uniform one. Both: this rank's parts, with corners. Collective.
std::vector<Transfer::Entry> faces_to_vertices(MPI_Comm comm, const coupling::Interface& structure,
                                               const coupling::Interface& surface,
                                               MappingParameters::Type type);

/// The same to the means over the faces of `surface`: for amounts that no motion goes with.
std::vector<Transfer::Entry> faces_to_faces(MPI_Comm comm, const coupling::Interface& structure,
                                            const coupling::Interface& surface, MappingParameters::Type type);

}  // namespace couplet::coupler
