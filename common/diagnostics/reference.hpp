// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>

namespace couplet::diagnostics {

/// Row of the table of references in reference.cpp.
struct ReferenceEntry {
  const char* name;   ///< "solid: energy supplied"
  bool forgets;       ///< false if it is compared with a sum over the run, which keeps what steps have added
  const char* floor;  ///< rounding of what is compared with it
};
/// All quantities that start at zero and by which guards, findings and errors divide.
std::span<const ReferenceEntry> references();

/// Largest value of such a quantity in the accepted steps. Differences within the rounding of what is compared are
/// zero, and the reference is at least that rounding. After a rejected step it only covers about the last quarter of the
/// time since then, because the steps before led to it.
class Reference {
 public:
  /// Throws std::logic_error if the table has no such name.
  explicit Reference(const char* name);
  /// Adds the value at the end of a step of `dt` [s].
  void add(double value, double dt);
  /// Call before the first step that is shorter than the one before, which has been rejected.
  void forget() {
    if (entry_->forgets) time_ = 0;
  }
  double value() const { return value_; }
  /// part / value, 0 within the rounding of `part`. Not a number if `part` is not.
  double share(double part, double rounding) const;

  /// Archives the members in checkpoints.
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(value_, time_);
  }

 private:
  const ReferenceEntry* entry_;
  double value_ = 0;
  // Since the last rejected step [s]; infinite without one.
  double time_ = std::numeric_limits<double>::infinity();
};

}  // namespace couplet::diagnostics
