// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "common/mesh/distributed/mesh_block.hpp"

namespace couplet::mesh {

/// The points of a face, ascending; after the last one -1.
using FaceKey = std::array<GlobalIndex, 4>;

/// What is wrong with the faces that this rank has compared: told with their places, which other ranks may have.
struct FaceFaults {
  struct Fault {
    FaceKey face;
    std::function<std::string(const std::string& place)> text;
  };
  std::vector<Fault> faults;
  std::vector<FaceKey> unassigned;               ///< boundary faces without an element
  std::vector<std::pair<FaceKey, int>> orphans;  ///< boundary elements without a cell, and their patches
};

/// Throws the Error that build_faces() throws of such a mesh, on all ranks, if any has found something. Collective.
void throw_face_faults(MPI_Comm comm, const MeshBlock& block, const FaceFaults& found);

}  // namespace couplet::mesh
