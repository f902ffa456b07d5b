// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::elastic {

/// The edges with which three-cornered faces share their strain. The tangential part of a face's gradient is
/// the constant strain of its three vertices, which locks in bending; the mean over the faces round an edge
/// does not:
///   E = sum_f (1 - t) V_f W(e_f) + sum_E V_E W(e_E),   V_E = sum_{f at E} t V_f / 3,
///   e_E = sum_{f at E} (t V_f / 3) e_f / V_E
/// Zero modes appear at t = 1 only. Edges between materials are one a material. On a symmetry plane the mean
/// holds the mirror images, too: no shear across the plane.
class SharedEdges {
 public:
  static constexpr double share = 0.9;
  static constexpr int size = 6;  ///< xx, yy, zz, xy, yz, xz
  static constexpr std::array<int, 9> of_strain{0, 3, 5, 3, 1,
                                                4, 5, 4, 2};  ///< where a tensor's entries stand
  static constexpr int stride = 8;
  static constexpr int gradient_stride = 12;  ///< of finish_gradients()

  /// `faces`: the three-cornered ones of this rank, each face on one rank alone; `volume`: V_f of each.
  /// Collective.
  SharedEdges(const mesh::Mesh& mesh, const ElasticOperator& rows, std::span<const Index> faces,
              std::span<const double> volume);

  std::size_t n_faces() const { return edges_of_.size(); }
  const std::array<Index, 3>& edges_of(std::size_t face) const { return edges_of_[face]; }
  void clear() { std::fill(value_.begin(), value_.end(), 0.0); }
  double* at(Index edge) { return value_.data() + std::size_t(edge) * stride; }
  /// After all faces have added (t V_f / 3) e_f: over the ranks, divided by V_E, mirrored. Collective.
  void finish_means();
  /// The same of gradients in an array of the caller's: entry a * 3 + b of an edge. Collective.
  void finish_gradients(std::span<double> values) const;
  std::size_t n_edges() const { return inverse_volume_.size(); }
  double volume(Index edge) const { return 1 / inverse_volume_[edge]; }
  bool is_owned(Index edge) const { return !parallel_ || edge < map_.n_owned(); }
  /// One number an edge over all ranks, and back: -1: of another rank.
  GlobalIndex global(Index edge) const { return parallel_ ? map_.global(edge) : edge; }
  Index owned_of(GlobalIndex edge) const {
    if (!parallel_) return Index(edge);
    const GlobalIndex i = edge - map_.first();
    return i >= 0 && i < map_.n_owned() ? Index(i) : -1;
  }
  /// Edges on symmetry planes, with the normal; as often as planes.
  const std::vector<std::pair<Index, Vec3>>& mirrors() const { return mirrors_; }
  /// An edge's own constants: means of its faces'. The matrix of anisotropic bodies alone.
  const LameConstants& lame(Index edge) const { return lame_[lame_.size() == 1 ? 0 : std::size_t(edge)]; }
  const ElasticMatrix& matrix(Index edge) const { return matrix_[std::size_t(edge)]; }
  /// Strains (engineering shear halved) become stresses of the edge's own constants.
  void to_stress();

 private:
  struct Key;
  void number(const mesh::Mesh& mesh, std::span<const Index> faces);
  void find_matrices(const mesh::Mesh& mesh, const ElasticOperator& rows, std::span<const Index> faces,
                     std::span<const double> volume);
  void finish(std::span<double> values, int step, std::span<const int, 9> place) const;
  void find_mirrors(const mesh::Mesh& mesh, const ElasticOperator& rows);

  std::vector<std::array<Index, 3>> edges_of_;
  parallel::IndexMap map_;
  bool parallel_ = false;
  std::vector<double> value_, inverse_volume_;
  std::vector<LameConstants> lame_;                     // one a material's edge, or one in all
  std::vector<ElasticMatrix> matrix_;                   // in its place, one an edge; empty: isotropic
  std::vector<std::pair<Index, Vec3>> mirrors_;         // edges on symmetry planes, with the normal
  std::vector<std::array<GlobalIndex, 2>> end_points_;  // while it is made
  std::vector<GlobalIndex> names_;                      // of the local points, while it is made
};

/// The three-cornered flux faces in the order of SharedEdges: `n_mine` of this rank, then others'; `volume` [m^3] of
/// this rank's, 0 of the others. Empty in the plane.
struct SharedFaces {
  std::vector<Index> faces;
  std::vector<double> volume;
  std::size_t n_mine = 0;
};
SharedFaces shared_faces(const mesh::Mesh& mesh, const ElasticOperator& rows);

/// Stress of the edges: the mean of their faces' by the weights of their strain, see SharedEdges::at(). `stress`: per flux
/// face [Pa]. Collective.
void find_edge_stresses(const SharedFaces& shared, std::span<const Tensor3> stress, SharedEdges& edges);

/// Gives the value at an edge as a symmetric tensor.
Tensor3 edge_tensor(SharedEdges& edges, Index edge);

}  // namespace couplet::elastic
