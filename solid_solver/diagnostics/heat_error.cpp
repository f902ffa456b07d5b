// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Dense>
#include <cmath>
#include <span>
#include <vector>

#include "common/base/error.hpp"
#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"
#include "common/time/step_errors.hpp"
#include "solid_solver/diagnostics/view.hpp"

namespace couplet::solid {
namespace {

time::TimeSchemeParameters scheme_of(HeatParameters::Scheme scheme) {
  time::TimeSchemeParameters p;
  p.type = scheme == HeatParameters::Scheme::euler         ? time::TimeScheme::euler
           : scheme == HeatParameters::Scheme::three_point ? time::TimeScheme::three_point
                                                           : time::TimeScheme::trapezoidal;
  return p;
}

/// Sums of a linear fit through the neighbors of a cell, weighted by 1/d^2.
struct Fit {
  Eigen::Matrix4d moments = Eigen::Matrix4d::Zero();
  Eigen::Vector4d values = Eigen::Vector4d::Zero();
  void add(const Vec3& d, double value) {
    const double weight = 1 / d.squaredNorm();
    const Eigen::Vector4d row(1, d.x(), d.y(), d.z());
    moments += weight * row * row.transpose();
    values += weight * value * row;
  }
  /// Value of the fit in the cell itself; 2-D omits the third direction.
  double value() const { return moments.completeOrthogonalDecomposition().solve(values)[0]; }
};

/// Error of the temperature of a body that only conducts heat, relative to its variation: the distance from the mean
/// temperature before the first step, or of a steady field from its own mean. Collective.
///   mesh    difference from a linear fit through each cell's neighbors
///   step    sum of local errors by the rates of the last three steps, see VelocityErrors; none if steady. Of one
///           or two steps, by the ratio of their changes, see of_first_steps()
class HeatError final : public diagnostics::Diagnostic {
 public:
  explicit HeatError(const Heat& heat)
      : heat_(heat),
        mesh_(heat.conduction().mesh()),
        geometry_(heat.conduction().geometry()),
        is_steady_(heat.is_steady()),
        steps_(scheme_of(heat.parameters().scheme),
               heat.parameters().scheme == HeatParameters::Scheme::three_point) {}
  void observe(diagnostics::Report& report) override;
  void conclude(diagnostics::Report& report) override;
  void visit(io::Archive& archive) override;

 private:
  double mean(std::span<const double> cells) const;
  double size_about(std::span<const double> temperature, double level) const;
  std::vector<double> gaps() const;
  double of_first_steps() const;

  const Heat& heat_;
  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  bool is_steady_;
  double level_ = 0;  // before the first step [K]
  bool begun_ = false;
  std::vector<double> rate_;  // of the previous step [K/s]; empty if none
  double dt_ = 0;             // of the previous step; 0 if none
  time::VelocityErrors steps_;
};

double HeatError::mean(std::span<const double> cells) const {
  double whole = 0, volume = 0;
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    whole += geometry_.volume[c] * cells[c];
    volume += geometry_.volume[c];
  }
  return parallel::sum(mesh_.comm, whole) / parallel::sum(mesh_.comm, volume);
}

double HeatError::size_about(std::span<const double> temperature, double level) const {
  std::vector<double> above(temperature.begin(), temperature.begin() + mesh_.cells.n_owned());
  for (double& t : above) t -= level;
  return root_mean_square(mesh_, geometry_, 1, above);
}

void HeatError::observe(diagnostics::Report&) {
  if (is_steady_) return;
  const HeatState &before = heat_.trial(), &now = heat_.accepted();
  if (!begun_) level_ = mean(before.cells), begun_ = true;
  const auto n = std::size_t(mesh_.cells.n_owned());
  std::vector<double> rate(n);
  for (std::size_t c = 0; c < n; ++c) rate[c] = (now.cells[c] - before.cells[c]) / now.dt;
  // Rates are at mid-steps, whose distance is the mean of both steps.
  if (dt_ > 0 && rate_.size() != n)
    throw Error("The checkpoint's step errors are from another mesh. Use an earlier checkpoint.");
  if (dt_ > 0)  // the same on all ranks, also on one without cells
    steps_.add(
        rate_, rate, 0.5 * (now.dt + dt_), dt_, size_about(now.cells, level_),
        [this](std::span<const double> cells) { return root_mean_square(mesh_, geometry_, 1, cells); });
  rate_ = std::move(rate);
  dt_ = now.dt;
}

/// Difference of each owned cell's temperature from a linear fit through its neighbors [K].
std::vector<double> HeatError::gaps() const {
  const HeatState& now = heat_.accepted();
  const std::vector<double> faces = heat_.face_temperature(now);  // also where nothing is solved for
  const mesh::Geometry& at = geometry_;
  std::vector<Fit> fits(std::size_t(mesh_.cells.n_local()));
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
    const Index owner = mesh_.owner[f];
    if (f >= mesh_.n_interior) {
      fits[owner].add(at.face_centre[f] - at.cell_centre[owner], faces[f]);
      continue;
    }
    const Index neighbour = mesh_.neighbour[f];
    const Vec3 d = at.cell_centre[neighbour] + mesh_.shift(f) - at.cell_centre[owner];
    fits[owner].add(d, now.cells[neighbour]);
    fits[neighbour].add(-d, now.cells[owner]);
  }
  std::vector<double> gap(std::size_t(mesh_.cells.n_owned()));
  for (std::size_t c = 0; c < gap.size(); ++c) gap[c] = fits[c].value() - now.cells[c];
  return gap;
}

