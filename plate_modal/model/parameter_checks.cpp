// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "plate_modal/model/parameters.hpp"

namespace couplet::plate {

/// What describes a plate says nothing about the modes of a file, which have their own surface, place and mass.
void check_file_alone(config::Section& s, const Parameters& p) {
  const auto of_no_use = [&](const char* key, const char* why, auto&& is_given) {
    s.check(
        [&p, why, is_given] {
          return p.modes_file && !p.mesh && is_given()
                     ? fmt::format("it has no effect with 'modes.file': {}", why)
                     : "";
        },
        key);
  };
  const char* inside = "the modes include it already";
  of_no_use("mesh-parameters", "there is no .geo", [&p] { return !p.mesh_parameters.empty(); });
  of_no_use("mesh-scale", "the file is in metres", [&p] { return p.mesh_scale != 1; });
  of_no_use("material", inside, [&p] {
    const Material m;
    return p.material.density != m.density || p.material.youngs_modulus != m.youngs_modulus ||
           p.material.poissons_ratio != m.poissons_ratio;
  });
  of_no_use("thickness", inside, [&p] { return p.thickness > 0; });
  of_no_use("zones", inside, [&p] { return !p.zones.empty(); });
  of_no_use("boundaries", inside, [&p] { return !p.boundaries.empty(); });
  of_no_use("placement", "the file defines the position of the surface", [&p] {
    const Placement here;
    return p.placement.origin != here.origin || p.placement.x != here.x || p.placement.y != here.y;
  });
  of_no_use("wetted", "the interface is the surface of the file", [&p] { return p.wetted != Wetted::both; });
}

void check_together(config::Section& s, Parameters& p) {
  using Analysis = Parameters::Analysis;
  s.check(
      [&] {
        return p.mesh.has_value() == p.modes_file.has_value()
                   ? "give either 'mesh' (of the mid-surface) or 'modes.file' (modes of another program)"
                   : "";
      },
      "mesh");
  const auto needed = [&](const char* key, auto&& is_missing) {
    s.check(
        [&p, key, is_missing] {
          return p.mesh && is_missing() ? fmt::format("a plate needs '{}' above 0", key) : "";
        },
        p.mesh ? "mesh" : "modes");
  };
  needed("thickness", [&p] { return !(p.thickness > 0); });
  needed("material.density", [&p] { return !(p.material.density > 0); });
  needed("material.youngs-modulus", [&p] { return !(p.material.youngs_modulus > 0); });
  s.check(
      [&] {
        return p.contact && p.analysis != Analysis::dynamic ? "contact requires a dynamic analysis; remove it"
                                                            : "";
      },
      "contact");
  s.check(
      [&] {
        return p.contact && p.modes_file && !p.contact->stiffness
                   ? "with 'modes.file' the material is unknown: give 'stiffness'"
                   : "";
      },
      "contact");
  s.check(
      [&] {
        return p.contact && p.contact->rule == ContactRule::conserving &&
                       p.time_scheme.type != time::TimeScheme::trapezoidal
                   ? "'rule: conserving' requires the trapezoidal time scheme; use 'rule: midpoint'"
                   : "";
      },
      "contact");
  s.check(
      [&] {
        return p.damping && p.analysis != Analysis::dynamic
                   ? "damping has no effect in this analysis; remove it"
                   : "";
      },
      "damping");
  s.check(
      [&] {
        return p.mesh && std::ssize(p.initial_amplitudes) > p.n_modes()
                   ? fmt::format("{} amplitudes are given, but there are {} modes",
                                 p.initial_amplitudes.size(), p.n_modes())
                   : "";
      },
      "initial-amplitudes");
}

}  // namespace couplet::plate
