// SPDX-License-Identifier: Apache-2.0
#pragma once

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

}  // namespace couplet::coupler
