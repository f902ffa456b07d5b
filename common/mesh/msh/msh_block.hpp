// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

#include "common/mesh/distributed/mesh_block.hpp"

namespace couplet::mesh {

/// This rank's block of a .msh file of version 4.1 (ASCII or binary): every rank reads the file by itself through a window and
/// keeps its share, so that none holds the whole. The block is that of read_msh(), see block_of(). None, on all ranks, for
/// what only read_msh() reads or can explain: version 2.2, nodes numbered at random, a damaged file. Collective.
std::optional<MeshBlock> read_msh_block(MPI_Comm comm, const std::filesystem::path& file);

}  // namespace couplet::mesh
