// SPDX-License-Identifier: Apache-2.0
// Modes in time: against closed forms, against direct integration of the same plate, energies and damping.
#include "common/linalg/linear_solver.hpp"
#include "plate_modal/motion/oscillators.hpp"
#include "plate_modal/structure.hpp"
#include "tests/verification/plate/plates.hpp"

namespace couplet::plate::dynamics_test {
using namespace time;

using namespace test;

const Oscillators::LoadAt no_load = [](double, std::span<double> load) { std::ranges::fill(load, 0); };

/// Error of one mode of 2 pi rad/s with damping ratio z under a harmonic load after 1.3 s.
double error_after(TimeScheme scheme, double dt, double z) {
  const double w = 2 * std::numbers::pi;
  constexpr double force = 3, drive = 4;
  Oscillators one({w}, {2 * z * w}, {0}, {scheme}, nullptr);
  ModalState now = one.start({0.7}, {0.2}), next = now;
  const auto load = [](double t0) {
    return [t0](double t, std::span<double> q) { q[0] = force * std::cos(drive * (t0 + t)); };
  };
  const int steps = static_cast<int>(std::lround(1.3 / dt));
  for (int i = 0; i < steps; ++i) {
    one.step(now, dt, load(i * dt), next);
    std::swap(now, next);
  }
  const double t = steps * dt, wd = w * std::sqrt(1 - z * z), a = w * w - drive * drive,
               b = 2 * z * w * drive;
  const double c = force * a / (a * a + b * b), s = force * b / (a * a + b * b);
  const double q0 = 0.7 - c, v0 = 0.2 - s * drive;
  const double exact =
      c * std::cos(drive * t) + s * std::sin(drive * t) +
      std::exp(-z * w * t) * (q0 * std::cos(wd * t) + (v0 + z * w * q0) / wd * std::sin(wd * t));
  return std::abs(now.q[0] - exact);
}

TEST(PlateDynamics, trapezoidal_and_bathe_are_second_order_with_and_without_damping) {
  for (const TimeScheme scheme :
       {TimeScheme::trapezoidal, TimeScheme::bathe, TimeScheme::generalised_alpha, TimeScheme::three_point})
    for (const double z : {0., 0.05}) {
      const double slope = std::log2(error_after(scheme, 0.005, z) / error_after(scheme, 0.0025, z));
      EXPECT_GT(slope, 1.9) << name(scheme) << " " << z;
      EXPECT_LT(slope, 2.4) << name(scheme) << " " << z;
      RecordProperty(name(scheme) + (z > 0 ? "-damped" : ""), fmt::format("{:.3f}", slope));
    }
  EXPECT_NEAR(
      std::log2(error_after(TimeScheme::euler, 0.0025, 0) / error_after(TimeScheme::euler, 0.00125, 0)), 1,
      0.2);
}

/// A partner gives the mean of 40 sin^2(4 t) over each step; deflection of the plate after 0.8 s by n steps.
std::vector<double> pushed_by_a_partner(TimeScheme scheme, int n) {
  Parameters p;
  p.material = {1000, 1e6, 0.3};
  p.thickness = 0.05;
  p.number = 4;
  p.output.fields = false;
  p.time_scheme.type = scheme;
  for (const char* patch : {"xmax", "ymin", "ymax"}) p.boundaries[patch];
  p.boundaries["xmin"].support = Support::clamped;
  const mesh::RawMesh raw = square(4);
  Structure plate(p, {MPI_COMM_WORLD, "plate", {}, {}, std::numeric_limits<double>::quiet_NaN()}, &raw);
  const coupling::Interface interface = plate.initialise();
  const double dt = 0.8 / n;
  const auto impulse = [](double t) { return 20 * t - 2.5 * std::sin(8 * t); };
  for (int i = 0; i < n; ++i) {
    coupling::Exchange in;
    for (const Vec3& area : interface.face_areas)
      for (const double f : {0., 0., (impulse((i + 1) * dt) - impulse(i * dt)) / dt * std::max(area.z(), 0.)})
        in["pressure-force"].push_back(f);
    plate.begin_step({i * dt, dt, coupling::Scheme::implicit, i});
    plate.solve(in);
    plate.accept_step();
  }
  return plate.displacement();
}

TEST(PlateDynamics, the_mean_load_of_a_partner_is_taken_to_second_order) {
  const std::vector<double> exact = pushed_by_a_partner(TimeScheme::trapezoidal, 2560);
  const auto apart = [&](const std::vector<double>& u) {
    double difference = 0, size = 0;
    for (std::size_t i = 0; i < u.size(); ++i)
      difference = std::max(difference, std::abs(u[i] - exact[i])), size = std::max(size, std::abs(exact[i]));
    return difference / size;
  };
  for (const TimeScheme scheme :
       {TimeScheme::trapezoidal, TimeScheme::bathe, TimeScheme::generalised_alpha, TimeScheme::three_point}) {
    const double slope =
        0.5 * std::log2(apart(pushed_by_a_partner(scheme, 80)) / apart(pushed_by_a_partner(scheme, 320)));
    EXPECT_GT(slope, 1.85) << name(scheme);
    RecordProperty(name(scheme), fmt::format("{:.3f}", slope));
  }
}

TEST(PlateDynamics, energy_of_the_trapezoidal_rule_balances_to_rounding_and_bathe_loses) {
  const std::vector<double> omega{3, 40, 900}, gravity{0.5, -0.2, 0.1};
  double left[2] = {0, 0};
  for (int i = 0; i < 2; ++i) {
    Oscillators modes(omega, {0.1, 0, 2}, gravity, {i == 0 ? TimeScheme::trapezoidal : TimeScheme::bathe},
                      nullptr);
    ModalState now = modes.start({0.1, 0.05, 0.002}, {1, 0, -1}), next = now;
    const double initial = now.energies.total();
    for (int step = 0; step < 200; ++step) {
      modes.step(
          now, 0.01, [](double t, std::span<double> q) { q[0] = t, q[1] = 3, q[2] = -1; }, next);
      std::swap(now, next);
    }
    left[i] = now.energies.mismatch() / initial;
  }
  EXPECT_LT(std::abs(left[0]), 1e-12);
  EXPECT_LT(left[1], -1e-3);  // the highest mode is damped away: the audit says so
}

TEST(PlateDynamics, damping_ratio_is_that_of_the_decay) {
  Oscillators one({10}, {2 * 0.02 * 10}, {0}, {TimeScheme::trapezoidal}, nullptr);
  ModalState now = one.start({1}, {0}), next = now;
  const double dt = 1e-3, time = 20 * std::numbers::pi / (10 * std::sqrt(1 - 4e-4));  // ten periods
  const int steps = static_cast<int>(std::lround(time / dt));
  for (int i = 0; i < steps; ++i) {
    one.step(now, dt, no_load, next);
    std::swap(now, next);
  }
  EXPECT_NEAR(std::log(now.q[0]), -0.02 * 10 * steps * dt, 2e-3);
}

/// M u'' + K u = f by the trapezoidal rule on all unknowns of the plate.
class Direct {
 public:
  Direct(const PlateModel& plate, double dt) : plate_(plate), dt_(dt), n_(plate.n_unknowns()) {
    // (4/dt^2 M + K) x = 4/dt^2 M u + 2/dt M v + f with x in the middle: by CG to a tight tolerance.
    u_.assign(n_, 0), v_ = u_, x_ = u_;
  }
  void step(std::span<const double> load) {
    std::vector<double> b(n_), mu(n_);
    for (std::size_t i = 0; i < n_; ++i) mu[i] = 4 / (dt_ * dt_) * u_[i] + 2 / dt_ * v_[i];
    plate_.mass().multiply(mu, b);
    for (std::size_t i = 0; i < n_; ++i) b[i] += load[i];
    solve(b);
    for (std::size_t i = 0; i < n_; ++i) {
      const double moved = 2 * (x_[i] - u_[i]);
      v_[i] = 2 / dt_ * moved - v_[i];
      u_[i] += moved;
    }
  }
  const std::vector<double>& u() const { return u_; }

