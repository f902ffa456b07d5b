// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/coupling/participant.hpp"
#include "common/diagnostics/error_parts.hpp"
#include "solid_solver/body/solid_body.hpp"
#include "solid_solver/body/solid_context.hpp"
#include "solid_solver/body/solid_fields.hpp"
#include "solid_solver/body/solid_interface.hpp"
#include "solid_solver/diagnostics/error_estimate.hpp"
#include "solid_solver/diagnostics/judge.hpp"
#include "solid_solver/motion/solid_stepper.hpp"
#include "solid_solver/output/quantities.hpp"

namespace couplet::solid {

class SolidOutput;

/// An elastic solid as a participant: its rooms, and in which order they are asked.
class Solid final : public coupling::Participant {
 public:
  /// Collective over mesh.comm.
  Solid(mesh::LoadedMesh body, SolidParameters parameters, SolidContext context);
  ~Solid() override;

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
  /// Those of the last step, after it.
  const std::vector<QuantityEstimate>& quantities() const { return quantities_; }
  std::vector<std::string> finish() override;
  /// Called before the first step if the run is to end with an estimate of its error.
  void collect_errors();
  /// Describes the accepted state, after the last step. Collective.
  diagnostics::ErrorParts error_parts() const;

  const SolidBody& body() const { return body_; }
  const SolidStepper& stepper() const { return stepper_; }
  const SolidFields& fields() const { return fields_; }
  const SolidJudge& judge() const { return judge_; }

 private:
  void estimate_quantities();
  const SolidContext context_;
  SolidBody body_;
  const SolidInterface interface_;
  double dt_ = 0;         // of the step that was begun
  bool is_last_ = false;  // likewise
  SolidStepper stepper_;
  const SolidFields fields_;
  SolidJudge judge_;
  std::optional<SolidErrorEstimate> errors_;  // none: not wanted
  std::unique_ptr<SolidOutput> output_;
  std::vector<QuantityEstimate> quantities_;      // of the state at the end of the run
  std::optional<diagnostics::ErrorParts> parts_;  // found by finish(), for the quantities; none: not yet
};

}  // namespace couplet::solid
