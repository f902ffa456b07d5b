// SPDX-License-Identifier: Apache-2.0

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/diagnostics/view.hpp"
#include "fluid_solver/parameters/parameters.hpp"

namespace couplet::fluid {

namespace {

// A smaller share of the mean square is round-off.
constexpr double rounding = 1e-9;

template <int D>
std::optional<Sound> sound_in(const FluidView<D>& view) {
  const FluidParameters& p = view.parameters();
  return sound_of(p.compressibility, p.density, p.properties().mu);
}

/// Pressure waves: the current change of density, and wall motion and pressure response over the run.
template <int D>
class WavesOfPressure final : public diagnostics::Diagnostic {
 public:
  WavesOfPressure(const FluidView<D>& view, const Sound& sound)
      : view_(view),
        sound_(sound),
        moves_((view.has_interface && view.has_mover) || view.is_prescribed || has_bodies(view)) {
    if (!moves_) return;
    faces_ = moving_faces(view);
    for (const Index f : faces_) at_start_.push_back(centre(f));
  }
  void observe(diagnostics::Report&) override {
    const auto latest = moves_ ? view_.fluid.pressure() : nullptr;
    if (!latest) return;
    const mesh::Mesh& mesh = view_.mesh;
    const Placement<D>& now = *view_.fluid.state().placement;
    std::vector<double> swept;
    std::array<double, 4> sums{};  // swept, pressure times volume, pressure times area and area of inlets
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      const Vec3 moved = centre(faces_[i]) - at_start_[i];
      swept.push_back(moved.template head<D>().dot(now.area[faces_[i]]));
      sums[0] += swept.back();
    }
    for (Index c = 0; c < mesh.cells.n_owned(); ++c) sums[1] += latest->p[c] * now.volume[c];
    for (const mesh::Patch& patch : mesh.patches)
      if (condition_of(view_.parameters().boundaries.at(patch.name)).passage == Passage::in)
        for (Index f = patch.first; f < patch.first + patch.count; ++f) {
          sums[2] += latest->p[mesh.owner[f]] * now.area[f].norm();
          sums[3] += now.area[f].norm();
        }
    MPI_Allreduce(MPI_IN_PLACE, sums.data(), int(sums.size()), MPI_DOUBLE, MPI_SUM, mesh.comm);
    const auto& known = view_.parameters().compressibility;
    if (sums[3] > 0) sums[1] += (known ? known->upstream_volume : 0) * sums[2] / sums[3];
    means_.add(view_.step.dt, swept, {sums[0], sums[1]});
  }
  void look(diagnostics::Report& report) override {
    if (view_.parameters().is_compressible()) return;
    if (const auto range = pressure_range(view_))
      add(report, change_of_density(false, density(), *range, largest_speed(view_), sound_));
  }
  void conclude(diagnostics::Report& report) override {
    if (view_.parameters().is_compressible()) return;
    const ComplianceMeans::Walls mine = means_.walls();
    std::array<double, 3> walls{mine.square, mine.rate, mine.size};
    MPI_Allreduce(MPI_IN_PLACE, walls.data(), int(walls.size()), MPI_DOUBLE, MPI_SUM, view_.mesh.comm);
    const double size = largest_extent(view_.mesh, view_.fluid.state().placement->boundary_centre);
    double rate = parallel::max(
        view_.mesh.comm, prescribed_rate(
                             view_.parameters(), [&](const std::string& name) { return some_places(name); },
                             view_.step.time + view_.step.dt, view_.step.dt));
    // Less than a period shows the start of a motion, in which pressures come before displacements.
    const double of_walls = walls[0] > 0 ? std::sqrt(walls[1] / walls[0]) : 0;
    if (of_walls * means_.time() > 2 * std::numbers::pi) {
      const ComplianceMeans::Totals totals = means_.totals();
      // A plate in the fluid sweeps the same volume on both sides.
      const double stroke = std::max(totals.swept, 0.5 * walls[2]);
      add(report, compliance(density(), stroke, totals.pressure_volume, sound_));
      rate = std::max(rate, of_walls);
    }
    if (rate > 0) add(report, wave_time(rate, size, sound_));
  }
  void visit(io::Archive& archive) override {
    if (!moves_) return;
    archive.common("means", means_);
    constexpr std::size_t width = 4;
    std::vector<double> flat(width * std::size_t(view_.mesh.boundary.n_owned()));
    const auto values = means_.per_face();
    const auto place = [&](std::size_t i, std::size_t k) {
      return width * std::size_t(faces_[i] - view_.mesh.n_interior) + k;
    };
    for (std::size_t k = 0; k < width; ++k)
      for (std::size_t i = 0; i < values[k]->size(); ++i) flat[place(i, k)] = (*values[k])[i];
    archive.field(mesh::Entries::owned_boundary, "walls", flat, width);
    if (!archive.reads() || flat.empty()) return;
    for (std::size_t k = 0; k < width; ++k) {
      values[k]->resize(faces_.size());
      for (std::size_t i = 0; i < faces_.size(); ++i) (*values[k])[i] = flat[place(i, k)];
    }
  }

