// SPDX-License-Identifier: Apache-2.0
// Checks that faces and modes receive the prescribed pressures and resolve them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/io/checkpoint.hpp"
#include "common/mesh/load.hpp"
#include "plate_modal/diagnostics/motion.hpp"
#include "plate_modal/diagnostics/view.hpp"

namespace couplet::plate {
namespace {

/// Sixteen points of equal weight: centers of the pieces after two bisections.
std::vector<Vec3> points_within(const modes::ModalModel& model, std::span<const Index> face) {
  std::vector<Vec3> points;
  const auto at = [&](std::size_t i) -> const Vec3& { return model.vertices[face[i]]; };
  if (face.size() == 4) {
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) {
        const double x = (i + 0.5) / 4, y = (j + 0.5) / 4;
        points.push_back((1 - x) * (1 - y) * at(0) + x * (1 - y) * at(1) + x * y * at(2) +
                         (1 - x) * y * at(3));
      }
    return points;
  }
  // Rows of a triangle with its edges cut into quarters: upright and inverted pieces.
  const auto add = [&](double x, double y) {
    points.push_back(at(0) + x * (at(1) - at(0)) + y * (at(2) - at(0)));
  };
  for (int i = 0; i < 4; ++i)
    for (int j = 0; i + j < 4; ++j) {
      add((i + 1. / 3) / 4, (j + 1. / 3) / 4);
      if (i + j < 3) add((i + 2. / 3) / 4, (j + 2. / 3) / 4);
    }
  return points;
}

class PrescribedPressures final : public diagnostics::Diagnostic {
 public:
  explicit PrescribedPressures(const PlateView& view) : view_(view) {}
  void observe(diagnostics::Report&) override {
    if (const auto t = sample_time(view_)) check_faces(*t);
  }
  void look(diagnostics::Report& report) override {
    report_present(
        report, "load within a face", within_faces(), 0.05,
        fmt::format("relative error of the modal load with one force per face = {:.2g}", within_faces()),
        "the pressure varies within a face: refine the mesh there");
  }
  // A load without effect so far may change, so it is judged at the end.
  void conclude(diagnostics::Report& report) override {
    if (fine_ > 0) report.errors.mesh += within_faces();  // NaN with modes of a file
    // Only round-off remains if modes do not move along the forces, or forces cancel.
    const double part = std::sqrt(part_ / most_);
    if (part < 1e-9)
      report_present(
          report, "load that moves no mode", 1, 0.5,
          fmt::format(
              "modal load of the prescribed pressures = {:.1g} times what it would be if they acted along the motion",
              part),
          "these pressures excite no mode: with 'modes.file' the upper side is where the surface faces +z, regardless of the "
          "structure's own normal; equal pressures on both sides cancel; a mode of another symmetry needs a larger "
          "'modes.number'",
          std::numeric_limits<double>::infinity(), "given-without-effect");
  }
  void visit(io::Archive& archive) override { archive.common("sums", part_, most_, within_, fine_); }

 private:
  double within_faces() const { return fine_ > 0 ? std::sqrt(within_ / fine_) : unknown; }
  /// Adds the modal loads of the pressures at t: with one force at the center of each face, with each force
  /// along the motion of its face, and with sixteen points per face.
  void check_faces(double t) {
    const modes::ModalModel& model = view_.model();
    const PressureLoad& pressure = *view_.pressure;
    const std::size_t n = model.n_modes();
    std::vector<double> middle(n, 0), most(n, 0), fine(n, 0);
    const std::vector<Vec3>&areas = view_.surface.areas(), &centres = view_.surface.centres();
    try {
      for (std::size_t f = 0; f < areas.size(); ++f) {
        const double at_middle = pressure.push(areas[f], centres[f], t);
        double mean = 0;
        if (!pressure.is_uniform())
          for (const Vec3& x : points_within(model, model.faces[Index(f)]))
            mean += pressure.push(areas[f], x, t) / 16;
        if (at_middle == 0 && mean == 0) continue;
        for (std::size_t m = 0; m < n; ++m) {
          const double* u = model.face_shape.data() + 3 * f * n + m;
          const Vec3 shape(u[0], u[n], u[2 * n]);
          middle[m] += at_middle * shape.dot(areas[f]);
          most[m] += std::abs(at_middle) * shape.norm() * areas[f].norm();
          fine[m] += mean * shape.dot(areas[f]);
        }
      }
    } catch (const Error&) {
      return;  // no value there: the scheme need not ask for it
    }
    double of_middle = 0, of_fine = 0;
    for (std::size_t m = 0; m < n; ++m) {
      part_ += middle[m] * middle[m], most_ += most[m] * most[m];
      const double omega = view_.surface.omega()[m], weight = 1 / (omega * omega + view_.first_elastic());
      of_middle += weight * middle[m] * middle[m], of_fine += weight * fine[m] * fine[m];
      if (!pressure.is_uniform()) within_ += weight * (fine[m] - middle[m]) * (fine[m] - middle[m]);
    }
    if (!pressure.is_uniform()) fine_ += std::max(of_fine, of_middle);
  }

  PlateView view_;
  double part_ = 0, most_ = 0;  // squares over all modes of the loads, and of these along the motion
  // Likewise of the part missed by the faces and of the loads, each over (omega^2 + omega_1^2).
  double within_ = 0, fine_ = 0;
};

}  // namespace

diagnostics::Made prescribed_pressures(const RunOfPlate& run) {
  const bool is_modal = run.view.parameters.analysis == Parameters::Analysis::modal;
  return run.view.pressure && !is_modal ? std::make_shared<PrescribedPressures>(run.view) : nullptr;
}

}  // namespace couplet::plate
