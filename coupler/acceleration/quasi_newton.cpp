// SPDX-License-Identifier: Apache-2.0
#include "coupler/acceleration/quasi_newton.hpp"
#include "common/base/error.hpp"

#include "common/io/checkpoint.hpp"

namespace couplet::coupler {

// -- least squares
// --------------------------------------------------------------------------------------------

LeastSquaresNewton::LeastSquaresNewton(const AccelerationParameters& parameters, MPI_Comm comm)
    : parameters_(parameters), secants_(comm), pairs_(comm), share_(parameters.initial_relaxation) {}

void LeastSquaresNewton::clear() {
  while (pairs_.columns() > 0) pairs_.erase(pairs_.columns() - 1);
  step_of_.clear();
}

void LeastSquaresNewton::give_up_earlier_steps() {
  while (!step_of_.empty() && step_of_.back() != step_) {
    pairs_.erase(pairs_.columns() - 1);
    step_of_.pop_back();
  }
}

void LeastSquaresNewton::start_step() {
  // A step that was given up may have been led astray by its history, and its own pairs belong to another dt.
  if (open_) clear();
  open_ = true;
  used_earlier_ = false;
  share_ = parameters_.initial_relaxation;
  secants_.forget_pass();
  step_ += 1;
  // The columns of the step under way do not count.
  while (!step_of_.empty() && step_ - step_of_.back() > parameters_.reused_steps) {
    pairs_.erase(pairs_.columns() - 1);
    step_of_.pop_back();
  }
}

void LeastSquaresNewton::learn(const Iterate& x, const Iterate& image) {
  std::optional<Secants::Pair> pair = secants_.pair(x, image);
  if (used_earlier_ && secants_.growth() > Secants::bad_growth) {
    give_up_earlier_steps();
    ++resets_;
  }
  if (!pair) return;
  pairs_.push_front(std::move(pair->residual), std::move(pair->image));
  step_of_.push_front(step_);
  for (const int j : pairs_.drop(parameters_.filter)) step_of_.erase(step_of_.begin() + j);
  while (pairs_.columns() > parameters_.maximum_columns) {
    pairs_.erase(pairs_.columns() - 1);
    step_of_.pop_back();
  }
}

Iterate LeastSquaresNewton::next(Iterate x, const Iterate& image) {
  learn(x, image);
  used_earlier_ = !step_of_.empty() && step_of_.back() != step_;
  Iterate next = image;
  if (pairs_.columns() > 0) pairs_.add(pairs_.qr().minimise(secants_.residual()), next);
  if (pairs_.columns() == 0 || !secants_.finite(next)) {
    if (pairs_.columns() > 0) ++resets_;
    clear();
    next = x;
    relax(next, parameters_.initial_relaxation, image);
  }
  share_ = secants_.share(x, next);
  return next;
}

void LeastSquaresNewton::accept(const Iterate& x, const Iterate& image) {
  learn(x, image);
  open_ = false;
}

void LeastSquaresNewton::save(io::CheckpointWriter& file, const IterateOrder& order) const {
  pairs_.save(file, "iqn", order);
  file.write_common("iqn.step-of", std::vector<double>(step_of_.begin(), step_of_.end()));
  file.write_scalar("iqn.step", step_);
}

void LeastSquaresNewton::load(io::CheckpointReader& file, const IterateOrder& order) {
  pairs_.load(file, "iqn", order);
  const std::vector<double> steps = file.read_common("iqn.step-of");
  if (steps.size() != std::size_t(pairs_.columns()))
    throw Error("The checkpoint's steps of differences ('iqn.step-of') are damaged. Use an earlier one.");
  step_of_.assign(steps.begin(), steps.end());
  step_ = file.read_scalar("iqn.step");
}

// -- multi-vector
// ---------------------------------------------------------------------------------------------

MultiVectorNewton::MultiVectorNewton(const AccelerationParameters& parameters, MPI_Comm comm)
    : parameters_(parameters), comm_(comm), secants_(comm), share_(parameters.initial_relaxation) {}

int MultiVectorNewton::columns() const {
  int sum = 0;
  for (const SecantPairs& step : steps_) sum += step.columns();
  return sum;
}

void MultiVectorNewton::start_step() {
  if (open_) steps_.clear();
  open_ = true;
  share_ = parameters_.initial_relaxation;
  secants_.forget_pass();
  if (!steps_.empty() && steps_.front().columns() == 0) steps_.pop_front();
  steps_.emplace_front(comm_);
  while (steps_.size() > std::size_t(parameters_.reused_steps) + 1 ||
         (columns() > parameters_.maximum_columns && steps_.size() > 1))
    steps_.pop_back();
}

void MultiVectorNewton::learn(const Iterate& x, const Iterate& image) {
  std::optional<Secants::Pair> pair = secants_.pair(x, image);
  if (steps_.size() > 1 && secants_.growth() > Secants::bad_growth) {
    steps_.resize(1, SecantPairs(comm_));
    ++resets_;
  }
  if (!pair) return;
  steps_.front().push_front(std::move(pair->residual), std::move(pair->image));
  steps_.front().drop(parameters_.filter);
}

Iterate MultiVectorNewton::next(Iterate x, const Iterate& image) {
  learn(x, image);
  Iterate next = image;
  // What the columns of one step leave of the residual goes on to the step before.
  std::vector<double> rest = secants_.residual();
  for (const SecantPairs& step : steps_) {
    const Eigen::VectorXd t = step.qr().along(rest);
    step.qr().subtract(t, rest);
    step.add(-step.qr().back_substitute(t), next);
  }
  const bool empty = columns() == 0;
  if (empty || !secants_.finite(next)) {
    if (!empty) ++resets_;
    steps_.assign(1, SecantPairs(comm_));
    next = x;
    relax(next, parameters_.initial_relaxation, image);
  }
  share_ = secants_.share(x, next);
  return next;
}

void MultiVectorNewton::accept(const Iterate& x, const Iterate& image) {
  learn(x, image);
  open_ = false;
}

void MultiVectorNewton::save(io::CheckpointWriter& file, const IterateOrder& order) const {
  file.write_scalar("iqn.steps", double(steps_.size()));
  for (std::size_t s = 0; s < steps_.size(); ++s) steps_[s].save(file, "iqn." + std::to_string(s), order);
}

void MultiVectorNewton::load(io::CheckpointReader& file, const IterateOrder& order) {
  steps_.clear();
  const std::size_t n = file.read_count("iqn.steps", most_columns);
  for (std::size_t s = 0; s < n; ++s)
    steps_.emplace_back(comm_).load(file, "iqn." + std::to_string(s), order);
}

}  // namespace couplet::coupler