 private:
  double density() const { return view_.properties().rho; }
  /// The first, a middle and the last face of a patch on this rank. What the motion moves is observed.
  std::vector<PlaceOfPatch> some_places(const std::string& name) const {
    const mesh::Patch* patch = name.empty() ? nullptr : view_.mesh.find_patch(name);
    if (!patch || patch->count == 0) return {};
    const auto place = [&](Index face) {
      PlaceOfPatch found{centre(face), Vec3::Zero()};
      found.normal.template head<D>() = view_.fluid.state().placement->area[face].normalized();
      return found;
    };
    return {place(patch->first), place(patch->first + patch->count / 2),
            place(patch->first + patch->count - 1)};
  }
  static bool has_bodies(const FluidView<D>& view) { return !view.fluid.boundary().body_patches().empty(); }
  const Vec3& centre(Index face) const {
    return view_.fluid.state().placement->boundary_centre[face - view_.mesh.n_interior];
  }
  static void add(diagnostics::Report& report, const diagnostics::EffectFinding& effect) {
    if (auto finding = diagnostics::finding_of(effect)) report.findings.push_back(std::move(*finding));
  }

  FluidView<D> view_;
  Sound sound_;
  bool moves_;
  std::vector<Index> faces_;    // of walls that move
  std::vector<Vec3> at_start_;  // their centers
  ComplianceMeans means_;
};

}  // namespace

// Skips the step in which the flow starts, because its pressure contains the impulse of the start.
void ComplianceMeans::add(double dt, const std::vector<double>& swept, const Totals& now) {
  sum_.resize(swept.size());
  square_.resize(swept.size());
  rate_.resize(swept.size());
  if (steps_++ > 0) {
    for (std::size_t i = 0; i < swept.size(); ++i) {
      const double change = swept[i] - last_[i];
      sum_[i] += dt * swept[i];
      square_[i] += dt * swept[i] * swept[i];
      rate_[i] += change * change / dt;
    }
    mean_.swept += dt * now.swept;
    mean_.pressure_volume += dt * now.pressure_volume;
    mean_square_.swept += dt * now.swept * now.swept;
    mean_square_.pressure_volume += dt * now.pressure_volume * now.pressure_volume;
    time_ += dt;
  }
  last_ = swept;
}

ComplianceMeans::Walls ComplianceMeans::walls() const {
  Walls w;
  if (!(time_ > 0)) return w;
  for (std::size_t i = 0; i < sum_.size(); ++i) {
    const double mean = sum_[i] / time_, square = square_[i] / time_, variance = square - mean * mean;
    if (variance <= rounding * square) continue;
    w.square += variance;
    w.size += std::sqrt(variance);
  }
  for (const double rate : rate_) w.rate += rate / time_;
  return w;
}

ComplianceMeans::Totals ComplianceMeans::totals() const {
  if (!(time_ > 0)) return {};
  const auto deviation = [&](double sum, double square) {
    return std::sqrt(std::max(0.0, square / time_ - sum * sum / (time_ * time_)));
  };
  return {deviation(mean_.swept, mean_square_.swept),
          deviation(mean_.pressure_volume, mean_square_.pressure_volume)};
}

// Density changes scale with half the squared Mach number: 5 % at 0.3.
diagnostics::EffectFinding mach_number(double speed, const Sound& sound) {
  const double mach = speed / sound.speed;
  return {
      .effect = "compressibility",
      .number = mach,
      .what = fmt::format("max speed {:.3g} m/s = {:.2g} times the speed of sound in {} ({:.4g} m/s)", speed,
                          mach, sound.of, sound.speed),
      .advice =
          "the density would change by more than 5 %: use a compressible solver; if the speed of sound differs, set it in "
          "'compressibility'",
      .share =
          1 / std::sqrt(1 - std::pow(std::min(mach, 0.9), 2)) - 1};  // of pressures [Prandtl and Glauert]
}

