// SPDX-License-Identifier: Apache-2.0
// The two analytic participants of added-mass theory [causin2005]: a potential flow under an elastic wall,
// both in sine modes along 0 < x < L, so that nothing is discretised but time.
//   fluid: (0,L) x (0,R), symmetry at y = 0, p = p_in(t) at x = 0 and 0 at x = L, wall at y = R:
//          p_i = (p_in(t) part)_i - rho mu_i dv_i/dt,  mu_i = L / (i pi tanh(i pi R / L))
//   wall:  m dv/dt + a eta - b eta_xx = p,  trapezoidal rule, load at the middle of the step
#pragma once

#include <cmath>
#include <numbers>
#include <optional>

#include "common/app/program.hpp"
#include "common/base/error.hpp"
#include "common/io/checkpoint.hpp"
#include "common/io/series.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::toy {

struct ModalParameters {
  int vertices = 42;                  // 40 modes: one for each vertex within
  double length = 5, radius = 0.5;    // [m]
  double density = 1;                 // of the fluid [kg/m^3]
  double surface_density = 1;         // of the wall [kg/m^2]
  double stiffness = 0, tension = 0;  // a [N/m^3], b [N/m]
  double inlet_pressure = 0;          // over the fluid, times sin^2(pi t / duration) [Pa]
  double push = 0;                    // on the wall, the same [Pa]
  double pulse_duration = 1;          // [s]
  double peak = 0;                    // place of the largest load, in lengths; 0: 1 - x / L, a pressure drop
};

inline void declare(config::Section& s, ModalParameters& p) {
  s.value("vertices", p.vertices).range(3, 100000).doc("along the wall, ends among them");
  s.value("length", p.length).unit("m").positive().doc("of the wall");
  s.value("radius", p.radius).unit("m").positive().doc("height of the fluid under it");
  s.value("density", p.density).unit("kg/m^3").positive().doc("of the fluid");
  s.value("surface-density", p.surface_density).unit("kg/m^2").positive().doc("of the wall");
  s.value("stiffness", p.stiffness).not_negative().doc("force per area and displacement [N/m^3]");
  s.value("tension", p.tension).unit("N/m").not_negative().doc("along the wall");
  s.value("inlet-pressure", p.inlet_pressure).unit("Pa").doc("of the pulse");
  s.value("push", p.push).unit("Pa").doc("the same, on the wall itself");
  s.value("peak", p.peak).range(0, 1).doc("place of the largest load over the length; 0: a pressure drop");
  s.value("pulse-duration", p.pulse_duration).unit("s").positive().doc("of the pulse");
}

/// mu_i of theory [m], i = 1, 2, ...
inline double added_mass_length(const ModalParameters& p, int i) {
  const double k = i * std::numbers::pi / p.length;
  return 1 / (k * std::tanh(k * p.radius));
}

/// Amplitude i of the load at time t for a pressure of 1: 1 - x/L = sum 2 / (i pi) sin(i pi x / L), or a hat
/// of height 1 with its peak at c L: sum 2 / (c (1 - c) i^2 pi^2) sin(i pi c) sin(i pi x / L).
inline double load_amplitude(const ModalParameters& p, int i, double t) {
  if (t > p.pulse_duration) return 0;
  const double k = i * std::numbers::pi, c = p.peak,
               pulse = std::pow(std::sin(std::numbers::pi * t / p.pulse_duration), 2);
  return pulse * (c == 0 ? 2 / k : 2 / (c * (1 - c) * k * k) * std::sin(k * c));
}

/// Sine modes sin(i pi x / L) over n vertices or the n-1 faces between them.
class SineModes {
 public:
  explicit SineModes(const ModalParameters& p)
      : n_(p.vertices), length_(p.length), at_vertices_(n_ * modes()), at_faces_((n_ - 1) * modes()) {
    for (int i = 0; i < modes(); ++i) {
      const double k = (i + 1) * std::numbers::pi / (n_ - 1);
      for (int v = 0; v < n_; ++v) at_vertices_[i * n_ + v] = std::sin(k * v);
      for (int f = 0; f < n_ - 1; ++f) at_faces_[i * (n_ - 1) + f] = std::sin(k * (f + 0.5));
    }
  }
  int modes() const { return n_ - 2; }
  /// From the y components of values at vertices.
  std::vector<double> of_vertices(const std::vector<double>& values) const {
    return amplitudes(values, at_vertices_, n_, 2. / (n_ - 1));
  }
  /// From the y components of forces at faces: amplitudes of the force per length.
  std::vector<double> of_forces(const std::vector<double>& forces) const {
    return amplitudes(forces, at_faces_, n_ - 1, 2 / length_);
  }
  std::vector<double> at_vertices(const std::vector<double>& a) const {
    return values(a, at_vertices_, n_, 1);
  }
  std::vector<double> forces(const std::vector<double>& a) const {
    return values(a, at_faces_, n_ - 1, length_ / (n_ - 1));
  }

 private:
  std::vector<double> amplitudes(const std::vector<double>& vectors, const std::vector<double>& shape, int n,
                                 double factor) const {
    std::vector<double> a(modes(), 0.);
    for (int i = 0; i < modes(); ++i)
      for (int v = 0; v < n; ++v) a[i] += factor * shape[i * n + v] * vectors[2 * v + 1];
    return a;
  }
  std::vector<double> values(const std::vector<double>& a, const std::vector<double>& shape, int n,
                             double factor) const {
    std::vector<double> vectors(2 * n, 0.);
    for (int i = 0; i < modes(); ++i)
      for (int v = 0; v < n; ++v) vectors[2 * v + 1] += factor * a[i] * shape[i * n + v];
    return vectors;
  }
  int n_;
  double length_;
  std::vector<double> at_vertices_, at_faces_;  // mode by mode
};

