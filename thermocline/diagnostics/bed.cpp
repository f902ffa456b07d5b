// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "common/io/checkpoint.hpp"
#include "thermocline/diagnostics/tank_diagnostic.hpp"

namespace couplet::thermocline {
namespace {

/// Checks grains with a single shell. It assumes a parabolic profile (linear driving force): 1/h becomes (1 + Bi/5)/h. Of the time in
/// which the front has passed, the film delays a grain by x_f = d rho c/(6 h) and its inside by x_g = d^2 rho c/(60 k). The exponent
/// of the front's Laplace transform then lacks 3/7 x_g^2 s^3 beside a Gaussian of variance 2 (x_f + x_g), which changes a step by
///   2 (3/7) x_g^2 |g''| = 0.39 x_g^2 (2 (x_f + x_g))^(-5/4),   |g''|^2 = 3/(8 sqrt(pi)) at variance 1,
/// bounded by 1 for a front that is wider than the bed.
class ResolvedGrains final : public TankDiagnostic {
 public:
  using TankDiagnostic::TankDiagnostic;
  void look(diagnostics::Report& report) override {
    if (bed().shells() > 1 || !(seen_->flow > 0)) return;
    const auto [biot, share] = largest_biot();
    add(report,
        {.effect = "resolved grains",
         .number = biot,
         .what = fmt::format(
             "Biot number of the grains = {:.2g}: their internal thermal resistance is {:.2g} times that of the film",
             biot, biot / 5),
         .advice = "set 'bed.shells'; five shells resolve the grains",
         .share = share});
    report.position.push_back({"Biot number of the grains", biot, 20, "tank-biot"});
  }
  void conclude(diagnostics::Report& report) override {
    if (!(seen_->flow > 0)) return;
    std::string layers;
    double spread = 0;
    bool is_outside = false;
    for (std::size_t r = 0; r < bed().grid().runs.size(); ++r) {
      const BedGrid::Run& run = bed().grid().runs[r];
      const double flux = seen_->flow / bed().area(), kelvin = bed().fluid()[run.first + run.count / 2];
      const double reynolds = bed().closure(r).reynolds(kelvin, flux);
      layers += fmt::format("{}{:.3g}", layers.empty() ? "" : ", ", reynolds);
      if (run.layer.porosity >= 1 || (reynolds >= 15 && reynolds <= 8500)) continue;
      is_outside = true;
      // Each layer adds the delay by its film to the square of the width of a front, over the time of its passage.
      const double delay = run.layer.diameter * bed().filler(r).volumetric(kelvin) /
                           (6 * bed().closure(r).at(kelvin, MassFlux(flux)).film);
      spread += double(run.count) / double(bed().fluid().size()) * delay * seen_->flow / crossing_mass();
    }
    report.sentences.push_back(fmt::format(
        "closures: Reynolds number of the layers at the largest flow, from the bottom up: {}", layers));
    if (!is_outside || view_.parameters().bed.closures.film_coefficient > 0) return;
    const double share = std::sqrt(spread);
    add(report,
        {.effect = "range of the film correlation",
         .number = share,
         .what = fmt::format(
             "the Reynolds numbers of the layers are {}, but the correlation was fitted from 15 to 8500",
             layers),
         .advice = "give 'bed.closures.film-coefficient'",
         .share = share});
  }

