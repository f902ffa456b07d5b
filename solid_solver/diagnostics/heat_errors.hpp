// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/diagnostics/error_parts.hpp"
#include "common/mesh/mesh.hpp"
#include "common/time/step_errors.hpp"
#include "solid_solver/thermal/heat.hpp"

namespace couplet::io {
class Archive;
}

namespace couplet::solid {

/// Root mean square over the volume of `width` values per owned cell. Collective.
double root_mean_square(const mesh::Mesh& mesh, const mesh::Geometry& geometry, int width,
                        std::span<const double> cells);

/// Error of the temperature in heat conduction, relative to its variation: the distance from the mean
/// temperature before the first step, or of a steady field from its own mean. Collective.
///   mesh    difference from a linear fit through each cell's neighbors
///   step    sum of local errors by the rates of the last three steps, see VelocityErrors; none if steady. Of one
///           or two steps, by the ratio of their changes, see of_first_steps()
class HeatErrors {
 public:
  /// Keeps a reference to `mesh`.
  HeatErrors(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const HeatParameters& parameters);
  /// Call after a step of a transient run.
  void see_step(const HeatState& before, const HeatState& now);
  /// Error of the accepted temperature. With `reference` [K], relative to the distance from it.
  diagnostics::ErrorParts parts(const Heat& heat, std::optional<double> reference = {}) const;
  /// Saves or loads data on the mesh of the solid. Collective.
  void visit(io::Archive& archive);

 private:
  double mean(std::span<const double> cells) const;
  double size(std::span<const double> temperature, double level) const;
  std::vector<double> gaps(const Heat& heat) const;
  double of_first_steps(const Heat& heat) const;

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  bool steady_;
  HeatParameters::Scheme scheme_;
  double level_ = 0;  // before the first step [K]
  bool begun_ = false;
  std::vector<double> rate_;  // of the previous step [K/s]; empty if none
  double dt_ = 0;             // of the previous step; 0 if none
  time::VelocityErrors steps_;
};

}  // namespace couplet::solid