inline coupling::Interface modal_wall(const ModalParameters& p, double normal) {
  coupling::Interface line{2, {}, {}, {}, {}, {}};
  const double h = p.length / (p.vertices - 1);
  for (int v = 0; v < p.vertices; ++v) {
    line.vertices.emplace_back(v * h, p.radius, 0);
    if (v > 0)
      line.face_centres.emplace_back((v - 0.5) * h, p.radius, 0),
          line.face_areas.emplace_back(0, normal * h, 0);
  }
  return line;
}

class ModalChannel final : public coupling::Participant {
 public:
  explicit ModalChannel(const ModalParameters& p) : p_(p), modes_(p), now_(modes_.modes()), next_(now_) {}
  coupling::Interface initialise() override {
    coupling::Interface line = modal_wall(p_, 1);
    line.takes = {{"displacement", "m", coupling::Interface::Place::vertices},
                  {"velocity", "m/s", coupling::Interface::Place::vertices}};
    line.gives = {{"pressure-force", "N", coupling::Interface::Place::faces}};
    return line;
  }
  void begin_step(const coupling::Step& step) override { step_ = step; }
  coupling::Exchange solve(const coupling::Exchange& in) override {
    next_ = in.contains("velocity") ? modes_.of_vertices(in.at("velocity")) : now_;
    const double t = step_.time + step_.dt / 2;
    std::vector<double> p(next_.size());
    for (int i = 0; i < modes_.modes(); ++i)
      p[i] = p_.inlet_pressure * load_amplitude(p_, i + 1, t) -
             p_.density * added_mass_length(p_, i + 1) * (next_[i] - now_[i]) / step_.dt;
    return {{"pressure-force", modes_.forces(p)}};
  }
  coupling::StepReport accept_step() override {
    now_ = next_;
    return {.dt = step_.dt};
  }
  void save(io::CheckpointWriter& file) const override { file.write("velocity", now_); }
  void load(io::CheckpointReader& file) override { file.read("velocity", now_); }
  void write_output(double, int) override {}
  void write_monitors(double) override {}

 private:
  ModalParameters p_;
  SineModes modes_;
  coupling::Step step_;
  std::vector<double> now_, next_;  // amplitudes of the wall's velocity
};

class ModalWall final : public coupling::Participant {
 public:
  explicit ModalWall(const ModalParameters& p, const app::ParticipantContext& context = {})
      : p_(p), modes_(p), eta_(modes_.modes()), v_(eta_), next_eta_(eta_), next_v_(eta_) {
    if (parallel::comm_size(context.comm) > 1) throw Error("This wall knows one rank only.");
    if (!context.output_folder.empty())
      series_.emplace(context.output_folder / "mode.csv",
                      std::vector<std::string>{"time [s]", "mode 1 [m]", "its velocity [m/s]"},
                      context.restart_time);
  }
  coupling::Interface initialise() override {
    coupling::Interface line = modal_wall(p_, -1);
    line.takes = {{"pressure-force", "N", coupling::Interface::Place::faces}};
    line.gives = {{"displacement", "m", coupling::Interface::Place::vertices},
                  {"velocity", "m/s", coupling::Interface::Place::vertices}};
    return line;
  }
  void begin_step(const coupling::Step& step) override { time_ = step.time, dt_ = step.dt; }
  coupling::Exchange solve(const coupling::Exchange& in) override {
    std::vector<double> force(2 * (p_.vertices - 1));
    if (in.contains("pressure-force")) force = in.at("pressure-force");
    std::vector<double> p = modes_.of_forces(force);
    for (int i = 0; i < modes_.modes(); ++i) {
      const double k = (i + 1) * std::numbers::pi / p_.length, m = p_.surface_density,
                   s = p_.stiffness + p_.tension * k * k;
      p[i] += p_.push * load_amplitude(p_, i + 1, time_ + dt_ / 2);
      next_v_[i] = (m / dt_ * v_[i] - s * (eta_[i] + dt_ / 4 * v_[i]) + p[i]) / (m / dt_ + s * dt_ / 4);
      next_eta_[i] = eta_[i] + dt_ / 2 * (v_[i] + next_v_[i]);
    }
    return {{"displacement", modes_.at_vertices(next_eta_)}, {"velocity", modes_.at_vertices(next_v_)}};
  }
  coupling::StepReport accept_step() override {
    eta_ = next_eta_, v_ = next_v_;
    return {.dt = dt_};
  }
  void save(io::CheckpointWriter& file) const override { file.write("eta", eta_), file.write("v", v_); }
  void load(io::CheckpointReader& file) override { file.read("eta", eta_), file.read("v", v_); }
  void write_output(double, int) override {}
  void write_monitors(double time) override {
    if (series_) series_->row(std::vector<double>{time, eta_[0], v_[0]});
  }
  const std::vector<double>& amplitudes() const { return eta_; }
  const std::vector<double>& velocities() const { return v_; }

 private:
  ModalParameters p_;
  SineModes modes_;
  double time_ = 0, dt_ = 0;
  std::vector<double> eta_, v_, next_eta_, next_v_;
  std::optional<io::Series> series_;
};

}  // namespace couplet::toy
