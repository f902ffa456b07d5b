// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "common/mesh/mesh.hpp"

namespace couplet::mesh {

/// An element of CalculiX or Abaqus as a cell. Corners come first in both, in the order of VTK and gmsh.
struct InpShape {
  CellType cell;
  int dim, n_corners, n_faces;
  /// Corners of the faces S1, S2, ...; -1: no such.
  std::array<std::array<std::int8_t, 4>, 6> faces;
};

/// What a name such as "C3D10" stands for.
struct InpType {
  enum class Use {
    cell,     ///< of a body
    edge,     ///< a bar of two or three nodes: boundary of a 2-D mesh, else passed over
    nothing,  ///< a spring, a mass: passed over with all its nodes
    unknown
  };
  Use use = Use::unknown;
  const InpShape* shape = nullptr;  ///< of cells
  int n_nodes = 0;                  ///< in the file; more than the corners: of second order
};

/// `name` in capitals.
InpType inp_type(std::string_view name);
/// Why an element of unknown type is not read.
std::string why_not_read(std::string_view name);

}  // namespace couplet::mesh
