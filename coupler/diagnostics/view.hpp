// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/app/loop/step_loop.hpp"
#include "common/coupling/participant.hpp"
#include "common/diagnostics/diagnostics.hpp"
#include "common/diagnostics/reference.hpp"
#include "common/parallel/index_map.hpp"
#include "coupler/acceleration/unknown.hpp"
#include "coupler/output/record.hpp"
#include "coupler/parameters/schedule.hpp"
#include "coupler/pass.hpp"

namespace couplet::coupler {

/// Watches the residuals of one step, to detect divergence within a few passes.
class ResidualGrowth {
 public:
  void start_step() { *this = {}; }
  /// Call after each pass with |r| (any fixed norm) and the factor of its x. Throws SchemeFailure if constant
  /// relaxation diverges due to added mass; each mode's error has the factor 1 - omega (1 + r) [Causin,
  /// Gerbeau and Nobile 2005], so smaller steps do not help. Throws SolveFailure if an accelerated residual
  /// grows over `patience` passes or by `too_far` in total.
  void pass(double residual, double omega, AccelerationParameters::Type type);

  /// Call after a pass that a participant could not answer. Returns a reason if the residual was growing: a
  /// diverging motion folds a mesh before `patience` passes are over. `relaxation`: the constant one, or 0.
  /// `predictor`: its order.
  std::optional<std::string> suspects(double relaxation, int predictor) const;

  static constexpr int patience = 5;
  static constexpr double too_far = 1e6;

 private:
  bool grows() const;
  double factor() const;  // per pass

  double first_ = 0, last_ = 0;
  int passes_ = 0, growing_ = 0;
  double at_turn_ = 0;  // residual at which the growth began
};

/// Detects the two-step oscillation of loosely coupled schemes in the accepted motion. The velocity jumps d_n
/// = (x^{n+1} - x^n)/dt_n - (x^n - x^{n-1})/dt_{n-1} then alternate, grow, and are as large as the velocity.
/// Variable steps do not hide it. Explicit added mass has the factor -r per step (r: added mass over the
/// structure's) for any step size. Growth is distinguished from two frequencies that beat: it lasts at least three periods, does not slow
/// down, and exceeds all swings before it.
class StepOscillation {
 public:
  /// `comm`: communicator over whose ranks the motion is distributed. `tolerance`: tolerance of the coupling, relative to the
  /// largest motion of the run. Swings below it or below `floor` are not part of the answer.
  explicit StepOscillation(MPI_Comm comm = MPI_COMM_SELF, double tolerance = 0)
      : comm_(comm), tolerance_(tolerance) {}
  /// The motion x of an accepted step of length dt, this rank's part. A reason if it oscillates, else
  /// nothing.
  std::optional<std::string> accepted(const std::vector<double>& x, double dt, coupling::Scheme scheme);
  /// Call after a failed step. Returns a reason if the accepted steps before it had begun to oscillate.
  std::optional<std::string> suspects(coupling::Scheme scheme) const;
  /// Number of consecutive steps in which the motion has reversed.
  int turns() const { return turns_; }

  /// Data for checkpoints: values equal on all ranks, and `count` values of the motion from `first` on, in
  /// order.
  void visit_numbers(io::Archive& archive);
  void visit_fields(io::Archive& archive, const parallel::GlobalOrder& order, const std::string& name,
                    std::size_t first, std::size_t count, std::size_t width);

  static constexpr double floor = 1e-3;
  static constexpr int periods = 3;

 private:
  std::string message(double growth, coupling::Scheme scheme) const;
  double pair(std::size_t i) const;
  double share() const;  // amplitude over the largest motion
  bool counts() const;   // the swings are part of the answer and larger than all before

