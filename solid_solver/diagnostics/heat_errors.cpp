// SPDX-License-Identifier: Apache-2.0

#include "solid_solver/diagnostics/heat_errors.hpp"

#include <fmt/format.h>
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/diagnostics/reference.hpp"
#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"
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

}  // namespace

HeatErrors::HeatErrors(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                       const HeatParameters& parameters)
    : mesh_(mesh),
      geometry_(geometry),
      steady_(parameters.analysis == HeatParameters::Analysis::steady),
      scheme_(parameters.scheme),
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
  if (dt_ > 0)  // the same on all ranks, also on one without cells
    steps_.add(
        rate_, rate, 0.5 * (now.dt + dt_), dt_, size(now.cells, level_),
        [this](std::span<const double> cells) { return root_mean_square(mesh_, geometry_, 1, cells); });
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

/// Error of one or two steps [K]. The temperature of a cell approaches its end like e^(-z) per step; the scheme leaves
/// `left` of the distance instead. The ratio q of its two changes tells z. For Euler and the trapezoidal rule q is what one
/// step leaves, for three-point, which begins with Euler, 1.5/(1.5 + z). A single step gets its second change from the same
/// matrix. Measured on slabs with a source and with a shock, for Fourier numbers from 0.02 to 1000: 0.5 to 1.25 of the error.
double HeatErrors::of_first_steps(const Heat& heat) const {
  using Scheme = HeatParameters::Scheme;
  constexpr double even = 1e-3, least = 1e-9;  // from which 1 - q and 1/q have digits
  const int steps = heat.accepted().steps;
  const std::vector<double> second = steps == 1 ? heat.next_change(rate_) : rate_;
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
    if (scheme_ == Scheme::trapezoidal) {
      z = 2 * (1 - q) / std::max(1 + q, least);
    } else if (scheme_ == Scheme::three_point && steps == 2) {
      z *= 1.5;
      left = (2 - 0.5 * (1 + z)) / ((1 + z) * (1.5 + z));
      changed = z / (1 + z);
    }
    error[c] = (left - std::exp(-steps * z)) / changed * dt_ * first[c];
  }
  return root_mean_square(mesh_, geometry_, 1, error);
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
  if (steady_) return parts;
  parts.step = steps_.over_size() * varies / size;
  if (std::isnan(parts.step) && now.steps <= 2) parts.step = of_first_steps(heat) / size;
  return parts;
}

void HeatErrors::visit(io::Archive& archive) {
  std::vector<double> numbers = steps_.numbers(), before(steps_.before().begin(), steps_.before().end());
  archive.common("heat", begun_, level_, dt_, numbers);
  archive.field(mesh::Entries::owned_cells, "heat-rate-before", before, 1);
  archive.field(mesh::Entries::owned_cells, "heat-rate", rate_, 1);
  if (archive.reads()) steps_.restore(numbers, before);
}

namespace {

constexpr int patience = 4;              // turns in a row
constexpr double turning_cosine = -0.5;  // cosine between the changes of two steps
constexpr double noticeable = 1e-3;      // root mean square of a step's change over all temperatures seen

/// Change of a temperature of this size that its solver cannot tell from none [K].
double rounding_of(const Heat& heat, double temperature) {
  return heat.parameters().linear_tolerance * std::abs(temperature);
}

/// Detects a temperature that alternates between steps. The trapezoidal rule reverses modes that its step
/// does not resolve (a shock, a large Fourier number) instead of damping them: amplification (1 - z/2)/(1 +
/// z/2), towards -1 for z = dt/tau to infinity.
class HeatSwing final : public diagnostics::Diagnostic {
 public:
  explicit HeatSwing(const Heat& heat) : heat_(heat) {}
  void observe(diagnostics::Report& report) override;
  void visit(io::Archive& archive) override {
    archive.common("swing", lowest_, highest_, range_, turns_, begun_, told_);
    archive.field(mesh::Entries::owned_cells, "change", change_, 1);
  }

