// SPDX-License-Identifier: Apache-2.0
// What a run says at its end: its books, the effects it left out and how large they are, its speed.
#include <algorithm>
#include <cmath>

#include "common/diagnostics/finding.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"
#include "thermocline/model/questions.hpp"
#include "thermocline/model/tank.hpp"

namespace couplet::thermocline {
namespace {

using Lines = std::vector<std::string>;

void energy(const TankModel& m, double t, Lines& lines) {
  const double turnover = m.ledger().turnover,
               hair = 1e-12 * m.bed().heat_capacity() * m.fluid_range().second;
  if (turnover <= hair) {
    lines.push_back(fmt::format("energy: no heat moved; energy balance error: bed {:.1e} J, tank {:.1e} J",
                                std::abs(m.bed_imbalance()), std::abs(m.imbalance(t))));
    return;
  }
  lines.push_back(fmt::format(
      "energy: {:.4g} MWh moved, {:.4g} MWh lost; energy balance error / heat moved: bed {:.1e}, tank {:.1e}",
      turnover / 3.6e9, m.losses() / 3.6e9, std::abs(m.bed_imbalance()) / turnover,
      std::abs(m.imbalance(t)) / turnover));
}

/// A parabola stands for the profile in each grain: late by d^2/(60 a) for what changes slowly, wrong for
/// what changes faster than that.
void lumped_grains(const TankModel& m, Lines& lines) {
  const Filler& filler = m.setup().filler;
  double largest = 0;
  for (const auto& run : m.bed().grid().runs)
    if (run.layer.porosity < 1) largest = std::max(largest, run.layer.diameter);
  if (largest == 0) return;
  lines.push_back(fmt::format(
      "grains: with shells: 1 each grain has one temperature and a parabolic profile (linear driving "
      "force); grains of {:.3g} mm follow changes slower than {:.3g} s; five shells are accurate to 2 % for "
      "all changes",
      1e3 * largest, largest * largest * filler.volumetric() / (60 * filler.conductivity)));
}

void fluid(const TankModel& m, double peak_flow, Lines& lines) {
  if (m.inversion().depth > 0.01)
    lines.push_back(fmt::format(
        "buoyancy: at t = {:.6g} s fluid at z = {:.3f} m was {:.2f} K colder than the fluid below it{}",
        m.inversion().time, m.inversion().z, m.inversion().depth,
        m.setup().parameters.bed.mix_inversions ? "; such fluid is mixed" : ""));
  const Fluid& f = m.setup().fluid;
  const auto [cold, hot] = m.fluid_range();
  if (f.real && !f.real_density && hot > cold)
    lines.push_back(fmt::format(
        "density: constant for {} at {:.1f} kg/m^3; from {:.0f} to {:.0f} degC it falls from {:.0f} to "
        "{:.0f} (fluid.real-density)",
        f.name, f.density, celsius(cold), celsius(hot), f.real->at(cold), f.real->at(hot)));
  if (m.bed().shells() == 1) lumped_grains(m, lines);
  if (peak_flow == 0) return;
  // Numerical diffusion G c dz (1 - Co)/2 of the bed's whole capacity, over the way H at the front's speed.
  const BedParameters& bed = m.setup().parameters.bed;
  const double spread =
      std::sqrt((bed.advection == Advection::upwind ? 1 - bed.courant : 1) / m.bed().grid().size());
  if (bed.advection != Advection::tvd && spread > 0.05)
    lines.push_back(fmt::format(
        "cells: upwind differences of {} cells smear a front that crosses the bed over {:.2g} of its height "
        "(standard deviation){}",
        m.bed().grid().size(), spread,
        bed.advection == Advection::upwind ? "; bed.advection: tvd does not" : ""));
  if (!m.setup().parameters.pump) {
    const PressureLoss loss = pressure_loss(m.bed().grid(), f, m.bed().fluid(), peak_flow, m.bed().area());
    lines.push_back(fmt::format(
        "pressure: the bed's loss of {:.3g} kPa at the largest flow, {:.3g} kW of a pump, was neglected "
        "(pump)",
        1e-3 * loss.loss(), 1e-3 * pump_power(loss, f, m.bed().bottom(), peak_flow, 0.7)));
  }
  std::string layers;
  for (const auto& run : m.bed().grid().runs)
    layers += fmt::format("{}{:.3g}", layers.empty() ? "" : ", ",
                          m.bed().reynolds(run.first + run.count / 2, peak_flow));
  lines.push_back(
      fmt::format("closures: Re of the layers at the largest flow {} from the bottom up; the film "
                  "correlation is fitted to Re from 15 to 8500",
                  layers));
}

void surroundings(const TankModel& m, const Ambient& air, Lines& lines) {
  const TankParameters& p = m.setup().parameters;
  std::string tight;
  const ElsewhereParameters elsewhere = p.elsewhere.value_or(ElsewhereParameters{});
  for (const auto& [there, name] : {std::pair{p.insulation || elsewhere.insulation, "side (insulation)"},
                                    {p.insulation && p.ullage, "roof (insulation and ullage)"},
                                    {p.ground || elsewhere.ground, "bottom (ground)"}})
    if (!there) tight += fmt::format("{}{}", tight.empty() ? "" : ", ", name);
  if (!tight.empty()) lines.push_back(fmt::format("no heat loss through neglected elements: {}", tight));
  if (!m.shell() || p.insulation || elsewhere.insulation) return;
  const auto& rings = *m.setup().rings;
  double area = 0, sum = 0;
  for (int i = 0; i < rings.size(); ++i)
    area += rings.surface(i), sum += rings.surface(i) * m.shell()->temperature()[i];
  const double wall = sum / area, height = rings.z.back() + rings.dz.back() / 2;
  const Film film = side_film({}, wall, p.diameter, height, air);
  lines.push_back(fmt::format("the bare side, at {:.0f} degC now, would lose {:.3g} MW", celsius(wall),
                              1e-6 * area * film.coefficient * (wall - film.reference)));
}

void wall(const TankModel& m, const BendingSeen& bending, Lines& lines) {
  const auto& rings = m.setup().rings;
  const double diameter = m.setup().parameters.diameter;
  if (m.shell() && !m.mechanics() && !m.contact()) {
    const auto wall = m.shell()->temperature();
    const auto [low, high] = std::minmax_element(wall.begin(), wall.end());
    const Steel& steel = *m.setup().steel;
    const double strain = steel.thermal_strain(*high) - steel.thermal_strain(*low) -
                          m.setup().filler.expansion * (*high - *low);
    lines.push_back(fmt::format(
        "filler mechanics neglected: cooling a ring from {:.0f} to {:.0f} degC against a rigid filler would "
        "add {:.0f} MPa of hoop stress",
        celsius(*high), celsius(*low), 1e-6 * steel.youngs_modulus(*low) * std::max(0.0, strain)));
  }
  if (m.shell() && !m.contact()) {
    // beta^4 = 3 (1 - nu^2)/(a^2 e^2): edge effects of a cylinder fade as exp(-beta z).
    const double nu = m.setup().steel->poissons_ratio;
    const double e = *std::max_element(rings->thickness.begin(), rings->thickness.end());
    std::string line = fmt::format("bending of the wall neglected: it smooths variations within {:.2f} m",
                                   std::sqrt(diameter / 2 * e) / std::pow(3 * (1 - nu * nu), 0.25));
    if (bending.rings > 0)
      line += fmt::format(
          "; the largest hoop stress of {:.0f} MPa becomes {:.0f} at z = {:.2f} m, with a max bending "
          "stress of {:.0f} MPa along z, at z = {:.2f} m and t = {:.6g} s (external-wall computes it)",
          1e-6 * bending.rings, 1e-6 * bending.shell, bending.shell_z, 1e-6 * bending.axial, bending.axial_z,
          bending.axial_time);
    lines.push_back(line);
  }
  if (!m.mechanics() && !m.contact()) return;
  const auto slip = m.mechanics() ? m.mechanics()->slip() : m.contact()->slip();
  const std::size_t i = std::max_element(slip.begin(), slip.end()) - slip.begin();
  lines.push_back(
      fmt::format("filler: {} of {} rings have reached the passive limit; max cumulative displacement of "
                  "the grains by the wall {:.2g} mm, at z = {:.2f} m",
                  std::count_if(slip.begin(), slip.end(), [](double s) { return s > 0; }), slip.size(),
                  500 * slip[i] * diameter, rings->z[i]));
}

void speed(const Speed& speed, int cells, Lines& lines) {
  double total = 0;
  for (const double s : speed.seconds) total += s;
  if (speed.cell_steps == 0) return;
  std::string shares;
  for (std::size_t i = 0; i < element_names.size(); ++i)
    if (speed.seconds[i] > 0)
      shares += fmt::format("{}{} {:.2f} ns ({:.0f} %)", shares.empty() ? "" : ", ", element_names[i],
                            1e9 * speed.seconds[i] / speed.cell_steps, 100 * speed.seconds[i] / total);
  lines.push_back(fmt::format("speed: {:.2f} ns per cell-step of the bed in {} steps of {} cells: {}",
                              1e9 * total / speed.cell_steps, speed.bed_steps, cells, shares));
}

}  // namespace

std::vector<std::string> Tank::finish() {
  for (const auto& observer : observers_) {
    observer->finish();
    for (const std::string& doubt : observer->doubts())
      diagnostics::finding(parallel::comm_rank(comm_),
                           {.id = "day-report", .sentence = fmt::format("{}: {}", name_, doubt)});
  }
  Lines lines;
  const TankModel& m = accepted_;
  for (const std::string& sentence : control_->doubts())
    diagnostics::finding(parallel::comm_rank(comm_),
                         {.id = "flow-schedule", .sentence = fmt::format("{}: {}", name_, sentence)});
  for (const std::string& sentence : never_melted(m))
    diagnostics::finding(parallel::comm_rank(comm_),
                         {.id = "never-melted", .sentence = fmt::format("{}: {}", name_, sentence)});
  const double t = step_.time + step_.dt;
  energy(m, t, lines);
  fluid(m, peak_flow_, lines);
  surroundings(m, weather_->at(t), lines);
  if (m.bed().fallbacks() > 0)
    lines.push_back(fmt::format("bed: {} of {} steps {}", m.bed().fallbacks(), speed_.bed_steps,
                                m.bed().melts()
                                    ? "ended before the temperatures of the melting layers converged to "
                                      "1e-6 K"
                                    : "were first order in time to remain bounded"));
  wall(m, bending_, lines);
  thermocline::speed(speed_, m.bed().grid().size(), lines);
  return lines;
}

}  // namespace couplet::thermocline