 private:
  /// Film times d/(2 conductivity) of grain layers at the largest flow and the bed's mean temperature; and its share of the result.
  std::pair<double, double> largest_biot() const {
    double mean = 0, largest = 0, third = 0, variance = 0;
    for (const double t : bed().fluid()) mean += t / double(bed().fluid().size());
    // The share is largest half way through the bed.
    const double passage = std::min(0.5 * crossing_mass(), seen_->moved) / seen_->flow;
    for (std::size_t r = 0; r < bed().grid().runs.size(); ++r) {
      const BedGrid::Run& run = bed().grid().runs[r];
      if (run.layer.porosity >= 1 || run.layer.melting) continue;
      const double conductivity = value_of(bed().filler(r).conductivity, mean), d = run.layer.diameter,
                   film = bed().closure(r).at(mean, MassFlux(seen_->flow / bed().area())).film;
      const double biot = film * d / (2 * conductivity), weight = run.count / double(bed().fluid().size());
      const double inside = d * d * bed().filler(r).volumetric(mean) / (60 * conductivity) / passage;
      largest = std::max(largest, biot);
      third += weight * inside * inside;
      variance += 2 * weight * inside * (1 + 5 / biot);
    }
    const double share = variance > 0 ? 0.39 * third * std::pow(variance, -1.25) : 0;
    return {largest, share / (1 + share)};
  }
};

/// Conduction through the grains and radiation between them, where the bed leaves them out.
class StillBed final : public TankDiagnostic {
 public:
  using TankDiagnostic::TankDiagnostic;
  // At the end, because a front stays as long as the flow of the whole run leaves it in the bed.
  void conclude(diagnostics::Report& report) override {
    const auto [cold, hot] = range_to_come();
    const Conduction kind = view_.parameters().bed.closures.conduction;
    if (hot <= cold + 1 || kind == Conduction::constant) return;
    const double mean = 0.5 * (cold + hot);
    const auto still = [&, this](std::size_t r, double emissivity) {
      const BedLayer& layer = bed().grid().runs[r].layer;
      Filler filler = bed().filler(r);
      filler.emissivity = emissivity;
      return stagnant_conductivity(view_.fluid(), filler, layer.porosity, layer.diameter, mean);
    };
    if (kind == Conduction::wakao)
      check(report, "conduction through the grains", mean,
            "set 'bed.closures.conduction: stagnant', the default", [&, this](std::size_t r) {
              return still(r, 0) - bed().closure(r).at(mean, MassFlux(0)).conductivity;
            });
    if (view_.fluid().is_transparent())
      check(report, "radiation between the grains", mean,
            "give 'filler.emissivity', with 'bed.closures.conduction: stagnant', the default",
            [&, this](std::size_t r) {
              const double own = bed().filler(r).emissivity;
              if (kind == Conduction::stagnant && own > 0) return 0.;
              return still(r, own > 0 ? own : Filler().emissivity) - still(r, 0);
            });
  }

 private:
  /// A front has the variance a^2 by conduction, 2 k t/C in the time t that it stays in the bed, and by film and grains; with the
  /// conductivity that layers lack (`left_out`) it has b^2. Two steps smeared that much differ by the integral
  ///   sqrt(2/pi) (sqrt(a^2 + b^2) - (a + b)/sqrt(2))
  /// of the squares, where that of a step from its mean is a quarter of the height. A bed that has not seen its range has less of a front.
  void check(diagnostics::Report& report, const char* effect, double mean, const char* advice,
             const std::function<double(std::size_t)>& left_out) const {
    const double time = view_.time(), stay = time * std::min(1., crossing_mass() / seen_->moved);
    const MassFlux flux(seen_->moved / (time * bed().area()));
    double diffusivity = 0, lacking = 0, largest = 0;
    for (std::size_t r = 0; r < bed().grid().runs.size(); ++r) {
      const BedGrid::Run& run = bed().grid().runs[r];
      const double solid = 1 - run.layer.porosity, lacks = left_out(r),
                   capacity = run.layer.porosity * view_.fluid().volumetric() +
                              solid * bed().filler(r).volumetric(mean),
                   weight = run.count / (capacity * double(bed().fluid().size()));
      diffusivity += weight * bed().closure(r).at(mean, flux).conductivity;
      lacking += weight * lacks;
      largest = std::max(largest, lacks);
    }
    if (!(largest > 0)) return;
    const double height = bed().grid().height,
                 spread =
                     variance_of_grains() * height * height * std::min(1., seen_->moved / crossing_mass()),
                 before = std::sqrt(spread + 2 * diffusivity * stay),
                 after = std::sqrt(spread + 2 * (diffusivity + lacking) * stay);
    const double squares = std::sqrt(2 / std::numbers::pi) *
                           (std::hypot(before, after) - (before + after) / std::numbers::sqrt2);
    const auto [cold, hot] = range_to_come();
    const double share = std::min(1., 2 * std::sqrt(std::max(0., squares) / height)) *
                         (seen_->hottest - seen_->coldest) / (hot - cold);
    add(report,
        {.effect = effect,
         .number = share,
         .what = fmt::format("it contributes up to {:.2g} W/(m K) at {:.0f} degC", largest, celsius(mean)),
         .advice = advice,
         .share = share});
  }
};

/// Detects cold fluid above hot fluid, which sinks (docs/thermocline.md, inversions). The effect depends on
/// flow and grains, so there is no error estimate.
class Inversions final : public TankDiagnostic {
 public:
  using TankDiagnostic::TankDiagnostic;
  void observe(diagnostics::Report&) override {
    if (view_.happened.inversion.depth > worst_.depth) worst_ = view_.happened.inversion;
  }
  void look(diagnostics::Report& report) override {
    const auto [cold, hot] = range_to_come();
    if (view_.parameters().bed.mix_inversions || worst_.depth <= 0.01 || hot <= cold + 1) return;
    const double share = worst_.depth / (hot - cold);
    add(report,
        {.effect = "mixing of inverted fluid",
         .number = share,
         .what = fmt::format(
             "fluid {:.3g} K colder than the fluid below it at t = {:.6g} s, z = {:.3f} m: {:.2g} of the temperature range of "
             "the run",
             worst_.depth, worst_.time, worst_.z, share),
         .advice = "it would sink: set 'bed.mix-inversions: true', or check the signs of the mass flows "
                   "(upward above 0) and the inlet temperatures",
         .share = share});
  }
  void visit(io::Archive& archive) override { archive.common("worst", worst_.depth, worst_.z, worst_.time); }

