// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/diagnostics/results.hpp"
#include "plate_modal/diagnostics/motion.hpp"
#include "plate_modal/diagnostics/view.hpp"
#include "plate_modal/model/midsurface.hpp"

namespace couplet::plate {
namespace {

/// Component of a shape along a direction at entry i, mode m.
double along(const modes::ModalModel& model, const std::vector<double>& shape, std::size_t i, std::size_t m,
             const Vec3& direction) {
  const std::size_t n = model.n_modes();
  const double* u = shape.data() + 3 * i * n + m;
  return Vec3(u[0], u[n], u[2 * n]).dot(direction);
}

/// Per mode: difference of the mean over a cell's corners from the cell's mean deflection, RMS relative to
/// the latter. With n cells per half wave it is (pi/n)^2/12 in each direction.
std::vector<double> mesh_gaps(const modes::ModalModel& model, std::size_t cells, const Vec3& normal) {
  const std::vector<Vec3> areas = modes::face_areas(model);
  std::vector<double> gaps(model.n_modes(), 0);
  for (std::size_t m = 0; m < gaps.size(); ++m) {
    double apart = 0, all = 0;
    for (std::size_t f = 0; f < cells; ++f) {
      const double mean = along(model, model.face_shape, f, m, normal);
      double corners = 0;
      for (const Index v : model.faces[Index(f)])
        corners += along(model, model.vertex_shape, std::size_t(v), m, normal) /
                   double(model.faces[Index(f)].size());
      apart += areas[f].norm() * (corners - mean) * (corners - mean);
      all += areas[f].norm() * mean * mean;
    }
    gaps[m] = all > 0 ? std::sqrt(apart / all) : 1;
  }
  return gaps;
}

/// Error of a mode's stiffness, which is too low by about a third of the gap on fine meshes and by more on coarse ones.
double softness(double gap) { return std::min(gap, gap / 3 + 2 * gap * gap); }

class MeshOfModes final : public diagnostics::Diagnostic {
 public:
  MeshOfModes(const PlateView& view, std::shared_ptr<const Motion> motion)
      : view_(view), motion_(std::move(motion)) {
    if (!view.parameters.modes_file)
      gaps_ = mesh_gaps(view.model(), view.n_cells(), view.parameters.placement.normal());
  }
  /// Evaluated only at the end, because the first steps show the short waves of the load's start.
  void conclude(diagnostics::Report& report) override {
    const bool is_modal = view_.parameters.analysis == Parameters::Analysis::modal;
    report.errors.field = is_modal ? "frequencies" : "displacement",
    report.errors.unit = is_modal ? "Hz" : "m";
    report.errors.mesh = mesh_gap();
    std::vector<double> of_frequencies;
    for (const double gap : gaps_) of_frequencies.push_back(frequency_error(gap));
    diagnostics::set_errors("frequencies", std::move(of_frequencies));
  }

 private:
  /// Half the error of the stiffness of a mode.
  double frequency_error(double gap) const { return with_corners(softness(gap) / 2, gap, view_.built.kinks); }
  /// Error of the stiffness of the modes, weighted by their motion. In motion the whole gap counts, because errors of
  /// phases add. In a modal analysis it is the error of the highest frequency.
  double mesh_gap() const {
    if (gaps_.empty()) return unknown;
    if (view_.parameters.analysis == Parameters::Analysis::modal) return frequency_error(gaps_.back());
    double all = 0, apart = 0;
    for (std::size_t m = 0; m < gaps_.size(); ++m) {
      const double moved = motion_ ? motion_->moved(m) : view_.state.q[m] * view_.state.q[m];
      all += moved;
      apart += moved * gaps_[m] * gaps_[m];
    }
    const double gap = std::sqrt(apart / all);
    return all > 0 ? with_corners(motion_ ? gap : softness(gap), gap, view_.built.kinks) : unknown;
  }

  PlateView view_;
  std::shared_ptr<const Motion> motion_;
  std::vector<double> gaps_;  // of each mode; empty for modes of a file
};

}  // namespace

diagnostics::Made mesh_of_modes(const RunOfPlate& run) {
  return std::make_shared<MeshOfModes>(run.view, run.motion);
}

}  // namespace couplet::plate
