// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <optional>
#include <string>
#include <vector>

#include "common/base/types.hpp"
#include "common/coupling/error_parts.hpp"
#include "common/effects/position.hpp"
#include "common/effects/verdict.hpp"
#include "coupler/acceleration/unknown.hpp"
#include "coupler/mapping/links.hpp"
#include "coupler/parameters/effect_cards.hpp"

namespace couplet::coupler {

/// What a coupling has left out, found while it runs.
class CouplingAudit {
 public:
  /// Forces that a side gives and nobody takes are found here; without such nothing is computed later.
  CouplingAudit(MPI_Comm comm, const std::vector<Side>& sides, const Links& links);

  /// The explicit scheme leaves the answer of the load out. Two further passes of a few steps tell how much of a
  /// change of the motion comes back through the load in the next pass, |H(H(x)) - H(x)| / |H(x) - x|: with an
  /// added mass alone that is added mass over structural mass (Causin, Gerbeau and Nobile 2005). What the step
  /// gives is that of the first pass, as without.
  /// Whether this step is looked at: 4, 16, 64, 256, ... (log4 n of n steps, two passes each).
  static bool looks_at(GlobalIndex step);
  /// The second step is looked at, too, for one question only: why a step failed. At a start the ratio is that of an
  /// impulse, which is no evidence about the run.
  static bool looks_for_causes_at(GlobalIndex step) { return step == 1 || looks_at(step); }
  void returned_at_start(const Residual& first, const Residual& second);
  /// Why one pass a step cannot hold, if more of a change returns than it bears: no smaller step helps (the ratio of
  /// the masses does not depend on the step).
  std::optional<std::string> suspects(const CouplingParameters& parameters) const;
  /// Residuals of x and of H(x). Nothing is learnt where the guess was so good that their difference is round-off.
  void returned(const Residual& first, const Residual& second);

  /// What all have given in an accepted step. Collective.
  void loads(const std::vector<coupling::Exchange>& given);

  const CouplingEvidence& evidence() const { return evidence_; }
  /// Of a change of the motion what one pass returns, and what the scheme bears; without evidence that of the start.
  std::vector<effects::Coordinate> position(const CouplingParameters& parameters) const;
  /// The verdicts that the coupling's cards give; those that turn bad are told once.
  void tell(const CouplingParameters& parameters, double time);
  /// `with_sound`: else only those that were not: what a failed run saw until then proves nothing sound.
  void tell_at_end(const CouplingParameters& parameters, bool with_sound) const;
  /// The coupling's own part of the model's error.
  coupling::ErrorParts parts(const CouplingParameters& parameters) const;

 private:
  struct Force {
    std::size_t giver;
    std::string name;
    bool taken;
  };
  MPI_Comm comm_;
  std::vector<Force> forces_;  // of sides of which one is not taken
  double lost_ = 0,
         taken_ = 0;  // sums of their squares over the run, where nobody takes them and where somebody does
  CouplingEvidence evidence_;
  double at_start_ = CouplingEvidence::unknown;
  effects::AuditTrail trail_;
};

}  // namespace couplet::coupler
