// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/elasticity/lanes.hpp"
#include "common/elasticity/symmetric/symmetric_faces.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::elastic {

/// Triangular flux faces in the order of SharedEdges: first `n_mine` of this rank, then those of others. Empty
/// in 2-D.
struct SharedFaces {
  std::vector<Index> faces;
  std::vector<double> share;  ///< t, see SharedEdges
  std::vector<double> part;   ///< t V / 3, which the face gives each of its edges; 0 on other ranks [m^3]
  std::size_t n_mine = 0;
};
SharedFaces shared_faces(const mesh::Mesh& mesh, const ElasticOperator& rows);

/// Edges with which triangular faces share their strain. The tangential gradient of a triangle is the
/// constant strain of its vertices, which locks in bending. The mean over the faces around an edge does not:
///   E = sum_f (1 - t) V_f W(e_f) + sum_E V_E W(e_E),   V_E = sum_{f at E} t V_f / 3
///   e_E = sum_{f at E} (t V_f / 3) e_f / V_E
/// The mean over an edge is softer than the body by the variation of strain within it, the faces' own part
/// is stiffer. Both errors are second order and cancel in bending at t = 0.8. t is 0.95 where the own part is
/// stiffer still: at the surface, where means cover fewer faces, and in triangles stretched 3:1 and more.
/// Zero-energy modes appear only at t = 1. An edge between materials is split by material. On a symmetry
/// plane the mean includes the mirror images, so the shear strain across the plane is zero.
class SharedEdges {
 public:
  static constexpr int size = 6;  ///< xx, yy, zz, xy, yz, xz
  /// Position of each tensor entry in a strain.
  static constexpr std::array<int, 9> of_strain{0, 3, 5, 3, 1, 4, 5, 4, 2};
  static constexpr int stride = 8;
  static constexpr int gradient_stride = 12;  ///< of finish_gradients()

