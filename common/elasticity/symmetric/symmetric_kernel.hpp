// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "common/elasticity/elastic_kernel.hpp"
#include "common/elasticity/elastic_nodes.hpp"
#include "common/elasticity/symmetric/shared_edges.hpp"
#include "common/elasticity/symmetric/space_kernel.hpp"
#include "common/elasticity/symmetric/symmetric_blocks.hpp"

namespace couplet::elastic {

/// K = B^T C V B: the thesis's face gradient kept, its forces taken as its transpose, so that the operator is
/// the second derivative of the energy E = sum_f V_f W(G_f), W = mu |sym G|^2 + lambda/2 (tr G)^2: symmetric,
/// positive, exact for linear fields, without resultant on any mesh whose cells lie behind their faces. With
/// sigma_f = C : sym G_f and r = 1/dim
///   f_P -= r sigma_f S,   f_Q += r sigma_f S,   f_plus_i += r sigma_f c_i,   f_minus_i -= r sigma_f c_i,
/// then the vertices' forces go to their nodes by the transposed weights (SymmetricSpace). Three-cornered
/// faces in space share their strain with their edges (SharedEdges). Loads and mass use the same trial
/// functions.
///
/// One pass over the vertices, one over the faces in blocks of four, one back over the vertices; a message
/// more than the other kernels: the forces on ghosts go to their owners.
template <int D>
class SymmetricKernel final : public SpaceKernel<D> {
 public:
  SymmetricKernel(const mesh::Mesh& mesh, const ElasticOperator& rows);

  void face_gradients(std::span<const double> unknowns, std::span<const double> known,
                      const ElasticKernel::TakeGradient& take, Index first, Index end) override;
  void apply_mixed(std::span<const double> unknowns, std::span<const double> pressure, double mass_factor,
                   std::span<double> result, std::span<double> defect) override;

  // The loops; public for the clones by processor.
  [[gnu::always_inline]] inline void faces_loop();
  [[gnu::always_inline]] inline void shared_first_loop();
  [[gnu::always_inline]] inline void shared_second_loop();
  [[gnu::always_inline]] inline void volumes_loop();

 private:
  static constexpr int stride = lanes::width<D>;
  using V = lanes::Lane<3>;
  /// Of a block of three-cornered faces.
  struct SharedBlock {
    double inverse[4], part[4], weight[4];  // 1 / (S . d); t V / 3; V / (S . d) t / 3
    double stress[6][4];                    // own part of V / (S . d) sigma
    std::array<Index, 3> edges[4];
  };
  /// Of a block, where the volume strain is one a cell: V_fP / (S . d) of both sides.
  struct VolumeBlock {
    double from[4], to[4];
  };
  /// Faces that this rank computes, in blocks in their order.
  struct Group {
    std::vector<Index> faces;
    std::vector<FaceBlock<D>> blocks;
    std::vector<ElasticBlock<D>> elastic;  // empty: Hooke's isotropic law
    std::vector<VolumeBlock> volumes;      // empty: the volume strain is the faces'
  };
  Group make_group(std::vector<Index> faces) const;
  void make_edges(const SharedFaces& shared);
  [[gnu::always_inline]] inline void stress_of(const Group& group, const FaceBlock<D>& block,
                                               const V (&h)[D][D], V (&stress)[D][D]) const;
  [[gnu::always_inline]] inline void add_pressure_of_cells(const Group& group, const FaceBlock<D>& block,
                                                           V (&stress)[D][D]) const;
  void internal_forces() override;
  void forces_of_stress();
  std::span<double> sum_volumes();
  void find_pressures();
  std::vector<double> shared_pressure(std::span<const double> pressure) override;

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const ElasticOperator& rows_;
  using SpaceKernel<D>::space_;
  Group plain_, sharing_;            // sharing_: with their edges
  std::vector<Index> shared_index_;  // of each flux face in edges_, -1: it shares nothing
  std::vector<SharedBlock> shared_;  // of sharing_
  std::unique_ptr<SharedEdges> edges_;
  std::vector<double> pressure_, bulk_;  // of nodes; K / V of owned cells [Pa/m^3]
};

}  // namespace couplet::elastic
