// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "common/elasticity/elastic_kernel.hpp"
#include "common/elasticity/symmetric/shared_edges.hpp"
#include "common/elasticity/symmetric/symmetric_blocks.hpp"
#include "common/elasticity/symmetric/symmetric_space.hpp"

namespace couplet::elastic {

/// K = B^T C V B: the thesis's face gradient kept, its forces taken as its transpose, so that the operator is
/// the second derivative of the energy E = sum_f V_f W(G_f), W = mu |sym G|^2 + lambda/2 (tr G)^2: symmetric,
/// positive, exact for linear fields, without resultant on any mesh whose cells lie behind their faces. With
/// sigma_f = C : sym G_f the forces are f_i += V_f sigma_f b_i on the nodes and points of the face, and the vertices'
/// forces go to their nodes by the transposed weights (SymmetricSpace). Three-cornered faces in space share their
/// strain with their edges (SharedEdges). Loads and mass use the same trial functions. Of a body of revolution the
/// rows are those of rings: energies, forces and masses are those of the whole body.
///
/// One pass over the vertices, one over the faces in blocks of four, one back over the vertices; a message
/// more than the other kernels: the forces on ghosts go to their owners.
class SymmetricKernel {
 public:
  SymmetricKernel(const mesh::Mesh& mesh, const ElasticOperator& rows);

  SymmetricSpace& space() { return space_; }
  /// Adds those of the stress to the forces of the space, of its displacement. Collective.
  void add_internal_forces();
  /// The same with these mean stresses [Pa] of the owned cells. Gives the volume that they miss [m^3]: `defect`.
  void add_internal_forces(std::span<const double> pressure, std::span<double> defect);
  /// Of the displacement in the space; of a ring with the hoop strain as entry (2, 2). Collective.
  void face_gradients(const ElasticKernel::TakeGradient& take, Index first, Index end);
  /// Adds the forces of a pressure [Pa] on the flux faces, as three-cornered ones share it with their edges. Collective.
  void spread_pressure(std::span<const double> pressure);

  // The loops; public for the clones by processor.
  template <int D>
  [[gnu::always_inline]] inline void faces_loop();
  [[gnu::always_inline]] inline void shared_first_loop();
  [[gnu::always_inline]] inline void shared_second_loop();
  template <int D>
  [[gnu::always_inline]] inline void volumes_loop();

 private:
  /// Hooke's isotropic law of four faces: Lame's constants times V.
  struct Hooke {
    double mu[4], lambda[4];
  };
  /// In its place: the upper triangle of the elastic matrix times V, row by row; in the plane that of xx, yy, xy.
  struct Anisotropic {
    double c[21][4];
  };
  struct Group : FaceGroup {
    std::vector<Hooke> hooke;
    std::vector<Anisotropic> matrix;  // empty: Hooke's isotropic law
  };
  struct RingFace {
    double b[4][3];              // d/dr, d/dz, hoop
    double mu, lambda, shear;    // times the volume
    std::array<Index, 4> place;  // see FaceRows
  };
  struct Kept {
    double stress[6][4];
  };
  void add_laws(Group& group) const;
  void make_ring(Index f);
  template <int D>
  [[gnu::always_inline]] inline void stress_of(const Group& group, std::size_t i, const Four (&g)[D][D],
                                               Four (&stress)[D][D]) const;
  template <int D>
  [[gnu::always_inline]] inline void add_pressure_of_cells(const Group& group, std::size_t i,
                                                           Four (&stress)[D][D]) const;
  void forces_of_stress();
  void forces_of_rings();
  void find_edge_means();
  std::span<double> sum_volumes();
  void find_pressures();
  std::vector<double> shared_pressure(std::span<const double> pressure);

  const mesh::Mesh& mesh_;
  const ElasticOperator& rows_;
  SymmetricSpace space_;
  Group plain_, sharing_;  // sharing_: with their edges
  std::vector<RingFace> rings_;
  std::vector<Index> shared_index_;  // of each flux face in edges_, -1: it shares nothing
  std::vector<Kept> kept_;           // own part of V sigma of the blocks of sharing_
  std::unique_ptr<SharedEdges> edges_;
  std::vector<double> pressure_, bulk_;  // of nodes; K / V of owned cells [Pa/m^3]
};

}  // namespace couplet::elastic
