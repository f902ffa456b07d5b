// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "common/elasticity/elastic_kernel.hpp"
#include "common/elasticity/symmetric/face_groups.hpp"
#include "common/elasticity/symmetric/symmetric_space.hpp"

namespace couplet::elastic {

/// Operator K = B^T C V B, with the face gradient of the thesis and its transpose for the forces. It is the
/// second derivative of E = sum_f V_f W(G_f), W = mu |sym G|^2 + lambda/2 (tr G)^2. K is symmetric, positive,
/// exact for linear fields and free of resultants on any mesh whose cells lie behind their faces. Forces f_i
/// += V_f sigma_f b_i with sigma_f = C : sym G_f act on nodes and points. Vertex forces are distributed to
/// nodes by the transposed weights (SymmetricSpace). Triangles in 3-D share their strain with edges
/// (SharedEdges). For a body of revolution the rows are those of rings, with energies, forces and masses of
/// the whole body.
///
/// A product loops over vertices, over faces in blocks of four, and over vertices again. Compared to the
/// other kernels one more message returns the forces on ghosts to their owners.
class SymmetricKernel {
 public:
  SymmetricKernel(const mesh::Mesh& mesh, const ElasticOperator& rows);

  SymmetricSpace& space() { return space_; }
  /// Adds the internal forces for the displacement of the space. Collective.
  void add_internal_forces();
  /// Overload with given mean stresses [Pa] of the owned cells. Sets `defect` to the missing volume [m^3].
  void add_internal_forces(std::span<const double> pressure, std::span<double> defect);
  /// Visits the face gradients of the displacement; for a ring the hoop strain is entry (2, 2). Collective.
  void face_gradients(const ElasticKernel::TakeGradient& take, Index first, Index end);
  /// Adds the forces of a pressure [Pa] on flux faces, which triangles share with their edges. Collective.
  void spread_pressure(std::span<const double> pressure);

  // The loops are public so that they can be cloned for several processors.
  template <int D>
  [[gnu::always_inline]] inline void faces_loop();
  [[gnu::always_inline]] inline void shared_first_loop();
  [[gnu::always_inline]] inline void shared_second_loop();
  template <int D>
  [[gnu::always_inline]] inline void volumes_loop();

 private:
  /// Isotropic law of four faces: Lame constants times V.
  struct Hooke {
    double mu[4], lambda[4];
  };
  /// Anisotropic law: upper triangle of the elastic matrix times V, row by row; in 2-D that of xx, yy, xy.
  struct Anisotropic {
    double c[21][4];
  };
  struct LawGroup : FaceGroup {
    std::vector<Hooke> hooke;
    std::vector<Anisotropic> matrix;  // empty for the isotropic law
  };
  struct RingFace {
    double b[4][3];              // d/dr, d/dz, hoop
    double mu, lambda, shear;    // times the volume
    std::array<Index, 4> place;  // see FaceRows
  };
  struct KeptStress {
    double stress[6][4];
  };
  void add_laws(LawGroup& group) const;
  void make_ring(Index f);
  template <int D>
  [[gnu::always_inline]] inline void stress_of(const LawGroup& group, std::size_t i, const Four (&g)[D][D],
                                               Four (&stress)[D][D]) const;
  template <int D>
  [[gnu::always_inline]] inline void add_pressure_of_cells(const LawGroup& group, std::size_t i,
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
  LawGroup plain_, sharing_;  // sharing_: faces with shared edges
  std::vector<RingFace> rings_;
  std::vector<Index> shared_index_;  // of each flux face in edges_, or -1
  std::vector<double> share_;        // of the faces in edges_
  std::vector<KeptStress> kept_;     // own part of V sigma of the blocks of sharing_
  std::unique_ptr<SharedEdges> edges_;
  std::vector<double> pressure_, bulk_;  // of nodes; K / V of owned cells [Pa/m^3]
};

}  // namespace couplet::elastic
