// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "plate_modal/diagnostics/view.hpp"

namespace couplet::plate {

class PlateResults;

/// Structure by modal superposition as a participant. Takes forces on the faces of its surface, gives
/// displacement and velocity of its vertices.
class Structure final : public coupling::Participant {
 public:
  /// `raw`: mid-surface on rank 0 instead of the mesh in the parameters. Collective.
  Structure(Parameters parameters, PlateContext context, const mesh::RawMesh* raw = nullptr);
  ~Structure() override;

  coupling::Interface initialise() override;
  void begin_step(const coupling::Step& step) override { step_ = step; }
  coupling::Exchange solve(const coupling::Exchange& in) override;
  coupling::StepReport accept_step() override;
  void save(io::CheckpointWriter& file) const override;
  void load(io::CheckpointReader& file) override;
  void write_output(double time, int number) override;
  void write_monitors(double time) override;
  std::vector<std::string> finish() override;

  /// View for diagnostics. It refers to this structure, which must outlive it.
  PlateView view() const {
    return {parameters_, context_.comm, built_, surface_,      *oscillators_, contact_.get(), pressure_.get(),
            step_,       trial_,        state_, displacement_, deflection_,   fluid_force_};
  }
  const Parameters& parameters() const { return parameters_; }
  const PlateContext& context() const { return context_; }
  const Surface& surface() const { return surface_; }
  const ModalState& state() const { return state_; }
  const modes::ModalModel& model() const { return surface_.model(); }
  const Contact* contact() const { return contact_.get(); }
  const std::optional<Deflection>& deflection() const { return deflection_; }  ///< static analysis
  bool repeats() const { return repeats_; }  ///< the static solution of the previous step still holds
  const std::vector<double>& displacement() const { return displacement_; }  ///< [m], 3 a vertex

 private:
  std::vector<double> damping() const;
  ModalState initial_state() const;
  std::vector<double> received(const coupling::Exchange& in, const char* name) const;
  void make_contact();
  void refuse_wound_springs() const;
  void visit(io::Archive archive);
  void refuse_made_energy() const;
  void solve_static(double t, std::span<const double> fluid);
  std::vector<double> direct_deflection(double t) const;

  Parameters parameters_;
  PlateContext context_;
  Built built_;
  Surface surface_;
  std::unique_ptr<Contact> contact_;  // nullptr without a seat
  std::unique_ptr<Oscillators> oscillators_;
  std::unique_ptr<PressureLoad> pressure_;  // nullptr without prescribed pressures
  std::vector<double> gravity_;
  ModalState state_, trial_;
  // Displacements of the vertices [m], 3 each: at the accepted time, and in the last solve().
  std::vector<double> displacement_, trial_displacement_;
  std::vector<double> direct_;  // static deflection of the plate itself, 3 per vertex
  std::optional<Deflection> deflection_;
  std::vector<double> solved_;  // static analysis: modal coordinates of direct_ and deflection_
  bool repeats_ = false;
  coupling::Step step_;
  std::vector<double> fluid_force_;  // of a partner in the last solve(), 3 a face
  std::unique_ptr<PlateResults> results_;
};

}  // namespace couplet::plate
