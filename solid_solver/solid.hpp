// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/coupling/participant.hpp"
#include "common/io/fields/field_writer.hpp"
#include "common/io/fields/surface_series.hpp"
#include "common/io/probes/probe.hpp"
#include "common/mesh/mesh.hpp"
#include "solid_solver/body/solid_interface.hpp"
#include "solid_solver/diagnostics/view.hpp"
#include "solid_solver/output/files.hpp"
#include "solid_solver/parameters/parameters.hpp"

namespace couplet::solid {

/// Elastic solid as a participant. Owns its parts and calls them in order.
class Solid final : public coupling::Participant {
 public:
  /// Collective over mesh.comm.
  Solid(mesh::LoadedMesh body, SolidParameters parameters, SolidContext context);

  coupling::Interface initialise() override { return interface_.description(); }
  double suggest_dt() override {
    return body_.parameters().step_control ? stepper_.suggest_dt() : coupling::Participant::suggest_dt();
  }
  void begin_step(const coupling::Step& step) override;
  coupling::Exchange solve(const coupling::Exchange& in) override;
  coupling::StepReport accept_step() override;
  double change() const override;
  void save(io::CheckpointWriter& file) const override;
  void load(io::CheckpointReader& file) override;
  void write_output(double time, int number) override;
  void write_monitors(double time) override;
  std::vector<std::string> finish() override;

  const SolidBody& body() const { return body_; }
  const SolidStepper& stepper() const { return stepper_; }
  const SolidFields& fields() const { return fields_; }
  SolidView view() const { return {body_, stepper_, fields_, output_, context_}; }

 private:
  void visit(io::Archive archive);

  const SolidContext context_;
  SolidBody body_;
  const SolidInterface interface_;
  SolidStepper stepper_;
  const SolidFields fields_;
  SolidOutput output_;
  const bool is_loaded_by_case_;  // alone: neither heat, which need not strain it, nor another program does
};

/// Solid that conducts heat and does not deform (`analysis: thermal`), without an elastic operator. Writes
/// the fields `temperature` and `cell-temperature`, probes.csv, and heat.csv with the heat flow through each
/// patch.
class ThermalSolid final : public coupling::Participant {
 public:
  /// Collective over mesh.comm.
  ThermalSolid(mesh::LoadedMesh body, SolidParameters parameters, SolidContext context);

  coupling::Interface initialise() override;
  void begin_step(const coupling::Step& step) override;
  coupling::Exchange solve(const coupling::Exchange& in) override;
  coupling::StepReport accept_step() override {
    heat_->accept_step();
    return {.dt = step_.dt};
  }
  double change() const override { return heat_->change(); }
  void save(io::CheckpointWriter& file) const override;
  void load(io::CheckpointReader& file) override;
  void write_output(double time, int number) override;
  void write_monitors(double time) override;

  const mesh::Mesh& mesh() const { return mesh_; }
  const Heat& heat() const { return *heat_; }
  HeatView view() const { return {*heat_, parameters_, context_}; }

 private:
  void write_surfaces(double time, std::span<const double> points);

  const mesh::Mesh mesh_;
  const mesh::Geometry geometry_;
  const SolidParameters parameters_;
  const SolidContext context_;
  std::unique_ptr<Heat> heat_;
  std::unique_ptr<coupling::InterfaceMap> map_;  // nullptr without a thermal interface
  std::optional<HeatInterface> interface_;
  coupling::Step step_;
  std::vector<io::Probe> probes_;
  std::optional<io::FieldWriter> fields_;
  std::optional<io::SurfaceSeries> surfaces_;
  bool surfaces_open_ = false;
  SeriesFiles series_;
};

}  // namespace couplet::solid
