// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "common/base/types.hpp"
#include "common/elasticity/elasticity.hpp"
#include "common/elasticity/wrench.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::elastic {

class SymmetricKernel;
class SymmetricSpace;

/// How the displacement gradient at a face is formed.
enum class FaceGradientScheme {
  thesis,     ///< (2.53)-(2.58): the operator that ElasticOperator assembles; locks in bending
  corrected,  ///< the same unknowns and conditions, with second-order corrections from cell gradients
  symmetric,  ///< the thesis's gradient with its transpose for the forces: from an energy (SymmetricKernel)
};

/// Displacements (or velocities, ...) as the kernels take them; an empty `known` stands for zeros.
struct ElasticField {
  std::span<const double> unknowns, known;
};
/// What a product is taken with: K without springs, springs, M.
enum class ElasticPart { stiffness, springs, mass };

/// All that acts on a body from outside, as the kernels take it.
struct ElasticLoads {
  std::vector<double> faces;     ///< `dim` values a boundary face of owned cells [N]; empty: none
  std::vector<double> cells;     ///< `dim` values an owned cell [N]; empty: none
  std::vector<double> pressure;  ///< of thermal strain, per local face [Pa]; empty: none
};

/// The rows of ElasticOperator applied without a matrix: result = A u + K known, in some 80 ns
/// (corrected) a hexahedron where the assembled matrix moves 2 kB and more.
///
/// `corrected`: with the least-squares gradients G_P of the cells (over face neighbours, weight 1/d^3, which
/// is exact for quadratics on a stretched line of cells; mirrored at symmetry planes)
///   u_V  = sum w_i (u_i + 1/2 r_i . G_i),  r_i = x_V - x_i   weights that are exact for linear fields and
///   half the
///          gradients: exact for quadratics; G_i of a boundary node from the vertices of its face and the
///          normal derivative below
///   u_e  = (u_V1 + u_V2) / 2 - L . (G_V2 - G_V1) / 8          middle of an edge (3-D; not where a vertex is
///   known) d . grad u at the face centre = u_N - u_P + (x_f - (x_P + x_N) / 2) . (G_N - G_P) and = 2 (u_B -
///   u_P) - d . G_P on a boundary face.
/// Every term vanishes for linear fields. The thesis's gradient makes a beam of cells of length h and depth t
/// too stiff by about 1.15 (h/t)^2, since vertex values and edge means have errors that bending does not
/// cancel; these do not.
class ElasticKernel {
 public:
  /// `rows` describes unknowns, known columns, vertices and materials (kept by reference, as the mesh).
  /// Collective.
  ElasticKernel(const mesh::Mesh& mesh, const ElasticOperator& rows, FaceGradientScheme scheme);
  ~ElasticKernel();
  ElasticKernel(ElasticKernel&&) noexcept;
  ElasticKernel& operator=(ElasticKernel&&) noexcept;

  /// Rows and columns as ElasticOperator has them; an empty `known` stands for zeros. Allocates nothing but
  /// what the halo exchange needs. Collective.
  void apply(std::span<const double> unknowns, std::span<const double> known, std::span<double> result) const;
  /// Takes (face, gradient) for each flux face, entry (i, j) = d u_j / d x_i; zeros across the plane in 2-D.
  using TakeGradient = std::function<void(Index, const Tensor3&)>;
  /// Of the flux faces from `first` to the one before `end`. Collective.
  void face_gradients(std::span<const double> unknowns, std::span<const double> known,
                      const TakeGradient& take, Index first, Index end) const;
  /// dim values a local point; those of points that belong to no owned cell are left as they are. Collective.
  void point_values(std::span<const double> unknowns, std::span<const double> known,
                    std::span<double> points) const;
  FaceGradientScheme scheme() const { return scheme_; }
  bool is_symmetric() const { return scheme_ == FaceGradientScheme::symmetric; }

  /// What acts on the body as right-hand sides, by the trial functions of the kernel. Collective.
  ///
  /// Known forces [N] of the boundary faces of owned cells, `dim` values a face; gives the sum of what this
  /// rank added.
  Vec3 add_face_forces(std::span<const double> forces, std::span<double> rhs) const;
  /// Forces [N] on owned cells, `dim` values each.
  void add_cell_forces(std::span<const double> forces, std::span<double> rhs) const;
  /// Means of the trace on these boundary faces of owned cells, `dim` values each, in the order of `faces`: what a known force on
  /// them does work on. Of the symmetric kernel alone, in the plane or in space. Collective.
  void face_means(std::span<const Index> faces, std::span<const double> unknowns,
                  std::span<const double> known, std::span<double> means) const;
  /// Of an isotropic stress - p I beside that of the displacement, p [Pa] per local face.
  void add_pressure(std::span<const double> pressure, std::span<double> rhs) const;

  /// Tells the kernel the density of the local cells [kg/m^3]. True: its mass is consistent with its
  /// stiffness and apply_with_mass() knows it; all its nodes have inertia. False: the mass of a cell is its
  /// density times volume, and faces have none.
  bool set_density(std::span<const double> of_cells) const;
  /// mass_factor M u, and K u if asked for; after set_density() said true. Collective.
  void apply_with_mass(std::span<const double> unknowns, std::span<const double> known, double mass_factor,
                       bool with_stiffness, std::span<double> result) const;
  /// v . A u of this rank, known values included. Of the symmetric kernel alone. Collective.
  double product(ElasticPart part, const ElasticField& u, const ElasticField& v) const;
  /// Force on the body at each patch, from what the stress leaves there and the loads that act there;
  /// this rank's part. Of the symmetric kernel alone. Collective.
  std::vector<Wrench> holding_forces(std::span<const double> unknowns, std::span<const double> known,
                                     const ElasticLoads& loads) const;
  /// The mixed form [boffi2013], whose unknowns are also the mean stresses p [Pa] of the owned cells, with supports
  /// that rest:
  ///   result = K' u + mass_factor M u + B^T p,   defect = B u - (V / K_P) p [m^3],   B u = V theta of the cells,
  /// K' being K without the bulk modulus K_P that acts on the volume strain of cells (bulk_of_cells). defect = 0 makes
  /// result = K u. Of the symmetric kernel with ElasticOperator::volume_by_cells() alone. Collective.
  void apply_mixed(std::span<const double> unknowns, std::span<const double> pressure, double mass_factor,
                   std::span<double> result, std::span<double> defect) const;

  /// With the published gradient or its corrections.
  class LeastSquares {
   public:
    virtual ~LeastSquares() = default;
    virtual void apply(std::span<const double> unknowns, std::span<const double> known,
                       std::span<double> result) = 0;
    virtual void face_gradients(std::span<const double> unknowns, std::span<const double> known,
                                const TakeGradient& take, Index first, Index end) = 0;
    virtual void point_values(std::span<const double> unknowns, std::span<const double> known,
                              std::span<double> points) = 0;
  };

 private:
  SymmetricSpace& filled(std::span<const double> unknowns, std::span<const double> known) const;
  SymmetricSpace& cleared() const;

  const ElasticOperator* rows_;
  FaceGradientScheme scheme_;
  std::unique_ptr<SymmetricKernel> symmetric_;  // one of both, the other is null
  std::unique_ptr<LeastSquares> least_squares_;
};

std::unique_ptr<ElasticKernel::LeastSquares> make_least_squares_kernel(const mesh::Mesh& mesh,
                                                                       const ElasticOperator& rows,
                                                                       bool is_corrected);

}  // namespace couplet::elastic
