// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/parameters/viscosity_law.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace couplet::fluid {

constexpr double infinity = std::numeric_limits<double>::infinity();

double ViscosityLaw::operator()(double rate) const {
  switch (type) {
    case Type::power_law:
      return std::clamp(consistency * std::pow(rate, index - 1), least, most.value_or(infinity));
    case Type::carreau_yasuda:
      return infinite_shear + (zero_shear - infinite_shear) *
                                  std::pow(1 + std::pow(time * rate, yasuda), (index - 1) / yasuda);
    case Type::cross:
      return infinite_shear + (zero_shear - infinite_shear) / (1 + std::pow(time * rate, 1 - index));
    default:
      break;
  }
  const double bounded = index < 1 ? std::max(rate, 1 / regularization) : rate;
  const double yields = rate > 0 ? -std::expm1(-regularization * rate) / rate : regularization;
  return consistency * std::pow(bounded, index - 1) + yield_stress * yields;
}

fv::Property ViscosityLaw::factor() const {
  return by_temperature ? fv::Property(*by_temperature, "viscosity.by-temperature") : fv::Property(1);
}

std::pair<double, double> ViscosityLaw::factors() const {
  const fv::Property all = factor();
  if (all.is_constant()) return {all(0), all(0)};
  const auto [least, greatest] = std::ranges::minmax(all.table()->values());
  return {least, greatest};
}

double ViscosityLaw::smallest_by_shear() const {
  switch (type) {
    case Type::power_law:
      return index == 1 ? (*this)(0) : least;
    case Type::carreau_yasuda:
      return index == 1 ? zero_shear : infinite_shear;
    case Type::cross:
      return infinite_shear;
    default:
      return index == 1 ? consistency : 0;
  }
}

double ViscosityLaw::largest_by_shear() const {
  switch (type) {
    case Type::power_law:
      return index == 1 ? (*this)(0) : most.value_or(infinity);
    case Type::carreau_yasuda:
    case Type::cross:
      return zero_shear;
    default:
      return index > 1 ? infinity : (*this)(0);
  }
}

namespace {

/// Declares an index with the values that a law is defined for.
void declare_index(config::Section& s, ViscosityLaw& law, double lowest, double highest, bool required) {
  config::Key key = s.value("index", law.index);
  key.range(lowest, highest)
      .doc(
          "n: the stress grows as the shear rate to the power n; below 1 the fluid is shear-thinning, above 1 shear-thickening");
  if (required) key.required();
}

void declare_consistency(config::Section& s, ViscosityLaw& law) {
  s.value("consistency", law.consistency)
      .positive()
      .required()
      .doc("K [Pa s^n], the viscosity at a shear rate of 1/s without a yield stress");
}

void declare_power_law(config::Section& s, ViscosityLaw& law) {
  declare_consistency(s, law);
  declare_index(s, law, 0.1, 2, true);
  s.value("least", law.least)
      .unit("Pa s", 1e-6, 1e6)
      .not_negative()
      .doc(
          "smallest viscosity, at high shear rates of a shear-thinning fluid and low ones of a shear-thickening one");
  s.value("most", law.most)
      .unit("Pa s", 1e-6, 1e9)
      .positive()
      .doc("largest viscosity; needed below an index of 1, where the power law has no limit at rest");
  s.check(
      [&law] {
        return law.index < 1 && !law.most
                   ? "a power law with an index below 1 has an infinite viscosity at rest; give 'most', the largest one"
                   : "";
      },
      "index");
  s.check([&law] { return law.most && *law.most <= law.least ? "it must be above 'least'" : ""; }, "most");
}

/// Declares the viscosities at rest and at high shear rates, and the time between them.
void declare_plateaus(config::Section& s, ViscosityLaw& law) {
  s.value("zero-shear", law.zero_shear)
      .unit("Pa s", 1e-6, 1e6)
      .positive()
      .required()
      .doc("viscosity at rest, the largest one");
  s.value("infinite-shear", law.infinite_shear)
      .unit("Pa s", 1e-6, 1e6)
      .not_negative()
      .required()
      .doc("viscosity at high shear rates, the smallest one");
  s.value("time", law.time)
      .unit("s", 1e-9, 1e6)
      .positive()
      .required()
      .doc("T: the viscosity falls from shear rates of about 1/T");
  s.check([&law] { return law.infinite_shear <= law.zero_shear ? "" : "it must not exceed 'zero-shear'"; },
          "infinite-shear");
}

void declare_carreau_yasuda(config::Section& s, ViscosityLaw& law) {
  declare_plateaus(s, law);
  declare_index(s, law, 0, 1, true);
  s.value("yasuda", law.yasuda)
      .range(0.1, 20)
      .doc("a: how sharply the viscosity begins to fall; 2 is the law of Carreau");
}

void declare_cross(config::Section& s, ViscosityLaw& law) {
  declare_plateaus(s, law);
  declare_index(s, law, 0, 0.95, true);
}

void declare_herschel_bulkley(config::Section& s, ViscosityLaw& law) {
  s.value("yield-stress", law.yield_stress)
      .unit("Pa", 1e-6, 1e9)
      .not_negative()
      .required()
      .doc("tau_0: shear stress below which the fluid hardly flows");
  declare_consistency(s, law);
  declare_index(s, law, 0.1, 2, false);
  s.value("regularization", law.regularization)
      .unit("s", 1e-9, 1e9)
      .positive()
      .required()
      .doc(
          "m: the yield stress is tau_0 (1 - exp(-m q)) at the shear rate q, so that the viscosity at rest is tau_0 m (and "
          "K m^(1-n) below an index of 1) instead of infinite; some 1000 over the shear rate at the walls. A larger one is "
          "closer to a plastic fluid and costs more steps");
}

}  // namespace

void declare(config::Section& s, ViscosityLaw& law) {
  using Type = ViscosityLaw::Type;
  const auto keys_of = [&law](void (*declare)(config::Section&, ViscosityLaw&)) {
    return [&law, declare](config::Section& v) { declare(v, law); };
  };
  s.variant("law", law.type,
            {{"power-law", Type::power_law, keys_of(declare_power_law)},
             {"carreau-yasuda", Type::carreau_yasuda, keys_of(declare_carreau_yasuda)},
             {"cross", Type::cross, keys_of(declare_cross)},
             {"herschel-bulkley", Type::herschel_bulkley, keys_of(declare_herschel_bulkley)}},
            "dependence of the viscosity on the shear rate, see docs/theory/fluid-models.md", true);
  {
    config::Key key = s.value("by-temperature", law.by_temperature);
    key.positive().doc("with `heat`: factor of the viscosity, a number or a table of T");
  }
  s.check(
      [&law] { return law.by_temperature ? fv::problem_of_property(*law.by_temperature) : std::string(); },
      "by-temperature");
}

}  // namespace couplet::fluid