 private:
  Inversion worst_;
};

/// Power of a neglected pump or fan at the largest flow, over the heat flow between the coldest and hottest
/// fluid: Ergun at the mean of both temperatures, layer by layer.
class Pumping final : public TankDiagnostic {
 public:
  using TankDiagnostic::TankDiagnostic;
  void look(diagnostics::Report& report) override {
    const auto [cold, hot] = range_to_come();
    if (!(seen_->flow > 0) || hot <= cold + 1) return;
    const Medium& f = view_.fluid();
    const double mean = 0.5 * (cold + hot);
    const double density = f.is_gas() ? f.pressure / (f.gas_constant * mean) : f.density;
    double loss = 0;
    for (const auto& run : bed().grid().runs)
      if (run.layer.porosity < 1)
        loss += run.layer.height * ergun(run.layer, f.viscosity(mean), seen_->flow / bed().area()) / density;
    const double share = loss / (density * f.specific_heat * (hot - cold));
    add(report,
        {.effect = "pressure loss of the bed",
         .number = share,
         .what =
             fmt::format("pressure loss of {:.3g} kPa at the largest flow: {:.2g} of the transported heat",
                         1e-3 * loss, share),
         .advice = "add 'pump: {}', or check flow and grains: no real store has such a large pressure loss",
         .share = share});
  }
};

/// Checks an ideal gas of constant specific heat: its Mach number, and the mean of the true specific heat.
class IdealGas final : public TankDiagnostic {
 public:
  using TankDiagnostic::TankDiagnostic;
  void look(diagnostics::Report& report) override {
    if (seen_->flow > 0) check_speed(report);
    const auto [cold, hot] = range_to_come();
    if (hot <= cold + 1) return;
    const double mean = air_heat_between(cold, hot) / (hot - cold),
                 error = std::abs(mean / view_.fluid().specific_heat - 1);
    add(report,
        {.effect = "specific heat of a gas by its temperature",
         .number = error,
         .what = fmt::format(
             "from the coldest to the hottest fluid of the run, air has {:.0f} J/(kg K), a relative difference of {:.2g} from "
             "the constant",
             mean, error),
         .advice = fmt::format("set 'fluid.specific-heat: {:.0f} J/(kg K)'", mean),
         .share = std::min(error, 1.)});  // of another gas
  }

 private:
  /// Mach number at the hottest gas and narrowest pores, at the outlet pressure.
  void check_speed(diagnostics::Report& report) const {
    const Medium& f = view_.fluid();
    double narrowest = 1;
    for (const auto& run : bed().grid().runs) narrowest = std::min(narrowest, run.layer.porosity);
    const double rt = f.gas_constant * seen_->hottest,
                 speed = seen_->flow / bed().area() * rt / (f.pressure * narrowest);
    const double mach = speed / std::sqrt(f.specific_heat / (f.specific_heat - f.gas_constant) * rt);
    add(report,
        {.effect = "compressible flow of a gas",
         .id = "compressibility",
         .number = mach,
         .what =
             fmt::format("gas speed between the grains / speed of sound = {:.2g} at the largest flow", mach),
         .advice =
             "the flow is compressible, so that neither the pressure loss nor the film coefficients are valid: use less flow, "
             "a wider bed or a higher pressure",
         .share = 0.5 * mach * mach});
  }
};

}  // namespace

diagnostics::Made grains(const RunOfTank& run) { return std::make_shared<ResolvedGrains>(run); }

diagnostics::Made still_bed(const RunOfTank& run) { return std::make_shared<StillBed>(run); }

diagnostics::Made inversions(const RunOfTank& run) { return std::make_shared<Inversions>(run); }

diagnostics::Made pumping(const RunOfTank& run) {
  return run.view.parameters().pump ? nullptr : std::make_shared<Pumping>(run);
}

diagnostics::Made gas(const RunOfTank& run) {
  return run.view.fluid().is_gas() ? std::make_shared<IdealGas>(run) : nullptr;
}

}  // namespace couplet::thermocline
