// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/coupling/error_parts.hpp"
#include "common/coupling/participant.hpp"
#include "solid_solver/body/solid_body.hpp"
#include "solid_solver/body/solid_context.hpp"
#include "solid_solver/body/solid_fields.hpp"
#include "solid_solver/body/solid_interface.hpp"
#include "solid_solver/judge/error_estimate.hpp"
#include "solid_solver/judge/judge.hpp"
#include "solid_solver/motion/solid_stepper.hpp"

namespace couplet::solid {

class SolidOutput;

/// An elastic solid as a participant: its rooms, and in which order they are asked.
class Solid final : public Participant, public EstimatesError {
 public:
  /// Collective over mesh.comm.
  Solid(LoadedMesh body, SolidParameters parameters, SolidContext context);
  ~Solid() override;

  Interface initialise() override { return interface_.description(); }
  double suggest_dt() override {
    return body_.parameters().step_control ? stepper_.suggest_dt() : Participant::suggest_dt();
  }
  void begin_step(const Step& step) override;
  Exchange solve(const Exchange& in) override;
  StepReport accept_step() override;
  void save(CheckpointWriter& file) const override;
  void load(CheckpointReader& file) override;
  void write_output(double time, int number) override;
  void write_monitors(double time) override;
  std::vector<EffectVerdict> audit() const override;
  std::vector<std::string> finish() override;
  void collect_errors() override;
  ErrorParts error_parts() const override { return errors_ ? errors_->parts() : ErrorParts{}; }

  const SolidBody& body() const { return body_; }
  const SolidStepper& stepper() const { return stepper_; }
  const SolidFields& fields() const { return fields_; }
  const SolidJudge& judge() const { return judge_; }

 private:
  const SolidContext context_;
  SolidBody body_;
  const SolidInterface interface_;
  double dt_ = 0;  // of the step that was begun
  SolidStepper stepper_;
  const SolidFields fields_;
  SolidJudge judge_;
  std::optional<SolidErrorEstimate> errors_;  // none: not wanted
  std::unique_ptr<SolidOutput> output_;
};

}  // namespace couplet::solid
