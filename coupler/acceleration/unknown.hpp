// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <optional>
#include <span>
#include <utility>

#include "coupler/acceleration/accelerator.hpp"
#include "coupler/mapping/links.hpp"
#include "coupler/parameters/schedule.hpp"

namespace couplet::coupler {

/// Datum of the unknown, or of its dependents.
struct UnknownPart {
  std::size_t giver;
  coupling::Interface::Datum datum;
  int components = 1;
  std::size_t first = 0, count = 0;  ///< values of this rank, within `unknown` or `dependent`
  bool is_dependent = false;
  std::optional<std::size_t> velocity{};   ///< of a displacement: first value of its velocity in `dependent`
  double weight = 1;                       ///< of a dependent always 1
  bool scaled = false;                     ///< its weight is known
  bool needs_samples = false;              ///< somebody takes its values within the step
  std::optional<std::size_t> sample_of{};  ///< of a value within the step: the part of its end
  double share = 1;                        ///< of the step
};

/// Unknowns of a group's iteration: data that a participant takes before they are given in the same pass, and
/// data that a participant gives to itself. In serial order (Gauss-Seidel) these are the data given to
/// earlier members, in parallel order (Jacobi) all data of the group. A velocity beside a displacement of the
/// same giver is not an unknown, since it undergoes the same combinations. Several data are scaled to similar
/// size, each by its first nonzero values. If values within the step are requested (WithinStep), they are
/// unknowns as well, at the times seen in the first pass of a step, and follow all others.
class Unknown {
 public:
  using Part = UnknownPart;
  /// `group`: indices into `sides`.
  Unknown(MPI_Comm comm, const std::vector<Side>& sides, const Links& links,
          const std::vector<std::size_t>& group, bool side_by_side);

  /// Parts at the end of the step.
  std::span<const Part> parts() const { return {parts_.data(), n_parts_}; }

  /// Sets the times within the step from the given data, if some participant requests such values. Returns
  /// true if they changed.
  bool adopt_sample_times(const std::vector<coupling::Exchange>& given);
  /// Guess of a step from values at its end: constant within the step.
  Iterate start_step(Iterate guess);
  /// Replaces the values within the step by those at its end.
  Iterate hold_samples(Iterate x) const;
  /// Values at the end of the step.
  Iterate end_values(Iterate x) const;
  /// True if all data of the unknown have been given.
  bool complete(const std::vector<coupling::Exchange>& given) const;
  /// Converts between given data and scaled iterates, only for data of the unknown.
  Iterate gather(const std::vector<coupling::Exchange>& given) const;
  void scatter(const Iterate& x, std::vector<coupling::Exchange>& given) const;
  /// Sets displacements and their velocities to zero; other data have no natural start. Returns true if that
  /// is the whole unknown.
  bool start_at_rest(std::vector<coupling::Exchange>& given) const;
  /// The scales of data that have none yet and whose values are not all zero: what was gathered of them before
  /// was zero on any scale. Collective.
  void scale(const std::vector<coupling::Exchange>& given);
  /// The scales, and the times within the step.
  std::vector<double> weights() const;
  void restore_weights(const std::vector<double>& weights);

  /// Order by place numbers, optionally with the values within the step. Collective.
  IterateOrder order(bool within) const;

  /// Residual of each unknown (without dependents) over all ranks, including values within the step if x has
  /// them. Relative to the change |H(x) - x^n| since `start`, but no less than the part `least` of |H(x)|; to
  /// |H(x)| with an empty start. A residual d at the end of a step is an error 4 d/dt^2 of the acceleration,
  /// so that a part of the value itself would mean more noise the shorter the step. Collective.
  std::vector<Residual> measure(const Iterate& x, const Iterate& image, const Iterate& start = {},
                                double least = 1) const;
  /// Displacements in the unknown [m], this rank's part.
  std::vector<double> motion(const Iterate& x) const;

 private:
  bool needs_samples() const;
  bool has_samples() const { return parts_.size() > n_parts_; }
  void set_sample_times(const std::vector<std::pair<std::size_t, double>>& times);
  std::vector<double> interpolate_sample(const Part& part, const coupling::Exchange& given) const;

  MPI_Comm comm_;
  const std::vector<Side>* sides_;
  std::vector<Part> parts_;
  std::size_t n_parts_ = 0, n_unknown_ = 0, n_dependent_ = 0;  // of ends
  Iterate start_;  // ends at the start of the step; empty where nobody asks for values within it
};

/// Accepted steps kept for the predictor.
struct CouplingHistory {
  Iterate now, old, older;          ///< at t^n, t^{n-1}, t^{n-2}; empty if missing
  double old_dt = 0, older_dt = 0;  ///< t^n - t^{n-1}, t^{n-1} - t^{n-2}
  /// Adds an accepted step; keeps what a predictor of this order requires.
  void accepted(Iterate x, double dt, int order);
};

/// First guess for t^{n+1}, r = dt/old_dt (1 for constant steps). A displacement with its velocity:
///   order 0  eta* = eta^n                                               v* = v^n
///   order 1  eta* = eta^n + dt v^n                                      v* = v^n
///   order 2  eta* = eta^n + dt ((1 + r/2) v^n - r/2 v^{n-1})            v* = v^n + r (v^n - v^{n-1})
/// Other data: polynomial of this order through the last values. With fewer levels the order is lower.
Iterate predict(const Unknown& unknown, const CouplingHistory& history, double dt, int order);

}  // namespace couplet::coupler
