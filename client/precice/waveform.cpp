// SPDX-License-Identifier: Apache-2.0
#include "waveform.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace couplet::dropin {

Waveform::Waveform(std::vector<double> times, int degree)
    : times_(std::move(times)), degree_(std::min(degree, int(times_.size()) - 1)) {
  if (degree_ < 1) return;
  const auto p = std::size_t(degree_), last = times_.size() - 1;
  knots_.assign(p + 1, times_.front());
  for (std::size_t j = 1; j + p <= last; ++j) {
    double sum = 0;
    for (std::size_t i = j; i < j + p; ++i) sum += times_[i];
    knots_.push_back(sum / double(p));
  }
  knots_.insert(knots_.end(), p + 1, times_.back());
  factor();
}

// Recurrence of Cox and de Boor over the knots around t.
std::size_t Waveform::splines(double t, std::vector<double>& values) const {
  const auto p = std::size_t(degree_);
  std::size_t span = p;  // knots_[span] <= t < knots_[span + 1], the last one closed
  while (span + 1 < times_.size() && t >= knots_[span + 1]) ++span;
  values.assign(p + 1, 0);
  values[0] = 1;
  for (std::size_t k = 1; k <= p; ++k) {
    double saved = 0;
    for (std::size_t r = 0; r < k; ++r) {
      const double right = knots_[span + r + 1], left = knots_[span + r + 1 - k];
      const double part = values[r] / (right - left);
      values[r] = saved + (right - t) * part;
      saved = (t - left) * part;
    }
    values[k] = saved;
  }
  return span - p;
}

/// LU factorization without pivoting, because the matrix is totally positive (de Boor, ch. XIII).
void Waveform::factor() {
  const std::size_t p = std::size_t(degree_), n = times_.size();
  band_.assign(n * (2 * p + 1), 0);
  std::vector<double> values;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t first = splines(times_[i], values);
    for (std::size_t k = 0; k <= p; ++k)
      if (values[k] != 0) entry(i, first + k) = values[k];
  }
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t i = k + 1; i < std::min(n, k + p + 1); ++i) {
      const double factor = entry(i, k) /= entry(k, k);
      for (std::size_t j = k + 1; j < std::min(n, k + p + 1); ++j) entry(i, j) -= factor * entry(k, j);
    }
}

std::vector<double> Waveform::weights(double t) const {
  const std::size_t n = times_.size();
  const double near = 1e-12 * (times_.back() - times_.front());
  std::vector<double> w(n, 0.);
  for (std::size_t i = 0; i < n; ++i)
    if (std::abs(t - times_[i]) <= near || (degree_ < 1 && t < times_[i])) {
      w[i] = 1;
      return w;
    }
  // Values at the times are A c with coefficients c, so the weights solve A^T w = splines at t.
  const auto p = std::size_t(degree_);
  std::vector<double> values;
  const std::size_t first = splines(t, values);
  std::copy(values.begin(), values.end(), w.begin() + std::ptrdiff_t(first));
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t i = j > p ? j - p : 0; i < j; ++i) w[j] -= entry(i, j) * w[i];
    w[j] /= entry(j, j);
  }
  for (std::size_t j = n; j-- > 0;)
    for (std::size_t k = j + 1; k < std::min(n, j + p + 1); ++k) w[j] -= entry(k, j) * w[k];
  return w;
}

}  // namespace couplet::dropin