 private:
  std::vector<double> apply(std::span<const double> x) const {
    std::vector<double> k(n_), m(n_);
    plate_.stiffness().multiply(x, k);
    plate_.mass().multiply(x, m);
    for (std::size_t i = 0; i < n_; ++i) k[i] += 4 / (dt_ * dt_) * m[i];
    return k;
  }
  void solve(std::span<const double> b) {
    const std::vector<double> ax = apply(x_);
    std::vector<double> r(n_), p;
    for (std::size_t i = 0; i < n_; ++i) r[i] = b[i] - ax[i];
    p = r;
    double rr = dot(r, r);
    const double wanted = 1e-22 * dot(b, b);
    for (int k = 0; k < 5000 && rr > wanted; ++k) {
      const std::vector<double> ap = apply(p);
      const double alpha = rr / dot(p, ap);
      for (std::size_t i = 0; i < n_; ++i) x_[i] += alpha * p[i], r[i] -= alpha * ap[i];
      const double next = dot(r, r);
      for (std::size_t i = 0; i < n_; ++i) p[i] = r[i] + next / rr * p[i];
      rr = next;
    }
    ASSERT_LE(rr, wanted);
  }
  static double dot(std::span<const double> a, std::span<const double> b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
  }
  const PlateModel& plate_;
  double dt_;
  std::size_t n_;
  std::vector<double> u_, v_, x_;
};

TEST(PlateDynamics, fifteen_modes_follow_direct_integration_of_the_same_plate) {
  const PlateModel plate = make_plate(square(8), {{"xmin", Support::clamped}});
  const modes::EigenModes modes = plate.modes(15);
  const double dt = 2 * std::numbers::pi / lambdas(modes)[0] / 100;
  std::vector<double> pressure;
  for (Index c = 0; c < plate.surface().cells.size(); ++c)
    pressure.push_back(plate.surface().points[plate.surface().cells[c][0]].y() > 0.5 ? 1.5 : 1);
  const std::vector<double> load = plate.load_of(pressure);
  std::vector<double> q;
  for (const auto& shape : modes.shape) {
    q.push_back(0);
    for (std::size_t r = 0; r < load.size(); ++r) q.back() += shape[r] * load[r];
  }
  Oscillators reduced(lambdas(modes), std::vector<double>(15, 0), std::vector<double>(15, 0),
                      {TimeScheme::trapezoidal}, nullptr);
  ModalState now = reduced.start(std::vector<double>(15, 0), std::vector<double>(15, 0)), next = now;
  Direct direct(plate, dt);
  // The corner at (1, 1).
  std::size_t tip = 0;
  for (std::size_t p = 0; p < plate.surface().points.size(); ++p)
    if ((plate.surface().points[p] - Vec2(1, 1)).norm() < 1e-12) tip = 3 * p;
  double apart = 0, largest = 0;
  for (int i = 0; i < 150; ++i) {
    direct.step(load);
    reduced.step(
        now, dt, [&](double, std::span<double> f) { std::ranges::copy(q, f.begin()); }, next);
    std::swap(now, next);
    double u = 0;
    for (int m = 0; m < 15; ++m) u += now.q[m] * modes.shape[m][tip];
    apart = std::max(apart, std::abs(u - direct.u()[tip]));
    largest = std::max(largest, std::abs(direct.u()[tip]));
  }
  EXPECT_LT(apart / largest, 0.01);
  EXPECT_GT(largest, 0.01);
  RecordProperty("apart", fmt::format("{:.3e}", apart / largest));
}

}  // namespace couplet::plate::dynamics_test
