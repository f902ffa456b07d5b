// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::elastic {

/// Edges with which triangular faces share their strain. The tangential gradient of a triangle is the
/// constant strain of its vertices, which locks in bending. The mean over the faces around an edge does not:
///   E = sum_f (1 - t) V_f W(e_f) + sum_E V_E W(e_E),   V_E = sum_{f at E} t V_f / 3
///   e_E = sum_{f at E} (t V_f / 3) e_f / V_E
/// Zero-energy modes appear only at t = 1. An edge between materials is split by material. On a symmetry
/// plane the mean includes the mirror images, so the shear strain across the plane is zero.
class SharedEdges {
 public:
  static constexpr double share = 0.9;
  static constexpr int size = 6;  ///< xx, yy, zz, xy, yz, xz
  /// Position of each tensor entry in a strain.
  static constexpr std::array<int, 9> of_strain{0, 3, 5, 3, 1, 4, 5, 4, 2};
  static constexpr int stride = 8;
  static constexpr int gradient_stride = 12;  ///< of finish_gradients()

  /// `faces` are the triangular ones of this rank (each face on one rank), `volume` is V_f of each.
  /// Collective.
  SharedEdges(const mesh::Mesh& mesh, const ElasticOperator& rows, std::span<const Index> faces,
              std::span<const double> volume);

  std::size_t n_faces() const { return edges_of_.size(); }
  const std::array<Index, 3>& edges_of(std::size_t face) const { return edges_of_[face]; }
  void clear() { std::fill(value_.begin(), value_.end(), 0.0); }
  double* at(Index edge) { return value_.data() + std::size_t(edge) * stride; }
  /// Completes the means after all faces have added (t V_f / 3) e_f: sums over ranks, divides by V_E,
  /// mirrors. Collective.
  void finish_means();
  /// Completes means of gradients in the caller's array, entry a * 3 + b of an edge. Collective.
  void finish_gradients(std::span<double> values) const;
  std::size_t n_edges() const { return inverse_volume_.size(); }
  double volume(Index edge) const { return 1 / inverse_volume_[edge]; }
  bool is_owned(Index edge) const { return !parallel_ || edge < map_.n_owned(); }
  /// Number of an edge over all ranks, and its inverse (-1 for another rank's edge).
  GlobalIndex global(Index edge) const { return parallel_ ? map_.global(edge) : edge; }
  Index owned_of(GlobalIndex edge) const {
    if (!parallel_) return Index(edge);
    const GlobalIndex i = edge - map_.first();
    return i >= 0 && i < map_.n_owned() ? Index(i) : -1;
  }
  /// Edges on symmetry planes with the normal, one entry per plane.
  const std::vector<std::pair<Index, Vec3>>& mirrors() const { return mirrors_; }
  /// Constants of an edge: means over its faces. The matrix exists only for anisotropic bodies.
  const LameConstants& lame(Index edge) const { return lame_[lame_.size() == 1 ? 0 : std::size_t(edge)]; }
  const ElasticMatrix& matrix(Index edge) const { return matrix_[std::size_t(edge)]; }
  /// Converts strains (tensor shear) to stresses by the edge's constants.
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
  std::vector<LameConstants> lame_;                     // one per edge and material, or one in total
  std::vector<ElasticMatrix> matrix_;                   // one per edge instead; empty if isotropic
  std::vector<std::pair<Index, Vec3>> mirrors_;         // edges on symmetry planes, with the normal
  std::vector<std::array<GlobalIndex, 2>> end_points_;  // only during construction
  std::vector<GlobalIndex> names_;                      // of the local points, only during construction
};

/// Triangular flux faces in the order of SharedEdges: first `n_mine` of this rank, then the others, whose
/// `volume` [m^3] is 0. Empty in 2-D.
struct SharedFaces {
  std::vector<Index> faces;
  std::vector<double> volume;
  std::size_t n_mine = 0;
};
SharedFaces shared_faces(const mesh::Mesh& mesh, const ElasticOperator& rows);

/// Stress of the edges: mean of their faces' with the weights of the strain, stored in SharedEdges::at().
/// `stress` is per flux face [Pa]. Collective.
void find_edge_stresses(const SharedFaces& shared, std::span<const Tensor3> stress, SharedEdges& edges);

/// Value at an edge as a symmetric tensor.
Tensor3 edge_tensor(SharedEdges& edges, Index edge);

}  // namespace couplet::elastic
