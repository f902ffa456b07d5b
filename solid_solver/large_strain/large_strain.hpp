// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "common/elasticity/elastic_kernel.hpp"
#include "common/linalg/linear_solver.hpp"

namespace couplet {

class CheckpointReader;
class CheckpointWriter;

/// What large strain must reach: M m u + A(u) = b, and where it comes from.
struct LargeStrainLoad {
  std::span<const double> rows;   ///< b
  std::span<const double> known;  ///< columns of the operator; empty: zeros
  std::span<const double>
      before;                  ///< the known columns of the first guess, from which a first linear step leads
                               ///< to `known`; empty: the guess has them already
  double mass_factor = 0;      ///< m
  bool is_conserving = false;  ///< stress that keeps energy and momenta from the accepted state on
  std::span<const double> accepted{}, accepted_known{};  ///< the accepted state
  std::span<const double> inertia{};                     ///< per owned cell, m times mass; empty: static
  std::span<const double> node_inertia{};                ///< of the unknown nodes, of kernels with mass
};

/// How the equilibrium of a body at large strain is found, and what its stress is at a state. A state is the unknowns of
/// ElasticOperator with its known columns. All but name() collective.
class LargeStrain {
 public:
  virtual ~LargeStrain() = default;
  /// For the log.
  virtual std::string name() const = 0;
  /// A pressure [Pa] on boundary faces of owned cells, one each, that follows the surface.
  virtual void set_pressure(std::vector<double> of_faces) = 0;
  /// `u`: the first guess on entry. Throws SolveFailure, `u` being of no use then.
  virtual SolveStatistics solve(const LargeStrainLoad& load, std::span<double> u) = 0;
  /// Inner forces A(u), those of the pressure counted with the opposite sign.
  virtual std::vector<double> forces(std::span<const double> unknowns, std::span<const double> known) = 0;
  /// Strain energy over all ranks [J].
  virtual double energy(std::span<const double> unknowns, std::span<const double> known) = 0;
  /// Takes (face, F, P): F(i, j) = d x_i / d X_j, P the first Piola-Kirchhoff stress [Pa], of this rank's faces.
  using Take = std::function<void(Index, const Tensor3&, const Tensor3&)>;
  virtual void visit(std::span<const double> unknowns, std::span<const double> known, const Take& take) = 0;
  /// Resultant of the pressure at the state that was looked at last, this rank's [N].
  virtual Vec3 pressure_force() = 0;
  /// Force on the body at each patch at a state under these loads, with its moment where the body has moved to; this rank's part.
  virtual std::vector<Wrench> holding_forces(std::span<const double> unknowns, std::span<const double> known,
                                             const ElasticLoads& loads) = 0;
  /// The end of the step under way, which accept() makes the state that the next one begins at. Throws SolveFailure.
  virtual void end_step(std::span<const double>, std::span<const double>) {}
  virtual void accept() {}
  virtual void save(CheckpointWriter&) const {}
  virtual void load(CheckpointReader&, std::span<const double>, std::span<const double>) {}
};

/// What rounding leaves in the rows at least [N]: some last digits of the stiffness times the area of a face.
/// Collective.
double rounding_of_forces(const Mesh& mesh, const ElasticOperator& rows);
/// What the last digit of a displacement makes of forces, over that displacement [N/m]: a slender body moves by many times the distance
/// of its cells, and no equilibrium is nearer than the numbers are. Collective.
double rounding_of_motion(const Mesh& mesh, const ElasticOperator& rows);
/// The face with the smallest det F of all ranks, in words; `face` of this rank, -1: none is below 1. Collective.
std::string worst_cell(const Mesh& mesh, const Geometry& geometry, double ratio, Index face);

}  // namespace couplet
