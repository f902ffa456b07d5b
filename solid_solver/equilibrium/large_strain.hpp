// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/elasticity/elastic_kernel.hpp"
#include "common/elasticity/elasticity.hpp"
#include "common/mesh/mesh.hpp"
#include "solid_solver/equilibrium/equilibrium.hpp"

namespace couplet::solid {

/// How the equilibrium of a body at large strain is found, and what its stress is at a state.
class LargeStrain : public Equilibrium {
 public:
  /// By reference.
  LargeStrain(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows)
      : mesh_(mesh), geometry_(rows.geometry()), rows_(rows) {}

  /// Relative already.
  double share_left(double residual, double) const override { return residual; }
  void to_strain(std::span<Tensor3> gradients) const override;
  std::vector<Tensor3> face_stress(const Displaced& state, Index first, Index count) override;
  std::vector<Tensor3> cell_stress(const Displaced& state) override;
  std::span<const Vec3> surface(std::span<const Vec3> moved) const override { return moved; }

  /// Takes (face, F, P): F(i, j) = d x_i / d X_j, P the first Piola-Kirchhoff stress [Pa], of this rank's faces.
  using Take = std::function<void(Index, const Tensor3&, const Tensor3&)>;
  virtual void visit(std::span<const double> unknowns, std::span<const double> known, const Take& take) = 0;

 protected:
  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const elastic::ElasticOperator& rows_;
};

/// What rounding leaves in the rows at least [N]: some last digits of the stiffness times the area of a face.
/// Collective.
double rounding_of_forces(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows);
/// What the last digit of a displacement makes of forces, over that displacement [N/m]: a slender body moves by many times the distance
/// of its cells, and no equilibrium is nearer than the numbers are. Collective.
double rounding_of_motion(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows);
/// The face with the smallest det F of all ranks, in words; `face` of this rank, -1: none is below 1. Collective.
std::string worst_cell(const mesh::Mesh& mesh, const mesh::Geometry& geometry, double ratio, Index face);

/// Whether a free face beside a fixed one has moved beyond its plane: a bonded block that is compressed folds onto its
/// platens there from some compression on, the earlier the finer the mesh, and what it would touch is no part of the
/// body. In words with the patch and how far; empty: it has not. `displacement` of a local node (cells, then boundary
/// faces). Collective.
std::string folded_support(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows,
                           const std::function<Vec3(Index)>& displacement);

/// Whether a static step can have stayed on its path of equilibria. On a smooth path each cell moves by something between what the tangents
/// at the two ends of the step give for its load; past a limit point, of the body or of some cells, Newton's method converges, if at all, to an
/// equilibrium beyond both.
class StepJump {
 public:
  /// `u`: unknowns of the last equilibrium, `dim` per node.
  void start(std::span<const double> u, int dim);
  /// Thermal stretches of the faces from now on. What they change by over the step, times the length of the body [m], is left out of account:
  /// a body that grows unevenly by a fifth moves by as much beside its tangents.
  void set_stretch(std::vector<double> of_faces) { stretch_ = std::move(of_faces); }
  /// The present stretches are those of an equilibrium.
  void settle() { settled_ = stretch_; }
  /// `u`, the unknowns before the first iteration, `correction` that iteration's.
  void predict(std::span<const double> u, std::span<const double> correction);
  /// Takes the equilibrium before; gives the motion for the same load by the tangent at the new one. Throws SolveFailure.
  using Backward = std::function<std::vector<double>(std::span<const double> before)>;
  /// `u`: the new equilibrium. Throws SolveFailure where it lies beyond both: a shorter step either finds the soft states between or shows
  /// that there is no equilibrium. `length` of the body [m]. Calls `backward` only if the motion is beyond the tangent before. Collective.
  void end(MPI_Comm comm, std::span<const double> u, double length, const Backward& backward);

 private:
  double beyond(MPI_Comm comm, std::span<const double> u, std::span<const double> later, double growth) const;

  double largest_growth(double length) const;

  std::vector<double> before_, predicted_, stretch_, settled_;
  std::size_t dim_ = 3;
};

}  // namespace couplet::solid
