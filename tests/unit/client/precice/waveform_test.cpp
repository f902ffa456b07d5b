// SPDX-License-Identifier: Apache-2.0
// Interpolation in time of programs on preCICE's interface.
#include "client/precice/waveform.hpp"
#include "tests/support/test.hpp"

namespace couplet::dropin::waveform_test {

std::vector<double> times(int intervals, double power) {
  std::vector<double> list;
  for (int i = 0; i <= intervals; ++i) list.push_back(std::pow(double(i) / intervals, power));
  return list;
}

double largest_error(const std::vector<double>& t, int degree, const std::function<double(double)>& f) {
  const Waveform w(t, degree);
  double worst = 0;
  for (int k = 0; k <= 997; ++k) {
    const std::vector<double> weights = w.weights(k / 997.);
    double value = 0;
    for (std::size_t i = 0; i < t.size(); ++i) value += weights[i] * f(t[i]);
    worst = std::max(worst, std::abs(value - f(k / 997.)));
  }
  return worst;
}

TEST(Waveform, polynomials_up_to_its_degree_are_reproduced_to_rounding_at_any_times) {
  for (int degree = 1; degree <= 5; ++degree)
    for (const int intervals : {1, 2, 3, 4, 5, 9, 40})
      for (const double power : {1., 1.4}) {
        const auto t = times(intervals, power);
        const int possible = Waveform(t, degree).degree();
        EXPECT_EQ(possible, std::min(degree, intervals));
        for (int q = 0; q <= possible; ++q)
          EXPECT_LT(largest_error(t, degree, [q](double s) { return std::pow(s, q); }), 3e-15)
              << degree << " " << intervals << " " << q;
        const double beyond = largest_error(t, degree, [&](double s) { return std::pow(s, possible + 1); });
        EXPECT_GT(beyond, 1e-10) << degree << " " << intervals;
      }
}

TEST(Waveform, its_error_falls_by_one_order_more_than_its_degree) {
  const auto f = [](double s) { return std::sin(5 * s); };
  for (int degree = 1; degree <= 3; ++degree) {
    const double coarse = largest_error(times(32, 1), degree, f),
                 fine = largest_error(times(64, 1), degree, f);
    EXPECT_NEAR(std::log2(coarse / fine), degree + 1, 0.1) << degree;
  }
}

TEST(Waveform, at_the_times_the_values_are_taken_as_they_are) {
  const auto t = times(7, 1.3);
  for (int degree = 0; degree <= 4; ++degree)
    for (std::size_t i = 0; i < t.size(); ++i) {
      const auto w = Waveform(t, degree).weights(t[i] * (1 + 1e-15));
      for (std::size_t k = 0; k < t.size(); ++k) EXPECT_EQ(w[k], k == i ? 1 : 0);
    }
}

TEST(Waveform, degree_0_has_the_value_at_the_next_time) {
  const Waveform w({0, 0.4, 1}, 0);
  EXPECT_EQ(w.weights(0.1), (std::vector<double>{0, 1, 0}));
  EXPECT_EQ(w.weights(0.41), (std::vector<double>{0, 0, 1}));
}

}  // namespace couplet::dropin::waveform_test