// If flow is stopped or driven faster than waves cross the domain, the pressure rises as rho c du or rho L
// du/dt at any Mach number, and the density by dp/(rho c^2). The speed alone explains 2 M^2 of a body in a
// stream (pressures from 1 to -3 of rho u^2/2), which is the share of compressibility. Linear acoustics
// neglects effects of the density change.
diagnostics::EffectFinding change_of_density(bool is_compressible, double density, double range, double speed,
                                             const Sound& sound) {
  const double change = range / (density * sound.speed * sound.speed);
  return {
      .effect = is_compressible ? "small changes of density" : "waves of pressure",
      .number = change,
      .limit = 0.05,
      .what = fmt::format("a pressure range of {:.3g} Pa changes the density of {} by a fraction of {:.2g}",
                          range, sound.of, change),
      .advice =
          is_compressible
              ? "'compressibility' is valid only for small changes of density: use a compressible solver"
              : "the flow changes faster than pressure waves would allow: add 'compressibility'",
      .left_out = !is_compressible,
      .share = std::max(0., change - 2 * std::pow(speed / sound.speed, 2))};
}

// Compression takes up part of the volume displaced by walls, V dp/(rho c^2), for a gas V dp/(gamma p). An
// incompressible fluid would push this share of the stroke through the openings.
diagnostics::EffectFinding compliance(double density, double stroke, double pressure_volume,
                                      const Sound& sound) {
  // Where walls hardly move the fluid leaves by its openings.
  const double volume = pressure_volume / (density * sound.speed * sound.speed),
               share = volume > stroke ? 1 : volume / stroke;
  return {.effect = "waves of pressure",
          .number = share,
          .what = fmt::format("compression of {} / volume displaced by the walls = {:.2g}", sound.of, share),
          .advice =
              "the compliance of the fluid may change frequencies and stability of the coupled motion: add "
              "'compressibility'",
          .share = share};
}

// A column of length L responds to motion of rate omega as tan(omega L/c)/(omega L/c): 3 % more at 0.3.
diagnostics::EffectFinding wave_time(double rate, double size, const Sound& sound) {
  const double phase = rate * size / sound.speed;
  return {
      .effect = "waves of pressure",
      .number = phase,
      .what = fmt::format(
          "the travel time of sound across {} is {:.2g} s = {:.2g} times the time scale 1/omega = {:.2g} s of the driving motion",
          sound.of, size / sound.speed, phase, 1 / rate),
      .advice = "pressure waves return while this motion changes: add 'compressibility'",
      .share = phase < 1 ? std::tan(phase) / std::max(phase, 1e-300) - 1 : 1};
}

template <int D>
std::optional<diagnostics::Finding> compressibility(const FluidView<D>& view) {
  const auto sound = sound_in(view);
  if (!sound) return {};
  return diagnostics::finding_of(mach_number(largest_speed(view), *sound));
}

template <int D>
std::optional<diagnostics::Finding> changes_of_density(const FluidView<D>& view) {
  const auto sound = sound_in(view);
  const auto range = view.parameters().is_compressible() && sound ? pressure_range(view) : std::nullopt;
  if (!range) return {};
  return diagnostics::finding_of(
      change_of_density(true, view.properties().rho, *range, largest_speed(view), *sound));
}

template <int D>
diagnostics::Made waves_of_pressure(const FluidView<D>& view) {
  const auto sound = sound_in(view);
  return sound ? std::make_shared<WavesOfPressure<D>>(view, *sound) : nullptr;
}

template std::optional<diagnostics::Finding> compressibility(const FluidView<2>&);
template std::optional<diagnostics::Finding> compressibility(const FluidView<3>&);
template std::optional<diagnostics::Finding> changes_of_density(const FluidView<2>&);
template std::optional<diagnostics::Finding> changes_of_density(const FluidView<3>&);
template diagnostics::Made waves_of_pressure(const FluidView<2>&);
template diagnostics::Made waves_of_pressure(const FluidView<3>&);

}  // namespace couplet::fluid
