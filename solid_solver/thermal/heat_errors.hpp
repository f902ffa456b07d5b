// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/diagnostics/error_parts.hpp"
#include "common/mesh/mesh.hpp"
#include "common/time/step_errors.hpp"
#include "solid_solver/thermal/heat.hpp"

namespace couplet::solid {

/// What a run of heat conduction leaves in its temperature, over the size of the temperature's variation: its distance from
/// the mean temperature before the first step, or of a steady field from its own mean.
///   mesh    the temperature against that of a linear fit through each cell's neighbours
///   step    sum of the local errors by the rates of the last three steps, see VelocityErrors; steady: none
/// Collective.
class HeatErrors {
 public:
  /// `mesh` by reference.
  HeatErrors(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const HeatParameters& parameters);
  /// Between solve and acceptance of a transient.
  void see_step(const HeatState& before, const HeatState& now);
  /// Of what was accepted; with `reference` [K] over the distance from that.
  diagnostics::ErrorParts parts(const Heat& heat, std::optional<double> reference = {}) const;
  /// For checkpoints, on the solid's mesh. Collective.
  void save(io::CheckpointWriter& file) const;
  void load(io::CheckpointReader& file);

 private:
  double root_mean_square(std::span<const double> cells) const;
  double mean(std::span<const double> cells) const;
  double size(std::span<const double> temperature, double level) const;
  std::vector<double> gaps(const Heat& heat) const;

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  bool steady_;
  double volume_ = 0, level_ = 0;  // of the body [m^3], before the first step [K]
  bool begun_ = false;
  std::vector<double> rate_;  // of the step before [K/s]; empty: not yet
  double dt_ = 0;             // of the step before; 0: not yet
  time::VelocityErrors steps_;
};

}  // namespace couplet::solid
