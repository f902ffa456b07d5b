// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/coupling/participant.hpp"
#include "common/diagnostics/error_parts.hpp"
#include "common/io/fields/field_writer.hpp"
#include "common/io/fields/surface_series.hpp"
#include "common/io/probes/probe.hpp"
#include "common/io/series.hpp"
#include "common/mesh/mesh.hpp"
#include "solid_solver/body/solid_context.hpp"
#include "solid_solver/output/quantities.hpp"
#include "solid_solver/parameters/parameters.hpp"
#include "solid_solver/thermal/heat.hpp"
#include "solid_solver/thermal/heat_errors.hpp"

namespace couplet::solid {

/// A solid that conducts heat and does not deform (`analysis: thermal`): no elastic operator is built.
/// Writes the fields `temperature` and `cell-temperature`, probes.csv, and heat.csv with the heat through
/// each patch.
class ThermalSolid final : public coupling::Participant {
 public:
  /// Collective over mesh.comm.
  ThermalSolid(mesh::LoadedMesh body, SolidParameters parameters, SolidContext context);

  coupling::Interface initialise() override;
  void begin_step(const coupling::Step& step) override;
  coupling::Exchange solve(const coupling::Exchange& in) override;
  coupling::StepReport accept_step() override {
    if (errors_) errors_->see_step(heat_->accepted(), heat_->trial());
    heat_->accept_step();
    return {.dt = step_.dt};
  }
  void save(io::CheckpointWriter& file) const override;
  void load(io::CheckpointReader& file) override;
  /// Called before the first step if the run is to end with an estimate of its error.
  void collect_errors() { errors_.emplace(mesh_, geometry_, parameters_.heat.value()); }
  /// Describes the accepted state, after the last step. Collective.
  diagnostics::ErrorParts error_parts() const {
    return errors_ ? errors_->parts(*heat_) : diagnostics::ErrorParts{};
  }
  void write_output(double time, int number) override;
  void write_monitors(double time) override;
  std::vector<std::string> finish() override;

  const mesh::Mesh& mesh() const { return mesh_; }
  const Heat& heat() const { return *heat_; }
  /// Of the last step, after finish().
  const std::vector<QuantityEstimate>& quantities() const { return quantities_; }

 private:
  void write_probes(double time);
  void write_heat(double time);
  void write_surfaces(double time, std::span<const double> points);

  const mesh::Mesh mesh_;
  const mesh::Geometry geometry_;
  const SolidParameters parameters_;
  const SolidContext context_;
  std::unique_ptr<Heat> heat_;
  std::optional<HeatErrors> errors_;  // none: not wanted
  coupling::Step step_;
  std::vector<QuantityEstimate> quantities_;
  std::vector<io::Probe> probes_;
  std::optional<io::FieldWriter> fields_;
  std::optional<io::SurfaceSeries> surfaces_;
  bool surfaces_open_ = false;
  std::optional<io::Series> probe_series_, heat_series_;  // on rank 0
};

}  // namespace couplet::solid
