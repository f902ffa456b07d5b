// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "common/coupling/error_parts.hpp"
#include "common/coupling/participant.hpp"
#include "common/time/step_errors.hpp"
#include "plate_modal/model/build_model.hpp"
#include "plate_modal/motion/contact.hpp"
#include "plate_modal/motion/oscillators.hpp"
#include "plate_modal/motion/pressure_load.hpp"
#include "plate_modal/motion/resolution.hpp"
#include "plate_modal/motion/share.hpp"
#include "plate_modal/truncation.hpp"

namespace couplet::plate {

class PlateResults;

/// A structure by superposition of its modes, as a participant: takes the forces on the faces of its surface,
/// gives displacement and velocity of its vertices.
class Structure final : public coupling::Participant, public coupling::EstimatesError {
 public:
  /// `raw`: mid-surface on rank 0 in place of the mesh that the parameters name. Collective.
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
  std::vector<effects::EffectVerdict> audit() const override;
  std::vector<std::string> finish() override;
  void collect_errors() override { step_errors_.emplace(parameters_.time_scheme); }
  coupling::ErrorParts error_parts() const override;

  const Parameters& parameters() const { return parameters_; }
  const PlateContext& context() const { return context_; }
  const Share& share() const { return *share_; }
  const ModalState& state() const { return state_; }
  const modes::ModalModel& model() const { return built_.model; }  ///< on rank 0
  const Contact* contact() const { return contact_.get(); }
  /// Static analysis: largest deflections of the plate itself and by its modes, largest difference [m]; rank
  /// 0.
  struct Deflection {
    double direct = 0, by_modes = 0, apart = 0;
  };
  const std::optional<Deflection>& deflection() const { return deflection_; }
  bool repeats() const { return repeats_; }  ///< of a static analysis: the answer of the step before
  /// Displacement of every vertex now [m], 3 each, on rank 0. Collective.
  std::vector<double> displacement() const;

 private:
  std::vector<double> damping() const;
  ModalState initial_state() const;
  void make_contact();
  void refuse_wound_springs() const;
  void add_pressure(double t, std::span<double> load);
  void look_at_step();
  void find_rotations();
  void look_at_rotation();
  double in_plane_share() const;
  void refuse_made_energy() const;
  void solve_static(double t, std::span<const double> fluid);
  std::vector<double> direct_deflection(double t) const;
  std::vector<double> cell_pressures(double t) const;
  void take_fluid(const coupling::Exchange& in);
  void look_at_modes();
  void look_at_pressure(double t);
  double mesh_gap() const;

  Parameters parameters_;
  PlateContext context_;
  Built built_;
  std::unique_ptr<Share> share_;
  std::unique_ptr<Contact> contact_;  // none: no seat in this scene
  std::unique_ptr<Oscillators> oscillators_;
  std::unique_ptr<PressureLoad> pressure_;           // none: no pressures of the case
  std::unique_ptr<Resolution> resolution_;           // of a dynamic analysis
  std::optional<time::VelocityErrors> step_errors_;  // of modes of unit mass; none: not wanted
  std::vector<double> gravity_;
  ModalState state_, trial_;
  std::vector<double> direct_;  // static deflection of the plate itself, 3 a vertex on rank 0
  std::optional<Deflection> deflection_;
  std::vector<double> solved_;  // static analysis: the modes that direct_ and deflection_ belong to
  bool repeats_ = false;
  coupling::Step step_;
  double worst_mismatch_ = 0, largest_exchange_ = 0;
  double largest_true_ = 0;  // largest energy that the scheme did not make, or work of the loads [J]
  double largest_ = 0, trial_largest_ = 0;  // displacement of any vertex [m], on rank 0
  std::vector<Vec3> rotations_;             // of each mode [1/(sqrt(kg) m)]; empty: none is a rigid motion
  std::unique_ptr<Truncation> truncation_;  // of a mesh in a dynamic analysis, on rank 0
  std::vector<double> fluid_pressure_;      // of the last solve, a cell, on rank 0; empty: no fluid
  bool load_acted_ = false;                 // a prescribed pressure was not 0 somewhere
  std::vector<double> within_{0, 0};  // what the midpoint rule misses of prescribed pressures, on rank 0
  LoadOnModes on_modes_;              // of prescribed pressures, on rank 0
  bool met_seat_ = false;             // contact did work
  bool finished_ = false;             // no step will follow
  double largest_rotation_ = 0;       // of the body as a whole [rad]
  std::unique_ptr<PlateResults> results_;
};

}  // namespace couplet::plate
