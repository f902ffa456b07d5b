// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/coupling/participant.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet {

/// Between the values a rank holds on some patches and the interface vectors on rank 0 (each vertex by
/// ascending point_id, each face by ascending boundary_id, once). All calls collective over mesh.comm.
class InterfaceMap {
 public:
  /// Throws Error naming the patches that exist if one is unknown.
  InterfaceMap(const Mesh& mesh, const std::vector<std::string>& patches);

  /// Local points on these patches, owned or ghost (a vertex may lie on several ranks); ascending.
  const std::vector<Index>& points() const { return points_; }
  /// Boundary faces (face indices) of owned cells on these patches, ascending.
  const std::vector<Index>& faces() const { return faces_; }

  /// dim, vertices, face_centres, face_areas of the reference configuration and the faces' corners on rank 0;
  /// takes and gives stay empty.
  Interface describe() const;
  /// Rank 0's vector (vertices x components) to values at points(), in that order, on every rank.
  /// An empty vector on rank 0 (nothing was given) stands for zeros; any other wrong size is an Error.
  std::vector<double> scatter_vertices(const std::vector<double>& on_root, int components) const;
  std::vector<double> scatter_faces(const std::vector<double>& on_root, int components) const;
  /// Values at points() / faces() to the vector on rank 0 (empty elsewhere). Vertices: the owner's value
  /// counts.
  std::vector<double> gather_vertices(std::span<const double> local, int components) const;
  std::vector<double> gather_faces(std::span<const double> local, int components) const;

 private:
  /// Where the entries of every rank stand in rank 0's vector, rank by rank (known on rank 0 only).
  struct Layout {
    std::vector<int> counts;
    std::vector<Index> positions;
    Layout() = default;
    Layout(MPI_Comm comm, const std::vector<Index>& local);
  };
  std::vector<double> scatter(const Layout& layout, std::size_t n_here, std::size_t n_all,
                              const std::vector<double>& on_root, int components) const;
  std::vector<double> gather(const Layout& layout, std::size_t n_all, std::span<const double> local,
                             int components) const;

  void describe_corners(Interface& interface) const;

  const Mesh* mesh_;
  std::vector<Index> points_, faces_;
  std::vector<Index> vertex_of_;     // of each of points_: its place in the interface vector
  std::vector<Index> owned_points_;  // positions in points_ of those that this rank owns
  Layout point_layout_, owned_point_layout_, face_layout_;
  std::size_t n_vertices_ = 0, n_faces_ = 0;  // over all ranks
};

}  // namespace couplet