  /// Collective.
  SharedEdges(const mesh::Mesh& mesh, const ElasticOperator& rows, const SharedFaces& shared);

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
  struct EdgeKey;
  void number(const mesh::Mesh& mesh, std::span<const Index> faces);
  void find_matrices(const mesh::Mesh& mesh, const ElasticOperator& rows, const SharedFaces& shared);
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

/// Stress of the edges: mean of their faces' with the weights of the strain, stored in SharedEdges::at().
/// `stress` is per flux face [Pa]. Collective.
void find_edge_stresses(const SharedFaces& shared, std::span<const Tensor3> stress, SharedEdges& edges);

/// Value at an edge as a symmetric tensor.
Tensor3 edge_tensor(SharedEdges& edges, Index edge);

/// Rows of four faces for SIMD arithmetic. All indices are locations.
struct FaceBlock {
  double b[3][3][4];                       ///< of the neighbor node, plus_0 (, plus_1): see FaceRows
  std::array<Index, 4> plus[3], minus[3];  ///< neighbor and owner nodes, then points
};

/// Volumes of four faces. Padding has none.
struct FaceVolumes {
  double whole[4];           ///< V [m^3]
  double own[4];             ///< 1 - t, the share of the energy that is not assigned to edges
  double here[4], there[4];  ///< V_fP of both sides over V
  Index face[4];             ///< -1 for padding
};

/// Faces that a rank computes, in blocks in their order. The last block is padded.
struct FaceGroup {
  std::vector<Index> faces;
  std::vector<FaceBlock> blocks;
  std::vector<FaceVolumes> volumes;
  std::vector<std::array<std::array<Index, 3>, 4>> edges;  ///< of each block; empty if nothing is shared
};

FaceGroup make_group(const mesh::Mesh& mesh, const ElasticOperator& rows, std::vector<Index> faces);

/// Group of this rank's flux faces with takes(f): those that share with `edges`, or the others if nullptr.
template <class Takes>
FaceGroup make_group(const mesh::Mesh& mesh, const ElasticOperator& rows, const SharedFaces& shared,
                     const SharedEdges* edges, const Takes& takes) {
  std::vector<Index> faces;
  for (Index f = 0; f < mesh.n_flux_faces(); ++f)
    if (mesh.owner[f] < mesh.cells.n_owned() && takes(f) &&
        (mesh.dim == 3 && mesh.face_points[f].size() == 3) == (edges != nullptr))
      faces.push_back(f);
  FaceGroup group = make_group(mesh, rows, std::move(faces));
  if (!edges) return group;
  group.edges.resize(group.blocks.size());
  const auto end = shared.faces.begin() + std::ptrdiff_t(shared.n_mine);
  for (std::size_t i = 0; i < group.edges.size() * 4; ++i) {
    const Index f = group.faces[std::min(i, group.faces.size() - 1)];
    const auto at = std::lower_bound(shared.faces.begin(), end, f) - shared.faces.begin();
    group.edges[i / 4][i % 4] = edges->edges_of(std::size_t(at));
    group.volumes[i / 4].own[i % 4] = 1 - shared.share[std::size_t(at)];
  }
  return group;
}

namespace blocks {

[[gnu::always_inline]] inline Four wide(const double* from) { return lanes::load<3>(from); }

/// t V / 3, which four faces give each of their edges.
[[gnu::always_inline]] inline Four part_of_edges(const FaceVolumes& volumes) {
  return wide(volumes.whole) * (1 - wide(volumes.own)) * (1.0 / 3);
}

/// Gathers the vectors of four locations as components over the four faces.
template <int D>
[[gnu::always_inline]] inline void gather(const double* values, const std::array<Index, 4>& at,
                                          Four (&to)[D]) {
  if constexpr (D == 3) {
    const Four a = wide(values + std::size_t(at[0]) * 4), b = wide(values + std::size_t(at[1]) * 4),
               c = wide(values + std::size_t(at[2]) * 4), d = wide(values + std::size_t(at[3]) * 4);
    const Four ab = __builtin_shufflevector(a, b, 0, 4, 2, 6), cd = __builtin_shufflevector(c, d, 0, 4, 2, 6);
    const Four y = __builtin_shufflevector(a, b, 1, 5, 3, 7), w = __builtin_shufflevector(c, d, 1, 5, 3, 7);
    to[0] = __builtin_shufflevector(ab, cd, 0, 1, 4, 5);
    to[1] = __builtin_shufflevector(y, w, 0, 1, 4, 5);
    to[2] = __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
  } else {
    for (int a = 0; a < D; ++a) {
      const double of_faces[4] = {values[std::size_t(at[0]) * 4 + a], values[std::size_t(at[1]) * 4 + a],
                                  values[std::size_t(at[2]) * 4 + a], values[std::size_t(at[3]) * 4 + a]};
      to[a] = wide(of_faces);
    }
  }
}

/// Converts the components of four faces to vectors.
[[gnu::always_inline]] inline void transpose(const Four (&from)[3], Four (&to)[4]) {
  const Four zero{};
  const Four low = __builtin_shufflevector(from[0], from[1], 0, 4, 2, 6);  // x0 y0 x2 y2
  const Four high = __builtin_shufflevector(from[0], from[1], 1, 5, 3, 7);
  const Four z = __builtin_shufflevector(from[2], zero, 0, 4, 2, 6);
  const Four zh = __builtin_shufflevector(from[2], zero, 1, 5, 3, 7);
  to[0] = __builtin_shufflevector(low, z, 0, 1, 4, 5);
  to[1] = __builtin_shufflevector(high, zh, 0, 1, 4, 5);
  to[2] = __builtin_shufflevector(low, z, 2, 3, 6, 7);
  to[3] = __builtin_shufflevector(high, zh, 2, 3, 6, 7);
}

/// Adds `force` at `plus` and subtracts it at `minus`, for each of the four faces.
template <int D>
[[gnu::always_inline]] inline void scatter(double* values, const std::array<Index, 4>& plus,
                                           const std::array<Index, 4>& minus, const Four (&force)[D]) {
  if constexpr (D == 3) {
    Four of[4];
    transpose(force, of);
    for (int k = 0; k < 4; ++k) {
      lanes::add<3>(values + std::size_t(plus[k]) * 4, of[k]);
      lanes::add<3>(values + std::size_t(minus[k]) * 4, -of[k]);
    }
  } else {
    for (int k = 0; k < 4; ++k)
      for (int a = 0; a < D; ++a) {
        values[std::size_t(plus[k]) * 4 + a] += force[a][k];
        values[std::size_t(minus[k]) * 4 + a] -= force[a][k];
      }
  }
}

/// Computes the gradient G, entry (k, j) = d u_k / d x_j.
template <int D>
[[gnu::always_inline]] inline void gradient(const FaceBlock& block, const double* values, Four (&g)[D][D]) {
  Four u[D][D], other[D];
  for (int i = 0; i < D; ++i) {
    gather<D>(values, block.plus[i], u[i]);
    gather<D>(values, block.minus[i], other);
    for (int a = 0; a < D; ++a) u[i][a] -= other[a];
  }
  for (int a = 0; a < D; ++a)
    for (int b = 0; b < D; ++b) {
      g[a][b] = u[0][a] * wide(block.b[0][b]);
      for (int k = 1; k < D; ++k) g[a][b] += u[k][a] * wide(block.b[k][b]);
    }
}

/// Adds the forces dE/du of a stress times V to nodes and points.
template <int D>
[[gnu::always_inline]] inline void push(const FaceBlock& block, const Four (&stress)[D][D], double* forces) {
  for (int k = 0; k < D; ++k) {
    Four force[D];
    for (int a = 0; a < D; ++a) {
      force[a] = stress[a][0] * wide(block.b[k][0]);
      for (int b = 1; b < D; ++b) force[a] += stress[a][b] * wide(block.b[k][b]);
    }
    scatter<D>(forces, block.plus[k], block.minus[k], force);
  }
}

/// Average of cell values, (V_fP p_P + V_fQ p_Q) / V.
[[gnu::always_inline]] inline Four between(const FaceBlock& block, const FaceVolumes& volumes,
                                           const double* of_nodes) {
  double here[4], there[4];
  for (int k = 0; k < 4; ++k) {
    here[k] = of_nodes[std::size_t(block.minus[0][k])];
    there[k] = of_nodes[std::size_t(block.plus[0][k])];
  }
  return wide(volumes.here) * wide(here) + wide(volumes.there) * wide(there);
}

/// Adds V_fP times the value of a face to its cells.
[[gnu::always_inline]] inline void add_to_cells(const FaceBlock& block, const FaceVolumes& volumes,
                                                const Four& value, double* of_nodes) {
  const Four whole = value * wide(volumes.whole);
  for (int k = 0; k < 4; ++k) {
    of_nodes[std::size_t(block.minus[0][k])] += volumes.here[k] * whole[k];
    of_nodes[std::size_t(block.plus[0][k])] += volumes.there[k] * whole[k];
  }
}

}  // namespace blocks

}  // namespace couplet::elastic
