// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "coupler/parameters/parameters.hpp"

namespace couplet::coupler {

/// One coupling step as data: who takes part, in which order, how often.
///   [mover once or with each pass][group: one pass (explicit) or until it converges, one after the other
///   (Gauss-Seidel) or side by side (Jacobi)]
/// The fluid prepares its step (mesh, momentum predictor) in its first pass by itself: that part of the
/// semi-implicit scheme is the participants' (Step::scheme).
struct Schedule {
  std::vector<std::string> group;  ///< in the order of a pass
  bool side_by_side = false;
  bool iterates = true;
  std::optional<std::string> mover, moved;  ///< who moves the mesh, and of whom (one of the group)
  bool mesh_on_guess = false;               ///< moved in each pass, but to the same place: that of the first
  int predictor = 2;
  std::map<std::string, int> sub_steps;  ///< of those that take several
  bool waveform = true;                  ///< input of sub-steps as a line in time

  /// Everyone, the mover first: the fluid waits for its motion.
  std::vector<std::string> everyone() const;
  int sub_steps_of(const std::string& name) const;
};

/// Order of the prediction of the motion, 0 to 2. An exchange of one pass holds no motion and takes what was given last.
int predictor_order_of(const CouplingParameters& parameters);

/// The schedule that the roles or the exchange of `coupling:` stand for. Throws std::bad_optional_access without either.
Schedule schedule_of(const CouplingParameters& parameters);

/// Scheme of the next step. The semi-implicit scheme takes the friction of a wall at a guess of its velocity; where that
/// friction drags much of the moving mass, the fluid renews its prediction again and again within a step: that costs more
/// than iterating the whole step, leaves an oscillation, or does not converge at all. With `scheme: auto` these renewals are
/// counted, and from the step on in which they do not stop the steps are implicit, to the end of the run.
class SchemeChoice {
 public:
  explicit SchemeChoice(CouplingParameters::CaseScheme scheme)
      : is_open_(scheme.adapts), now_(scheme.first) {}
  coupling::Scheme now() const { return now_; }
  void start_step() { renewals_ = 0; }
  /// A pass in which a participant has begun to answer otherwise (Participant::answered_anew).
  void renewed() { ++renewals_; }
  /// After a step that ended at `time`: whether those that follow are implicit from here on, which is told.
  bool accepted(double time);
  /// After a step that failed: whether it is to be tried again as an implicit one, which now() then is. If that ends,
  /// tell(); if it fails as well, withdraw().
  bool failed();
  static void tell(double time, const std::string& why);
  void withdraw() { is_open_ = true, now_ = coupling::Scheme::semi_implicit; }

  /// For checkpoints: steps in a row with too many renewals (-1 once the steps are implicit), and the share of renewed ones.
  std::array<double, 2> state() const {
    return {now_ == coupling::Scheme::implicit ? -1. : in_a_row_, renewed_share_};
  }
  void restore(const std::array<double, 2>& state);

  /// Renewals within a step, and such steps in a row. A start from rest takes up to five, after which few are renewed
  /// (perpendicular flap of 42 kg/m^3 in a fluid of 1 Pa s); where it takes six, the implicit scheme costs the same or less
  /// (docs/validation/strong-coupling.md).
  static constexpr int too_many = 3, most_in_a_row = 6;
  /// Of the steps of late (exponential mean over so many) those with a renewal: what flips between renewed and not leaves an
  /// oscillation, small beside the load but not beside its smallest component (lift of FSI1: 10 %).
  static constexpr double most_renewed = 0.4, memory = 50;

 private:
  void turn();

  bool is_open_;
  coupling::Scheme now_;
  int renewals_ = 0, in_a_row_ = 0;
  double renewed_share_ = 0;
};

}  // namespace couplet::coupler
