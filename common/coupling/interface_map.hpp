// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/coupling/participant.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::coupling {

/// Interface made of some patches. Each rank has the vertices it owns and the faces of its own cells. All
/// calls are collective over mesh.comm.
class InterfaceMap {
 public:
  /// Throws Error with the existing patches if one is unknown.
  InterfaceMap(const mesh::Mesh& mesh, const std::vector<std::string>& patches);

  /// Local points on these patches: owned ones, then ghosts (a vertex may lie on several ranks), each
  /// ascending.
  const std::vector<Index>& points() const { return points_; }
  /// Face indices of the boundary faces of owned cells on these patches, ascending.
  const std::vector<Index>& faces() const { return faces_; }

  /// Vertices and faces of this rank in this geometry. `takes` and `gives` are left empty.
  Interface describe(const mesh::Geometry& geometry) const;
  /// Distributes values of owned vertices to points(). An empty vector stands for zeros. Any other wrong size
  /// throws Error.
  std::vector<double> scatter_vertices(const std::vector<double>& owned, int components) const;
  std::vector<double> scatter_faces(const std::vector<double>& owned, int components) const;
  /// Collects values at points() for the vertices that this rank owns. Each face has one owner.
  std::vector<double> gather_vertices(std::span<const double> local, int components) const;
  std::vector<double> gather_faces(std::span<const double> local, int components) const;

 private:
  const mesh::Mesh* mesh_;
  std::vector<std::string> patches_;
  std::vector<Index> points_, faces_;
  parallel::IndexMap vertices_;  // of points()
};

}  // namespace couplet::coupling
