// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/diagnostics/heat_errors.hpp"
#include "solid_solver/diagnostics/view.hpp"

namespace couplet::solid {
namespace {

constexpr int patience = 4;              // turns in a row
constexpr double turning_cosine = -0.5;  // cosine between the changes of two steps
constexpr double noticeable = 1e-3;      // root mean square of a step's change over all temperatures seen

/// Detects a temperature that alternates between steps. The trapezoidal rule reverses modes that its step
/// does not resolve (a shock, a large Fourier number) instead of damping them: amplification (1 - z/2)/(1 +
/// z/2), towards -1 for z = dt/tau to infinity.
class HeatSwing final : public diagnostics::Diagnostic {
 public:
  explicit HeatSwing(const Heat& heat) : heat_(heat) {}
  void observe(diagnostics::Report& report) override;
  void visit(io::Archive& archive) override {
    archive.common("swing", lowest_, highest_, turns_, begun_, told_);
    archive.field(mesh::Entries::owned_cells, "change", change_, 1);
  }

 private:
  const Heat& heat_;
  std::vector<double> change_;       // of owned cells in the last step [K]; or empty
  double lowest_ = 0, highest_ = 0;  // that was seen [K]
  int turns_ = 0;                    // in a row
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
  const double size = std::sqrt(sums[0] / sums[3]);
  const bool turns =
      sums[2] < turning_cosine * std::sqrt(sums[0] * sums[1]) && size > noticeable * (highest_ - lowest_);
  turns_ = turns ? turns_ + 1 : 0;
  if (turns_ < patience) return;
  told_ = true;
  report.findings.push_back(
      {.id = "heat-swing",
       .number = size / (highest_ - lowest_),
       .limit = noticeable,
       .sentence = fmt::format(
           "the temperature oscillates from step to step: amplitude {:.3g} K (rms) in a range "
           "of {:.3g} K: 'heat: {{scheme: trapezoidal}}' does not damp unresolved modes. Use 'scheme: "
           "three-point' or 'euler', or shorter steps.",
           size, highest_ - lowest_)});
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
  void conclude(diagnostics::Report& report) override;

 private:
  const Heat& heat_;
};

void HeatStorage::conclude(diagnostics::Report& report) {
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
  for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f)
    if (conduction.condition(f) != fv::HeatCondition::symmetry &&
        conduction.condition(f) != fv::HeatCondition::bonded)
      surface += conduction.geometry().face_area[f].norm();
  volume = parallel::sum(mesh.comm, volume);
  level = parallel::sum(mesh.comm, level) / volume;
  const double size = volume / parallel::sum(mesh.comm, surface);
  const double stored = m.density * m.specific_heat(level);
  if (!(stored > 0)) {
    report.sentences.emplace_back(
        "heat storage neglected (steady): give 'specific-heat' to compare its time scale with the step.");
    return;
  }
  const double time = size * size * stored / m.conductivity(level);
  report.sentences.push_back(
      fmt::format("heat storage neglected (steady): heat needs about {:.2g} s to spread through the solid, "
                  "a step takes {:.2g} s (Fourier number {:.2g}): {}.",
                  time, state.dt, state.dt / time,
                  state.dt > 3 * time ? "justified"
                                      : "not justified if the loads change that fast; use 'analysis: "
                                        "transient'"));
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
