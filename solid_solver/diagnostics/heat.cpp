// SPDX-License-Identifier: Apache-2.0
// Temperatures that are solved for: swings from step to step, values below absolute zero, storage that a steady run neglects.
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/diagnostics/reference.hpp"
#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/diagnostics/view.hpp"

namespace couplet::solid {
namespace {

constexpr int patience = 4;              // turns in a row
constexpr double turning_cosine = -0.5;  // cosine between the changes of two steps
constexpr double noticeable = 1e-3;      // root mean square of a step's change over all temperatures seen

/// Change of a temperature of this size that its solver cannot tell from none [K].
double rounding_of(double temperature) { return HeatParameters::linear_tolerance * std::abs(temperature); }

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
  const double size = std::sqrt(sums[0] / sums[3]), share = range_.share(size, rounding_of(highest_));
  const bool turns = sums[2] < turning_cosine * std::sqrt(sums[0] * sums[1]) && share > noticeable;
  turns_ = turns ? turns_ + 1 : 0;
  if (turns_ < patience) return;
  told_ = true;
  report.findings.push_back(
      {.id = "heat-swing",
       .number = share,
       .limit = noticeable,
       .sentence = fmt::format(
           "the temperature oscillates from step to step: amplitude {:.3g} K (rms) in a range of {:.3g} K: 'heat: {{scheme: "
           "trapezoidal}}' does not damp unresolved modes. Use 'scheme: three-point' or 'euler', or shorter steps.",
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
               "the temperature falls to {:.4g} K, below absolute zero: more heat is withdrawn than the body contains; check "
               "the signs and units of fluxes, films and sources",
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
  if (!(rate > 0) || !(range > rounding_of(level))) return;
  // A ramp is followed at the distance of this time, of which the range of temperatures is one.
  const double time = size * size * stored / m.conductivity(level), lag = time * rate / range;
  if (auto finding = diagnostics::finding_of(
          {.effect = "storage of heat",
           .number = stored > 0 ? lag : 1,
           .limit = diagnostics::no_verdict,
           .what =
               stored > 0
                   ? fmt::format(
                         "heat needs about {:.2g} s to spread through the solid, but the temperature changes within {:.2g} s",
                         time, range / rate)
                   : "the temperature changes, but no 'specific-heat' is given",
           .advice = "use 'analysis: transient' in 'heat'",
           .share = stored > 0 ? lag / (1 + lag) : std::numeric_limits<double>::quiet_NaN()}))
    report.findings.push_back(std::move(*finding));
}

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

}  // namespace couplet::solid
