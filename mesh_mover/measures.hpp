// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "common/mesh/mesh.hpp"
#include "mesh_mover/parameters.hpp"

namespace couplet::mesh_mover {

/// Extreme value of a measure, and its cell.
struct Worst {
  double value = 0;
  GlobalIndex cell = 0;
  Vec3 place = Vec3::Zero();  ///< [m]
};

/// Quality of a moved mesh relative to its reference.
struct MeshState {
  enum Measure { volume_ratio, scaled_jacobian, edge_ratio, angle, area_change, shape_change, n_measures };
  std::array<Worst, n_measures> worst;
};
/// Names and units for files and messages, in the order of the measures.
extern const std::array<const char*, MeshState::n_measures> measure_names;

/// Quality measures of moved cells: volume ratio to the reference; smallest scaled Jacobian of the corners
/// [knupp2000] (1 for right angles, in simplices for equal angles); ratio of longest to shortest edge; angle
/// between face normals and the lines of cell centers [degree]; f_A = |log2(V/V0)| and f_AR = |log2(AR/AR0)|
/// with AR = (longest edge)^dim / V [stein2003].
class CellMeasures {
 public:
  CellMeasures(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const Parameters& parameters);

  /// Collective.
  MeshState measure(const mesh::Geometry& moved) const;
  /// Values of a measure per local cell, except for the angle.
  std::vector<double> of_cells(MeshState::Measure measure, const mesh::Geometry& moved) const;
  /// Describes violated limits: inverted or self-intersecting cells, and limits of the parameters; with
  /// `by_corners` also cells that are folded at a corner. Empty if there are none. Collective.
  std::string refusal(const mesh::Geometry& moved, bool by_corners = false) const;

 private:
  struct Shape {
    double longest = 0, shortest = 0, jacobian = 0;
  };
  Shape shape(Index cell, std::span<const Vec3> points) const;
  double value(MeshState::Measure measure, Index cell, const mesh::Geometry& moved, const Shape& shape) const;
  double largest_angle(const mesh::Geometry& moved, Index& cell) const;

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  QualityLimits limits_;
  std::vector<double> longest_;  // edge of each owned cell in the reference mesh [m]
};

using CellEdge = std::array<int, 2>;
/// The corner, then the ends of its edges: right-handed in a valid cell; -1 in 2-D.
using CellCorner = std::array<int, 4>;

/// Edges and corners of a cell type in VTK order. A pyramid has no corner at its apex (four edges).
struct CellCorners {
  std::vector<CellEdge> edges;
  std::vector<CellCorner> corners;
  double scale = 1;  ///< of the Jacobian of the ideal cell
};
const CellCorners& corners_of(mesh::CellType type);

}  // namespace couplet::mesh_mover
