// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/coupling/participant.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::coupling {

/// Some patches as an interface: each rank has the vertices that it owns and the faces of its own cells, and
/// nothing of the others'. All calls collective over mesh.comm.
class InterfaceMap {
 public:
  /// Throws Error naming the patches that exist if one is unknown.
  InterfaceMap(const mesh::Mesh& mesh, const std::vector<std::string>& patches);

  /// Local points on these patches, owned ones first, then ghosts (a vertex may lie on several ranks);
  /// ascending.
  const std::vector<Index>& points() const { return points_; }
  /// Boundary faces (face indices) of owned cells on these patches, ascending.
  const std::vector<Index>& faces() const { return faces_; }

  /// Where what this rank owns is in this geometry; takes and gives stay empty.
  Interface describe(const mesh::Geometry& geometry) const;
  /// Values of the vertices that this rank owns to values at points(), in that order. An empty vector
  /// (nothing was given) stands for zeros; any other wrong size is an Error.
  std::vector<double> scatter_vertices(const std::vector<double>& owned, int components) const;
  std::vector<double> scatter_faces(const std::vector<double>& owned, int components) const;
  /// Values at points() to those of the vertices that this rank owns; faces have one owner each.
  std::vector<double> gather_vertices(std::span<const double> local, int components) const;
  std::vector<double> gather_faces(std::span<const double> local, int components) const;

 private:
  const mesh::Mesh* mesh_;
  std::vector<std::string> patches_;
  std::vector<Index> points_, faces_;
  parallel::IndexMap vertices_;  // of points()
};

}  // namespace couplet::coupling