 private:
  const Heat& heat_;
  std::vector<double> change_;       // of owned cells in the last step [K]; or empty
  double lowest_ = 0, highest_ = 0;  // that was seen [K]
  diagnostics::Reference range_{"heat: range of temperature"};
  int turns_ = 0;  // in a row
  bool begun_ = false;
  bool told_ = false;
};

void HeatSwing::observe(diagnostics::Report& report) {
  if (told_) return;
  const mesh::Mesh& mesh = heat_.conduction().mesh();
  const std::vector<double>&before = heat_.trial().cells, &after = heat_.accepted().cells;
  const bool first = !begun_;  // the same on all ranks, also on one without cells
  begun_ = true;
  change_.resize(std::size_t(mesh.cells.n_owned()), 0.0);
  double sums[4] = {};  // change.change, last.last, change.last, volume
  double range[2] = {-1e300, -1e300};
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    const double volume = heat_.conduction().geometry().volume[c], change = after[c] - before[c];
    sums[0] += volume * change * change;
    sums[1] += volume * change_[c] * change_[c];
    sums[2] += volume * change * change_[c];
    sums[3] += volume;
    range[0] = std::max({range[0], after[c], before[c]});
    range[1] = std::max({range[1], -after[c], -before[c]});
    change_[c] = change;
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 4, MPI_DOUBLE, MPI_SUM, mesh.comm);
  MPI_Allreduce(MPI_IN_PLACE, range, 2, MPI_DOUBLE, MPI_MAX, mesh.comm);
  highest_ = first ? range[0] : std::max(highest_, range[0]);
  lowest_ = first ? -range[1] : std::min(lowest_, -range[1]);
  range_.add(highest_ - lowest_, heat_.accepted().dt);
  const double size = std::sqrt(sums[0] / sums[3]), share = range_.share(size, rounding_of(heat_, highest_));
  const bool turns = sums[2] < turning_cosine * std::sqrt(sums[0] * sums[1]) && share > noticeable;
  turns_ = turns ? turns_ + 1 : 0;
  if (turns_ < patience) return;
  told_ = true;
  report.findings.push_back(
      {.id = "heat-swing",
       .number = share,
       .limit = noticeable,
       .sentence = fmt::format(
           "the temperature oscillates from step to step: amplitude {:.3g} K (rms) in a range "
           "of {:.3g} K: 'heat: {{scheme: trapezoidal}}' does not damp unresolved modes. Use 'scheme: "
           "three-point' or 'euler', or shorter steps.",
           size, range_.value())});
}

/// Finds temperatures below absolute zero, which a linear equation yields if more heat is drawn than there is.
class ImpossibleTemperature final : public diagnostics::Diagnostic {
 public:
  explicit ImpossibleTemperature(const Heat& heat) : heat_(heat) {}
  void look(diagnostics::Report& report) override {
    const std::vector<double>& cells = heat_.accepted().cells;
    const double lowest =
        parallel::min(heat_.conduction().mesh().comm, cells.empty() ? 0 : std::ranges::min(cells));
    if (lowest < 0)
      report.findings.push_back(
          {.id = "impossible-temperature",
           .severity = base::Severity::wrong,
           .number = lowest,
           .limit = 0,
           .sentence = fmt::format(
               "the temperature falls to {:.4g} K, below absolute zero: more heat is drawn than there is; "
               "check fluxes, films and sources, their signs and units",
               lowest)});
  }

 private:
  const Heat& heat_;
};

/// Judges whether a steady temperature could follow its loads. Heat takes L^2/a to cross a solid of half
/// thickness L = volume/surface, a = k/(rho c).
class HeatStorage final : public diagnostics::Diagnostic {
 public:
  explicit HeatStorage(const Heat& heat) : heat_(heat) {}
  void observe(diagnostics::Report&) override {
    const std::vector<double>&now = heat_.accepted().cells, &before = heat_.trial().cells;
    for (std::size_t c = 0; c < now.size(); ++c) {
      low_ = std::min(low_, now[c]), high_ = std::max(high_, now[c]);
      if (heat_.accepted().steps > 1)
        rate_ = std::max(rate_, std::abs(now[c] - before[c]) / heat_.accepted().dt);
    }
  }
  void look(diagnostics::Report& report) override;
  void visit(io::Archive& archive) override {
    const MPI_Comm comm = heat_.conduction().mesh().comm;
    low_ = parallel::min(comm, low_), high_ = parallel::max(comm, high_), rate_ = parallel::max(comm, rate_);
    archive.common("storage", low_, high_, rate_);
  }

