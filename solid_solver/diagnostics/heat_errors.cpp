// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/diagnostics/heat_errors.hpp"

#include <Eigen/Dense>
#include <cmath>

#include "common/base/error.hpp"
#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"

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

}  // namespace

HeatErrors::HeatErrors(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                       const HeatParameters& parameters)
    : mesh_(mesh),
      geometry_(geometry),
      steady_(parameters.analysis == HeatParameters::Analysis::steady),
      steps_(scheme_of(parameters.scheme)) {}

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

double HeatErrors::mean(std::span<const double> cells) const {
  double whole = 0, volume = 0;
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    whole += geometry_.volume[c] * cells[c];
    volume += geometry_.volume[c];
  }
  return parallel::sum(mesh_.comm, whole) / parallel::sum(mesh_.comm, volume);
}

double HeatErrors::size(std::span<const double> temperature, double level) const {
  std::vector<double> above(temperature.begin(), temperature.begin() + mesh_.cells.n_owned());
  for (double& t : above) t -= level;
  return root_mean_square(mesh_, geometry_, 1, above);
}

void HeatErrors::see_step(const HeatState& before, const HeatState& now) {
  if (steady_) return;
  if (!begun_) level_ = mean(before.cells), begun_ = true;
  const auto n = std::size_t(mesh_.cells.n_owned());
  std::vector<double> rate(n);
  for (std::size_t c = 0; c < n; ++c) rate[c] = (now.cells[c] - before.cells[c]) / now.dt;
  // Rates are at mid-steps, whose distance is the mean of both steps.
  if (dt_ > 0 && rate_.size() != n)
    throw Error("The checkpoint's step errors are from another mesh. Use an earlier checkpoint.");
  if (dt_ > 0) {  // the same on all ranks, also on one without cells
    const time::StepErrors::Seen seen = steps_.add(
        rate_, rate, 0.5 * (now.dt + dt_), dt_, size(now.cells, level_),
        [this](std::span<const double> cells) { return root_mean_square(mesh_, geometry_, 1, cells); });
    const double dt = std::pow(seen.dt, seen.order + 1);
    powers_ += (powers_ > 0 ? 1 : 2) * dt;
    if (seen.error > 0) at_once_ = powers_ / dt * seen.error / size(now.cells, level_);
  }
  rate_ = std::move(rate);
  dt_ = now.dt;
}

/// Difference of each owned cell's temperature from a linear fit through its neighbors [K].
std::vector<double> HeatErrors::gaps(const Heat& heat) const {
  const HeatState& now = heat.accepted();
  const std::vector<double> faces = heat.face_temperature(now);  // also where nothing is solved for
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

diagnostics::ErrorParts HeatErrors::parts(const Heat& heat, std::optional<double> reference) const {
  const HeatState& now = heat.accepted();
  diagnostics::ErrorParts parts;
  if (now.steps == 0) return parts;
  const double level = steady_ || !begun_ ? mean(now.cells) : level_;
  const double varies = size(now.cells, level);
  const double size = reference ? this->size(now.cells, *reference) : varies;
  if (!(varies > 1e-12 * std::abs(level)) || !(size > 1e-12 * std::abs(level)))
    return parts;  // uniform temperature has no error
  parts.mesh = root_mean_square(mesh_, geometry_, 1, gaps(heat)) / size;
  if (!steady_) parts.step = std::fmin(steps_.over_size(), at_once_) * varies / size;
  return parts;
}

void HeatErrors::visit(io::Archive& archive) {
  std::vector<double> numbers = steps_.numbers(), before(steps_.before().begin(), steps_.before().end());
  archive.common("heat", begun_, level_, dt_, powers_, at_once_, numbers);
  archive.field(mesh::Entries::owned_cells, "heat-rate-before", before, 1);
  archive.field(mesh::Entries::owned_cells, "heat-rate", rate_, 1);
  if (archive.reads()) steps_.restore(numbers, before);
}

}  // namespace couplet::solid
