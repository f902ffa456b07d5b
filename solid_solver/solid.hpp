// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/coupling/participant.hpp"
#include "solid_solver/body/solid_interface.hpp"
#include "solid_solver/diagnostics/view.hpp"

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
  const SolidContext context_;
  SolidBody body_;
  const SolidInterface interface_;
  SolidStepper stepper_;
  const SolidFields fields_;
  SolidOutput output_;
  const bool is_loaded_by_case_;  // alone: neither heat, which need not strain it, nor another program does
};

}  // namespace couplet::solid
