// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "common/base/types.hpp"
#include "common/elasticity/elasticity.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::elastic {

class LeastSquares;
class SymmetricKernel;
class SymmetricSpace;

/// Discretization of the displacement gradient at faces.
enum class FaceGradientScheme {
  thesis,     ///< (2.53)-(2.58): the operator that ElasticOperator assembles; locks in bending
  symmetric,  ///< gradient of the thesis, forces by its transpose, from an energy (SymmetricKernel)
};

/// Displacement-like field in the form the kernels use. An empty `known` stands for zeros.
struct ElasticField {
  std::span<const double> unknowns, known;
};
/// Matrix of a product: K without springs, springs, M.
enum class ElasticPart { stiffness, springs, mass };

/// External loads on a body in the form the kernels use.
struct ElasticLoads {
  std::vector<double> faces;     ///< see ElasticKernel::add_face_forces(), or empty
  std::vector<double> cells;     ///< `dim` values per owned cell [N], or empty
  std::vector<double> pressure;  ///< of thermal strain, per local face [Pa], or empty
};

/// Rows of ElasticOperator: result = A u + K known. `symmetric` applies them without a matrix, `thesis` by the
/// assembled one.
class ElasticKernel {
 public:
  /// Keeps references to the mesh and `rows`, which defines unknowns, known columns, vertices and materials.
  /// Collective.
  ElasticKernel(const mesh::Mesh& mesh, const ElasticOperator& rows, FaceGradientScheme scheme);
  ~ElasticKernel();
  ElasticKernel(ElasticKernel&&) noexcept;
  ElasticKernel& operator=(ElasticKernel&&) noexcept;

  /// Computes the product with rows and columns as in ElasticOperator. An empty `known` stands for zeros.
  /// Allocates only in the halo exchange. Collective.
  void apply(std::span<const double> unknowns, std::span<const double> known, std::span<double> result) const;
  /// Receives (face, gradient) of a flux face, entry (i, j) = d u_j / d x_i, with zero out-of-plane entries
  /// in 2-D.
  using TakeGradient = std::function<void(Index, const Tensor3&)>;
  /// Visits the flux faces [first, end). Collective.
  void face_gradients(std::span<const double> unknowns, std::span<const double> known,
                      const TakeGradient& take, Index first, Index end) const;
  /// Interpolates dim values per local point. Points without an owned cell are not changed. Collective.
  void point_values(std::span<const double> unknowns, std::span<const double> known,
                    std::span<double> points) const;
  FaceGradientScheme scheme() const { return scheme_; }
  bool is_symmetric() const { return scheme_ == FaceGradientScheme::symmetric; }

  /// The following functions add loads to the right-hand side, by the test functions of the kernel.
  /// Collective.
  ///
  /// Adds known forces [N] on boundary faces of owned cells, `dim` values per face. Forces that vary within faces
  /// have `dim` more values for each of 2 (2-D) or 4 corners of each face, after those of all faces: the difference
  /// between the corner's part and that of an even force. Returns the sum that this rank added.
  Vec3 add_face_forces(std::span<const double> forces, std::span<double> rhs) const;
  /// Adds forces [N] on owned cells, `dim` values each.
  void add_cell_forces(std::span<const double> forces, std::span<double> rhs) const;
  /// Means of the trace on these boundary faces of owned cells, `dim` values each, in the order of `faces`.
  /// They are work-conjugate to a known force. Only for the symmetric kernel without rings. Collective.
  void face_means(std::span<const Index> faces, std::span<const double> unknowns,
                  std::span<const double> known, std::span<double> means) const;
  /// Adds an isotropic stress - p I with p [Pa] per local face.
  void add_pressure(std::span<const double> pressure, std::span<double> rhs) const;

  /// Sets the density of the local cells [kg/m^3]. If it returns true, apply_with_mass() supports the
  /// consistent mass, and all nodes have inertia. Otherwise the mass of a cell is density times volume, and
  /// faces have none.
  bool set_density(std::span<const double> of_cells) const;
  /// Computes mass_factor M u, plus K u if requested. Requires that set_density() returned true. Collective.
  void apply_with_mass(std::span<const double> unknowns, std::span<const double> known, double mass_factor,
                       bool with_stiffness, std::span<double> result) const;
  /// Contribution of this rank to v . A u, including known values. Only for the symmetric kernel. Collective.
  double product(ElasticPart part, const ElasticField& u, const ElasticField& v) const;
  /// Reaction force on the body at each patch, from stress and loads; this rank's contribution. Only for the
  /// symmetric kernel. Collective.
  std::vector<Wrench> holding_forces(std::span<const double> unknowns, std::span<const double> known,
                                     const ElasticLoads& loads) const;
  /// Applies the mixed form [boffi2013] with fixed supports. Its further unknowns are the mean stresses p
  /// [Pa] of owned cells:
  ///   result = K' u + mass_factor M u + B^T p,  defect = B u - (V / K_P) p [m^3],  B u = V theta of cells
  /// K' is K without the bulk modulus K_P of the cells' volume strain (bulk_of_cells). If defect = 0, result
  /// = K u. Only for the symmetric kernel with ElasticOperator::volume_by_cells(). Collective.
  void apply_mixed(std::span<const double> unknowns, std::span<const double> pressure, double mass_factor,
                   std::span<double> result, std::span<double> defect) const;

 private:
  SymmetricSpace& filled(std::span<const double> unknowns, std::span<const double> known) const;
  SymmetricSpace& cleared() const;

  const ElasticOperator* rows_;
  FaceGradientScheme scheme_;
  std::unique_ptr<SymmetricKernel> symmetric_;  // one of these two is set
  std::unique_ptr<LeastSquares> least_squares_;
};

}  // namespace couplet::elastic
