// SPDX-License-Identifier: Apache-2.0
// Effects neglected by modes of a thin plate: large and in-plane motion, stretch, shear and rotary inertia.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/diagnostics/atmosphere.hpp"
#include "common/io/checkpoint.hpp"
#include "common/mesh/load.hpp"
#include "common/modes/modal_model.hpp"
#include "plate_modal/diagnostics/motion.hpp"
#include "plate_modal/diagnostics/view.hpp"

namespace couplet::plate {
namespace {

double largest_of(const std::vector<double>& vectors) {
  double largest = 0;
  for (std::size_t i = 0; i < vectors.size(); i += 3) largest = std::max(largest, Vec3(&vectors[i]).norm());
  return largest;
}

class PlateTheory final : public diagnostics::Diagnostic {
 public:
  PlateTheory(const PlateView& view, std::shared_ptr<const Motion> motion)
      : view_(view), motion_(std::move(motion)) {
    const modes::ModalModel& model = view.model();
    const std::vector<double>& omega = view.surface.omega();
    for (const Vec3& x : model.vertices) size_ = std::max(size_, (x - model.vertices.front()).norm());
    for (std::size_t m = 0; m < omega.size(); ++m)
      rotations_.push_back(omega[m] == 0 ? modes::rigid_motion(model, m).rotation : Vec3(Vec3::Zero()));
    constexpr double gravity = 9.81;  // [m/s^2]
    const std::vector<double> weight =
        view.surface.participation(gravity * view.parameters.placement.normal());
    for (std::size_t m = 0; m < omega.size(); ++m) sag_ += std::pow(weight[m] / (omega[m] * omega[m]), 2);
    sag_ = std::sqrt(sag_);
  }
  void observe(diagnostics::Report&) override {
    displacement_ = std::max(displacement_, largest_of(view_.displacement));
    Vec3 turn = Vec3::Zero();
    for (std::size_t m = 0; m < rotations_.size(); ++m) turn += view_.state.q[m] * rotations_[m];
    rotation_ = std::max(rotation_, turn.norm());
    const std::vector<double>&q = view_.state.q, &omega = view_.surface.omega();
    double size = 0, added = 0;
    for (const double amplitude : q) size += amplitude * amplitude;
    largest_ = std::max(largest_, std::sqrt(size));
    if (view_.is_dynamic() || view_.step.number < 1) return;
    // Static steps that follow a load: what their accelerations would add.
    std::vector<double> rate = q;
    for (std::size_t m = 0; m < q.size(); ++m) {
      rate[m] = (q[m] - view_.before.q[m]) / view_.step.dt;
      if (!rate_.empty()) added += std::pow((rate[m] - rate_[m]) / (view_.step.dt * omega[m] * omega[m]), 2);
    }
    rate_ = std::move(rate);
    added_ = std::max(added_, std::sqrt(added));
  }
  void look(diagnostics::Report& report) override {
    check_rotation(report, displacement_ / size_);
    if (view_.built.stretch_limit > 0) check_stretch(report, displacement_ / view_.parameters.thickness);
    if (!view_.parameters.modes_file && view_.is_dynamic()) check_plane(report);
    if (!view_.parameters.modes_file) check_shear(report);
    if (view_.pressure || view_.fluid_force.empty()) return;
    if (auto found = diagnostics::atmosphere_on_one_side(MPI_COMM_SELF, 3, view_.fluid_force,
                                                         view_.surface.areas(), view_.surface.centres()))
      report.findings.push_back(std::move(*found));
  }
  void conclude(diagnostics::Report& report) override {
    if (!(largest_ > 0)) return;
    const double inertia = added_ / largest_, weight = sag_ / largest_;
    if (!rate_.empty())
      report_neglected(report, "inertia", inertia, fmt::format("inertia / load = {:.2g}", inertia),
                       "use 'analysis: dynamic'", inertia < 0.5 ? inertia / (1 - inertia) : 1);
    if (view_.parameters.gravity.empty() && !moves_freely() && view_.fluid_force.empty())
      report_neglected(
          report, "gravity", weight,
          fmt::format("the weight across the plate would change the motion by {:.2g} %", 100 * weight), "",
          unknown, diagnostics::no_verdict);
  }
  void visit(io::Archive& archive) override {
    archive.common("largest", displacement_, rotation_, largest_, added_, rate_);
  }

 private:
  bool moves_freely() const { return view_.surface.omega().front() == 0; }

  // A free body may translate far but not rotate far: a mode moves it along the tangent, so that 0.25 rad
  // stretch it by 3 %. A clamped strip with a tip deflection of a quarter of its length has rotated
  // there by about 20 degrees; the neglected foreshortening is 0.6 x 0.25^2 of the length, 4 %.
  void check_rotation(diagnostics::Report& report, double displacement) const {
    if (moves_freely())
      report_neglected(report, "large rotation", rotation_,
                       fmt::format("rigid rotation = {:.2g} rad", rotation_),
                       "linear modes move a body along its tangent: use a program for finite strain",
                       std::hypot(1, rotation_) - 1);
    else
      report_neglected(
          report, "large rotation", displacement,
          fmt::format("max displacement / structure size = {:.2g}", displacement),
          "modes are linear and cannot describe large rotations: use a program for finite strain",
          0.6 * displacement * displacement);
  }

