// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/parameters/material_parameters.hpp"

#include <fmt/format.h>

#include "common/base/text.hpp"
#include "common/config/values.hpp"
#include "solid_solver/laws/laws.hpp"

namespace couplet::solid {
namespace {

void declare_law(config::Section& s, SolidMaterial& m) {
  std::string doc =
      "material law at finite strain, with Young's modulus and Poisson's ratio as its "
      "small-strain values: " +
      base::join(laws::names());
  s.value("law", m.law).doc(doc);
  s.check(
      [&m]() -> std::string {
        if (m.law.empty() || laws::find(m.law)) return "";
        return fmt::format("unknown law '{}'. {} The laws are {}", m.law,
                           base::did_you_mean(m.law, laws::names(), "laws"), base::join(laws::names()));
      },
      "law");
  std::string wanted;
  for (const laws::Entry& e : laws::all())
    if (e.n_coefficients > 0)
      wanted += fmt::format("{}{}: {}", wanted.empty() ? "" : "; ", e.name, e.coefficients);
  s.value("law-coefficients", m.law_coefficients).doc("additional parameters of the law; " + wanted);
  s.check(
      [&m]() -> std::string {
        const laws::Entry* law = laws::of(m.law);
        if (!law || m.law_coefficients.size() <= law->n_coefficients) return "";
        return law->n_coefficients == 0
                   ? fmt::format("the law '{}' has no parameters", law->name)
                   : fmt::format("{} numbers are given, but the law '{}' takes at most {}: {}",
                                 m.law_coefficients.size(), law->name, law->n_coefficients,
                                 law->coefficients);
      },
      "law-coefficients");
}

}  // namespace

void declare(config::Section& s, SolidMaterial& m, bool is_elastic) {
  s.value("density", m.density).unit("kg/m^3").plausible(1, 25000).positive().required().doc("density");
  if (is_elastic)
    s.optional_section<Orthotropic>(
        "orthotropic", m.orthotropic, [](config::Section& o, Orthotropic& v) { declare(o, v); },
        "elastic constants of a material with three planes of symmetry (wood, plies), instead of "
        "youngs-modulus and poissons-ratio");
  const auto needed = [&](config::Key& key) -> config::Key& {
    return is_elastic && !m.orthotropic ? key.required() : key;
  };
  needed(s.value("youngs-modulus", m.youngs_modulus)
             .unit("Pa")
             .plausible(1, 2e12)
             .positive()
             .doc("Young's modulus; needed without 'orthotropic'"));
  needed(
      s.value("poissons-ratio", m.poissons_ratio)
          .range(-0.99, 0.49999)
          .doc("Poisson's ratio, needed without 'orthotropic'; from 0.4 the symmetric face gradient is the "
               "default"));
  s.check(
      [&m] {
        return m.orthotropic && (m.youngs_modulus != 0 || m.poissons_ratio != 0)
                   ? "give either 'orthotropic' or 'youngs-modulus' and 'poissons-ratio'"
                   : "";
      },
      "orthotropic");
  s.doubt([&m] { return config::doubt_of_wave_speed(m.youngs_modulus, m.density); }, "density");
  s.value("yield-strength", m.yield_strength)
      .unit("Pa")
      .plausible(1000, 1e11)
      .positive()
      .doc("the run reports where the equivalent stress reaches it; no other effect");
  if (is_elastic) declare_law(s, m);
  declare(s, m.heat);
}

void declare(config::Section& s, ZoneMaterial& m, bool is_elastic) {
  s.value("zones", m.zones)
      .doc(
          "physical volumes (2-D: surfaces) of the mesh made of this material; absent: the one with this "
          "name");
  declare(s, static_cast<SolidMaterial&>(m), is_elastic);
}

std::vector<std::vector<std::string>> zones_of(const ZoneMaterials& materials) {
  std::vector<std::vector<std::string>> zones;
  for (const auto& [name, material] : materials)
    zones.push_back(material.zones.empty() ? std::vector<std::string>{name} : material.zones);
  return zones;
}

}  // namespace couplet::solid