/// Error of one or two steps [K]. The temperature of a cell approaches its end like e^(-z) per step; the scheme leaves
/// `left` of the distance instead. The ratio q of its two changes tells z. For Euler and the trapezoidal rule q is what one
/// step leaves, for three-point, which begins with Euler, 1.5/(1.5 + z). A single step gets its second change from the same
/// matrix. Measured on slabs with a source and with a shock, for Fourier numbers from 0.02 to 1000: 0.5 to 1.25 of the error.
double HeatError::of_first_steps() const {
  using Scheme = HeatParameters::Scheme;
  constexpr double even = 1e-3, least = 1e-9;  // from which 1 - q and 1/q have digits
  const int steps = heat_.accepted().steps;
  const std::vector<double> second = steps == 1 ? heat_.next_change(rate_) : rate_;
  const std::span<const double> first = steps == 1 ? std::span<const double>(rate_) : steps_.before();
  if (parallel::any(mesh_.comm, second.size() != first.size())) return diagnostics::ErrorParts::unknown;
  std::vector<double> error(first.size());
  for (std::size_t c = 0; c < error.size(); ++c) {
    const double q = second[c] / first[c];
    if (!(q < 1 - even)) {  // a rate that does not decay
      error[c] = 0.5 * steps * dt_ * (second[c] - first[c]);
      continue;
    }
    double z = 1 / std::max(q, least) - 1, left = std::pow(q, steps), changed = 1 - q;
    if (heat_.parameters().scheme == Scheme::trapezoidal) {
      z = 2 * (1 - q) / std::max(1 + q, least);
    } else if (heat_.parameters().scheme == Scheme::three_point && steps == 2) {
      z *= 1.5;
      left = (2 - 0.5 * (1 + z)) / ((1 + z) * (1.5 + z));
      changed = z / (1 + z);
    }
    error[c] = (left - std::exp(-steps * z)) / changed * dt_ * first[c];
  }
  return root_mean_square(mesh_, geometry_, 1, error);
}

void HeatError::conclude(diagnostics::Report& report) {
  const HeatState& now = heat_.accepted();
  if (now.steps == 0) return;
  const double level = is_steady_ || !begun_ ? mean(now.cells) : level_, size = size_about(now.cells, level);
  if (!(size > 1e-12 * std::abs(level))) return;  // uniform temperature has no error
  report.errors.field = "differences of temperature", report.errors.unit = "K";
  report.errors.size = size, report.errors.level = level;
  report.errors.mesh = root_mean_square(mesh_, geometry_, 1, gaps()) / size;
  if (is_steady_) return;
  report.errors.step = steps_.over_size();
  if (std::isnan(report.errors.step) && now.steps <= 2) report.errors.step = of_first_steps() / size;
}

void HeatError::visit(io::Archive& archive) {
  std::vector<double> numbers = steps_.numbers(), before(steps_.before().begin(), steps_.before().end());
  archive.common("heat", begun_, level_, dt_, numbers);
  archive.field(mesh::Entries::owned_cells, "heat-rate-before", before, 1);
  archive.field(mesh::Entries::owned_cells, "heat-rate", rate_, 1);
  if (archive.reads()) steps_.restore(numbers, before);
}

}  // namespace

double root_mean_square(const mesh::Mesh& mesh, const mesh::Geometry& geometry, int width,
                        std::span<const double> cells) {
  double squares = 0, volume = 0;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    volume += geometry.volume[c];
    for (int a = 0; a < width; ++a) {
      const double value = cells[std::size_t(c) * width + a];
      squares += geometry.volume[c] * value * value;
    }
  }
  return std::sqrt(parallel::sum(mesh.comm, squares) / parallel::sum(mesh.comm, volume));
}

diagnostics::Made heat_error(const Heat& heat) { return std::make_shared<HeatError>(heat); }

}  // namespace couplet::solid