  // Stretch stiffens a plate with held edges by about 1 + 0.5 (w/h)^2, depending on the edges: of the linear deflection w it
  // leaves the part x with x + 0.5 (w/h)^2 x^3 = 1.
  void check_stretch(diagnostics::Report& report, double deflection) const {
    const double stiffening = 0.5 * deflection * deflection;
    double x = 1;
    for (int k = 0; k < 60; ++k) x -= (x + stiffening * x * x * x - 1) / (1 + 3 * stiffening * x * x);
    report_neglected(
        report, "stretch of the mid-surface", deflection,
        fmt::format("plate held on opposite sides: max deflection / thickness = {:.2g}", deflection),
        "unless its edges may slide in its plane, stretching stiffens it noticeably: use a program for finite strain",
        stiffening * x * x);
  }

  /// Largest part of loads and base motion in the plane, to which bending modes do not respond, over that across it.
  void check_plane(diagnostics::Report& report) const {
    const Parameters& p = view_.parameters;
    const Vec3 normal = p.placement.normal();
    const auto share_of = [&](const Vec3& all) {
      const double across = std::abs(all.dot(normal));
      return all.norm() > 0 ? (all - all.dot(normal) * normal).norm() / std::max(across, 0.1 * all.norm())
                            : 0;
    };
    double share = share_of(p.initial_velocity);
    // Supports carry in-plane weight, unless gravity is given for nothing; a free plate has none.
    const double weight = p.gravity.empty() ? 0 : share_of(Vec3(p.gravity.data()));
    if (moves_freely() || weight > 9) share = std::max(share, weight);
    report_neglected(
        report, "motion in the plane", share,
        fmt::format("{1}: in-plane component / normal component = {0:.2g}", share,
                    p.gravity.empty() ? "the initial velocity" : "the gravity or the initial velocity"),
        "no mode moves in the plane, so the in-plane component is neglected: apply only the normal component, or use a volume "
        "model",
        std::min(share, 1.));
  }

  // Mindlin's plate compared with Kirchhoff's: rotary inertia and shear lower omega^2 by (k h)^2 (1/12 + 1/(5
  // (1 - nu))), omega by 2 % if half a wave, pi/k, is ten thicknesses long, and the motion by twice as much.
  void check_shear(diagnostics::Report& report) const {
    const std::vector<double>& omega = view_.surface.omega();
    double softening = 0, all = 0;
    for (std::size_t m = 0; m < omega.size(); ++m) {
      const double moved = motion_ ? motion_->moved(m) : view_.state.q[m] * view_.state.q[m];
      softening += moved * 16 * std::pow(thickness_over_wave(omega[m]), 4);
      all += moved;
    }
    const double share = all > 0 ? std::sqrt(softening / all) : unknown;  // nothing moves
    report_neglected(
        report, "shear and rotary inertia", share,
        fmt::format(
            "estimated from the ratio of the thickness to half the wavelength of the modes, they increase the motion by a "
            "fraction of {:.2g}",
            share),
        "shear and rotary inertia soften modes of short wavelength: keep fewer modes, or use a volume model",
        share);
  }
  /// Thickness over half the bending wavelength at this frequency in the thickest part of the plate: D k^4 =
  /// rho h omega^2.
  double thickness_over_wave(double omega) const {
    const Parameters& p = view_.parameters;
    double largest = 0;
    const auto add = [&](double h, double density, double youngs_modulus) {
      const double d =
          youngs_modulus * h * h * h / (12 * (1 - p.material.poissons_ratio * p.material.poissons_ratio));
      largest = std::max(largest, h * std::pow(density * h * omega * omega / d, 0.25) / std::numbers::pi);
    };
    add(p.thickness, p.material.density, p.material.youngs_modulus);
    for (const auto& [name, zone] : p.zones)
      add(zone.thickness.value_or(p.thickness), zone.density.value_or(p.material.density),
          zone.youngs_modulus.value_or(p.material.youngs_modulus));
    return largest;
  }

  PlateView view_;
  std::shared_ptr<const Motion> motion_;
  double size_ = 0;
  std::vector<Vec3> rotations_;  // of each rigid mode [1/(sqrt(kg) m)], 0 for the others
  // Largest of any vertex [m]; of the body as a whole [rad].
  double displacement_ = 0, rotation_ = 0;
  // Norms of modal displacements: by the weight, of the state, and by the acceleration of static steps; rate of the last one.
  double sag_ = 0, largest_ = 0, added_ = 0;
  std::vector<double> rate_;
};

}  // namespace

diagnostics::Made plate_theory(const RunOfPlate& run) {
  return std::make_shared<PlateTheory>(run.view, run.motion);
}

}  // namespace couplet::plate