 private:
  const Heat& heat_;
  double low_ = std::numeric_limits<double>::max(), high_ = std::numeric_limits<double>::lowest(),
         rate_ = 0;  // of the run [K], fastest change [K/s]; of this rank
};

void HeatStorage::look(diagnostics::Report& report) {
  const HeatState& state = heat_.accepted();
  if (state.steps < 2) return;
  const HeatProperties& m = heat_.materials().front();
  const fv::ConductionOperator& conduction = heat_.conduction();
  const mesh::Mesh& mesh = conduction.mesh();
  double volume = 0, surface = 0, level = 0;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    volume += conduction.geometry().volume[c];
    level += conduction.geometry().volume[c] * state.cells[c];
  }
  for (const mesh::Patch& patch : mesh.patches) {
    const auto given = heat_.parameters().boundaries.find(patch.name);
    if (given == heat_.parameters().boundaries.end() || !given->second.carries_heat()) continue;
    for (Index f = patch.first; f < patch.first + patch.count; ++f)
      surface += conduction.geometry().face_area[f].norm();
  }
  volume = parallel::sum(mesh.comm, volume);
  level = parallel::sum(mesh.comm, level) / volume;
  const double size = volume / parallel::sum(mesh.comm, surface);
  const double stored = m.density * m.specific_heat(level);
  const double range = parallel::max(mesh.comm, high_) - parallel::min(mesh.comm, low_),
               rate = parallel::max(mesh.comm, rate_);
  if (!(rate > 0) || !(range > rounding_of(heat_, level))) return;
  // A ramp is followed at the distance of this time, of which the range of temperatures is one.
  const double time = size * size * stored / m.conductivity(level), lag = time * rate / range;
  if (auto finding = diagnostics::finding_of(
          {.effect = "storage of heat",
           .number = stored > 0 ? lag : 1,
           .limit = diagnostics::no_verdict,
           .what = stored > 0 ? fmt::format("heat needs about {:.2g} s to spread through the solid, the "
                                            "temperature changes within {:.2g} s",
                                            time, range / rate)
                              : "the temperature changes, and no 'specific-heat' is given",
           .advice = "use 'analysis: transient' in 'heat'",
           .share = stored > 0 ? lag / (1 + lag) : std::numeric_limits<double>::quiet_NaN()}))
    report.findings.push_back(std::move(*finding));
}

/// Error of the temperature of a body that only conducts heat.
class HeatError final : public diagnostics::Diagnostic {
 public:
  explicit HeatError(const Heat& heat)
      : heat_(heat), errors_(heat.conduction().mesh(), heat.conduction().geometry(), heat.parameters()) {}
  void observe(diagnostics::Report&) override { errors_.see_step(heat_.trial(), heat_.accepted()); }
  void conclude(diagnostics::Report& report) override { report.errors = errors_.parts(heat_); }
  void visit(io::Archive& archive) override { errors_.visit(archive); }

 private:
  const Heat& heat_;
  HeatErrors errors_;
};

}  // namespace

diagnostics::Made heat_swing(const Heat& heat) {
  // The only scheme without damping.
  if (heat.is_steady() || heat.parameters().scheme != HeatParameters::Scheme::trapezoidal) return nullptr;
  return std::make_shared<HeatSwing>(heat);
}

diagnostics::Made impossible_temperature(const Heat& heat) {
  return std::make_shared<ImpossibleTemperature>(heat);
}

diagnostics::Made heat_storage(const Heat& heat) {
  if (!heat.is_steady()) return nullptr;
  return std::make_shared<HeatStorage>(heat);
}

diagnostics::Made heat_error(const Heat& heat) { return std::make_shared<HeatError>(heat); }

}  // namespace couplet::solid
