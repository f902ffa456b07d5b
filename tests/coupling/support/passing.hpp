// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/coupling/participant.hpp"
#include "tests/support/test.hpp"

namespace couplet::tests {

/// Passes all on to a participant (a reference or its own) but its output; a test overrides what it changes.
template <class Inner>
class Passing : public coupling::Participant {
 public:
  template <class... Arguments>
  explicit Passing(Arguments&&... arguments) : inner(std::forward<Arguments>(arguments)...) {}
  coupling::Interface initialise() override { return inner.initialise(); }
  void begin_step(const coupling::Step& step) override { inner.begin_step(step); }
  coupling::Exchange solve(const coupling::Exchange& in) override { return inner.solve(in); }
  coupling::StepReport accept_step() override { return inner.accept_step(); }
  void save(io::CheckpointWriter& file) const override { inner.save(file); }
  void load(io::CheckpointReader& file) override { inner.load(file); }
  void write_output(double, int) override {}
  void write_monitors(double) override {}

 protected:
  Inner inner;
};

}  // namespace couplet::tests