  MPI_Comm comm_;
  double tolerance_;
  diagnostics::Reference largest_{"coupling: motion of the interface"};  // norm of x
  std::vector<double> x_, velocity_, jump_;
  int turns_ = 0, levels_ = 0;  // levels: number of known accepted states
  std::vector<double> sizes_;   // of the differences since the oscillation began
  std::deque<double> speed_;    // of the last steps
  diagnostics::Reference before_{
      "coupling: swings of the interface"};  // pair of sizes in oscillations before
  double dt_ = 0;                            // last step
};

/// Compares the work on both sides of the interface, which differs only by the coupling error.
class WorkBalance {
 public:
  /// Adds the work of a step on both sides [J].
  void accepted(double fluid, double structure);
  /// Result at the end of the run: a sentence with numbers, and whether the balance is sound.
  struct WorkResult {
    bool sound = true;
    std::string text;
    double part = 0;  ///< difference relative to the net work or energy
    bool useless = false;
  };
  /// Compares the difference with the smaller net work, or with the structure's largest energy if that is
  /// larger, because work that is returned hides nothing. `by_nearest`: nearest mapping of motion and load.
  /// `lagging`: one pass per step. The fluid then sees an extrapolated wall whose velocity jitters, so loads
  /// alternate and the works differ even if the motion is accurate to parts in a thousand. Such a result is
  /// not called useless.
  WorkResult result(bool by_nearest = false, bool lagging = false) const;
  /// Adds the structures' energy after a step [J]; NaN if unknown. Until then the largest net work taken is
  /// used.
  void energy(double value) { energy_ = value > energy_ ? value : energy_; }

  /// Data for checkpoints.
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(fluid_, structure_, exchanged_, steps_, energy_, stored_);
  }

  /// Limits of the difference: sound below the first, relative to net work or energy; useless above the
  /// second, relative to all work exchanged. The latter needs this many steps, because the first steps of a
  /// motion differ more.
  static constexpr double sound_part = 0.05, useless_part = 0.5;
  static constexpr long judged_steps = 20;

 private:
  double fluid_ = 0, structure_ = 0, exchanged_ = 0;  // sums over the run; exchanged: of the larger |work|
  double energy_ = 0, stored_ = 0;  // largest energy of the structures; largest net work taken
  long steps_ = 0;
};

/// State of a coupled run after the last solved or accepted step, as diagnostics see it.
struct CouplingView {
  MPI_Comm comm;
  const CouplingParameters& parameters;
  const Pass& pass;
  const Unknown& unknown;
  const Record& record;
  const SchemeChoice& scheme;
  const FixedPointResult& last;    ///< of the last solved step
  const CouplingHistory& history;  ///< up to the previous step
  const double& dt;                ///< of the last step [s]
};

/// Diagnostic that also observes the passes of a step. What it learns there is discarded unless the step is
/// accepted.
class CouplingDiagnostic : public diagnostics::Diagnostic {
 public:
  virtual void begin_step() {}
  /// Participant `side` has answered in a pass.
  virtual void received(std::size_t /*side*/, const coupling::Exchange& /*taken*/,
                        const coupling::Exchange& /*given*/) {}
  /// A pass of an iteration is over; `omega` led to its x. Throws SolveFailure where the iteration runs away.
  virtual void passed(const std::vector<Residual>& /*residuals*/, double /*omega*/) {}
  /// Passes of explicit coupling, in a few steps: the pass from x gave `image`, another one from there `again`.
  virtual void returned(GlobalIndex /*step*/, const Iterate& /*x*/, const Iterate& /*image*/,
                        const Iterate& /*again*/) {}
  /// Cause of a failed step, if this diagnostic knows it.
  virtual std::optional<app::StepFailure> suspects() const { return {}; }
  /// Remark after the reason of a failed step of unknown cause; may be empty.
  virtual std::string remark() const { return {}; }
  /// Reason to stop after the last accepted step; empty to continue.
  virtual std::string stop() const { return {}; }
};

using CouplingDiagnostics = std::vector<std::shared_ptr<CouplingDiagnostic>>;

// Each makes a diagnostic, or nullptr if it does not apply to the coupling.
std::shared_ptr<CouplingDiagnostic> iteration_growth(const CouplingView& view);
std::shared_ptr<CouplingDiagnostic> added_mass(const CouplingView& view);
std::shared_ptr<CouplingDiagnostic> interface_oscillation(const CouplingView& view);
std::shared_ptr<CouplingDiagnostic> interface_work(const CouplingView& view);
std::shared_ptr<CouplingDiagnostic> data_of_participants(const CouplingView& view);
std::shared_ptr<CouplingDiagnostic> structure_at_rest(const CouplingView& view);
std::shared_ptr<CouplingDiagnostic> unconverged_step(const CouplingView& view);
std::shared_ptr<CouplingDiagnostic> lost_load(const CouplingView& view);
std::shared_ptr<CouplingDiagnostic> coupling_error(const CouplingView& view);

/// Creates all diagnostics of a coupling in the order of their causes, and adds them to `all`.
CouplingDiagnostics coupling_diagnostics(const CouplingView& view, diagnostics::Diagnostics& all);

}  // namespace couplet::coupler
