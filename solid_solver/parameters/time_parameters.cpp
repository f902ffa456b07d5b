// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/parameters/time_parameters.hpp"

#include <algorithm>

#include "solid_solver/parameters/parameters.hpp"

namespace couplet::solid {
namespace {

/// Forces of a partner on some patch or part of one.
bool is_loaded_by_partner(const SolidParameters& p) {
  if (p.interface_data && p.interface_data->temperature) return false;
  return std::ranges::any_of(p.boundaries, [](const auto& entry) {
    return is_interface(entry.second) || std::ranges::any_of(entry.second.parts, is_interface);
  });
}

}  // namespace

void declare(config::Section& s, SolidDamping& d) {
  s.value("mass", d.mass)
      .unit("1/s")
      .plausible(1e-9, 1e9)
      .not_negative()
      .doc("Rayleigh coefficient of the mass matrix");
  s.value("stiffness", d.stiffness)
      .unit("s")
      .plausible(1e-15, 1e4)
      .not_negative()
      .doc("Rayleigh coefficient of the stiffness matrix");
}

void declare(config::Section& s, TimeStepControl& c) {
  s.value("tolerance", c.tolerance)
      .unit("m")
      .plausible(1e-15, 1)
      .positive()
      .required()
      .doc("target accuracy of the displacement, rms over the volume; one step may contribute a tenth of it");
}

time::TimeSchemeParameters scheme_of(const SolidParameters& p) {
  time::TimeSchemeParameters scheme = p.time_scheme;
  if (scheme.type != time::TimeScheme::automatic) return scheme;
  const bool keeps_contact = p.contact && p.contact->rule == contact::ContactRule::conserving;
  const bool damps = has_finite_strain(p) && !is_updated_lagrangian(p) && !p.energy_momentum &&
                     !keeps_contact && is_loaded_by_partner(p);
  scheme.type = damps ? time::TimeScheme::generalised_alpha : time::TimeScheme::trapezoidal;
  return scheme;
}

}  // namespace couplet::solid
