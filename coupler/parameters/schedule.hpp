// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "coupler/parameters/parameters.hpp"

namespace couplet::coupler {

/// Description of one coupling step: participants, order and iterations.
///   [mover once or in each pass][group: one pass (explicit) or until convergence, in sequence (Gauss-Seidel)
///   or in parallel (Jacobi)]
/// The fluid itself prepares its step (mesh, momentum predictor) in its first pass. This part of the
/// semi-implicit scheme belongs to the participants (Step::scheme).
struct Schedule {
  std::vector<std::string> group;  ///< in the order of a pass
  bool side_by_side = false;
  bool iterates = true;
  std::optional<std::string> mover, moved;  ///< participant that moves the mesh, and the one whose mesh it is
  bool mesh_on_guess = false;               ///< moved in each pass to the same position, that of the first
  bool loads_at_rest = false;               ///< pressures act on the undeformed surface of a linear structure
  int predictor = 2;
  std::map<std::string, int> sub_steps;  ///< of participants with several

  /// All participants with the mover first, because the fluid waits for its motion.
  std::vector<std::string> everyone() const;
  int sub_steps_of(const std::string& name) const;
};

/// Order of the motion predictor, 0 to 2. An exchange with one pass has none and uses the last values.
int predictor_order_of(const CouplingParameters& parameters);

/// Schedule for the roles or the exchange of `coupling:`. Throws std::bad_optional_access without either.
Schedule schedule_of(const CouplingParameters& parameters);

/// Scheme of the next step. The semi-implicit scheme computes wall friction with a guessed velocity. If
/// friction drags much of the moving mass, the fluid repeats its prediction within a step. This costs more
/// than iterating the whole step, and may oscillate or diverge. `scheme: auto` counts these renewals, repeats a failed
/// step as an implicit one, and becomes implicit for the rest of the run once neither stops.
class SchemeChoice {
 public:
  explicit SchemeChoice(CouplingParameters::CaseScheme scheme)
      : is_open_(scheme.adapts), now_(scheme.first) {}
  coupling::Scheme now() const { return now_; }
  void start_step() { renewals_ = 0; }
  /// Counts a pass in which a participant renewed its prediction (Participant::renewed_prediction).
  void count_renewal() { ++renewals_; }
  /// Call after a step that ended at `time`. Returns true if the next step has another scheme; reports it if all have.
  bool accepted(double time);
  /// Call after a failed step. Returns true if it must be repeated as an implicit one, set in now() until accepted().
  /// Call withdraw() if that fails, too.
  bool failed();
  void withdraw() { now_ = coupling::Scheme::semi_implicit; }

  /// Data for checkpoints: consecutive steps with too many renewals (-1 once implicit), share renewed.
  std::array<double, 2> state() const {
    return {now_ == coupling::Scheme::implicit ? -1. : in_a_row_, renewed_share_};
  }
  void restore(const std::array<double, 2>& state);

  /// Limits: renewals within a step, and consecutive steps with so many.
  /// A start from rest takes up to five (perpendicular flap of 42 kg/m^3 in a fluid of 1 Pa s). If it takes six, the
  /// implicit scheme costs no more (docs/validation/strong-coupling.md). A failed step counts as two of them.
  static constexpr int too_many = 3, most_in_a_row = 6;
  /// Limit of the recent share of steps with renewals (exponential mean). Alternating renewals leave an
  /// oscillation that is small relative to the load but not to its smallest component (lift of FSI1: 10 %).
  static constexpr double most_renewed = 0.4, memory = 50;

 private:
  bool is_open_;
  coupling::Scheme now_;
  int renewals_ = 0, in_a_row_ = 0;
  double renewed_share_ = 0;
};

}  // namespace couplet::coupler
