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

namespace couplet::io {
class Archive;
}

namespace couplet::solid {

/// Equilibrium of a body at large strain, and the stress at a state.
class LargeStrain : public Equilibrium {
 public:
  /// Keeps references.
  LargeStrain(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows)
      : mesh_(mesh), geometry_(rows.geometry()), rows_(rows) {}

  /// Name for the log.
  virtual std::string name() const = 0;
  /// Sets the pressures that remain normal to the moving surface and so are part of A [Pa], one value per boundary face of owned cells.
  virtual void set_pressure(std::vector<double> of_faces) = 0;
  /// Resultant of the pressures at the last evaluated state on this rank [N].
  virtual Vec3 pressure_force() const = 0;
  /// Saves or loads what the accepted state adds to these unknowns and known columns.
  virtual void visit(io::Archive& archive, std::span<const double> unknowns,
                     std::span<const double> known) = 0;

  std::vector<Tensor3> face_stress(const Displaced& state, Index first, Index count) override;
  std::vector<Tensor3> cell_stress(const Displaced& state) override;

  /// Called with (face, F, P) for this rank's faces: F(i, j) = d x_i/d X_j, first Piola stress P [Pa].
  using Take = std::function<void(Index, const Tensor3&, const Tensor3&)>;
  virtual void visit(std::span<const double> unknowns, std::span<const double> known, const Take& take) = 0;

 protected:
  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const elastic::ElasticOperator& rows_;
};

/// Smallest round-off in the rows [N]: a few last digits of the stiffness times a face area. Collective.
double rounding_of_forces(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows);
/// Round-off of forces per unit of displacement [N/m]. A slender body moves by many cell sizes, so no
/// equilibrium is more accurate than the round-off of its displacement. Collective.
double rounding_of_motion(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows);
/// Describes the face with the smallest det F of all ranks. `face`: a face of this rank, or -1. Collective.
std::string worst_cell(const mesh::Mesh& mesh, const mesh::Geometry& geometry, double ratio, Index face);

/// Reports a free face next to a fixed one that has moved beyond the plane of the fixed one. A compressed bonded block folds onto its
/// platens there, the earlier the finer the mesh, but contact with them is not modeled. Returns a description with the patch and the
/// distance; empty if there is none. `displacement`: returns the displacement of a local node (cells, then boundary faces). Collective.
std::string folded_support(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows,
                           const std::function<Vec3(Index)>& displacement);

/// Checks that a static step stayed on its path of equilibria. On a smooth path each cell moves by an amount
/// between those of the tangents at both ends of the step. Past a limit point of the body or of some cells,
/// Newton's method converges, if at all, to an equilibrium beyond both.
class StepJump {
 public:
  /// `u`: unknowns of the last equilibrium, `dim` per node.
  void start(std::span<const double> u, int dim);
  /// Sets the thermal stretches of the faces. Their change over the step times the length of the body [m] is
  /// ignored, because a body that expands unevenly by a fifth moves by as much beyond its tangents.
  void set_stretch(std::vector<double> of_faces) { stretch_ = std::move(of_faces); }
  /// Marks the present stretches as those of an equilibrium.
  void settle() { settled_ = stretch_; }
  /// `u`: unknowns before the first iteration. `correction`: correction by that iteration.
  void predict(std::span<const double> u, std::span<const double> correction);
  /// Maps the previous equilibrium to the motion for the same load by the new tangent. Throws SolveFailure.
  using Backward = std::function<std::vector<double>(std::span<const double> before)>;
  /// Checks the new equilibrium `u`. Throws SolveFailure if it lies beyond both tangents; a shorter step
  /// may succeed. `length`: length of the body [m]. Calls `backward` only beyond the first tangent. Collective.
  void end(MPI_Comm comm, std::span<const double> u, double length, const Backward& backward);

 private:
  double beyond(MPI_Comm comm, std::span<const double> u, std::span<const double> later, double growth) const;

  double largest_growth(double length) const;

  std::vector<double> before_, predicted_, stretch_, settled_;
  std::size_t dim_ = 3;
};

}  // namespace couplet::solid
