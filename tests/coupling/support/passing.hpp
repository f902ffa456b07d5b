// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "common/coupling/participant.hpp"

namespace couplet::tests {

/// Passes all on to a participant (a reference or its own) but its output; a test overrides what it changes.
template <class Inner>
class Passing : public Participant {
 public:
  template <class... Arguments>
  explicit Passing(Arguments&&... arguments) : inner(std::forward<Arguments>(arguments)...) {}
  Interface initialise() override { return inner.initialise(); }
  void begin_step(const Step& step) override { inner.begin_step(step); }
  Exchange solve(const Exchange& in) override { return inner.solve(in); }
  StepReport accept_step() override { return inner.accept_step(); }
  void save(CheckpointWriter& file) const override { inner.save(file); }
  void load(CheckpointReader& file) override { inner.load(file); }
  void write_output(double, int) override {}
  void write_monitors(double) override {}

 protected:
  Inner inner;
};

}  // namespace couplet::tests
