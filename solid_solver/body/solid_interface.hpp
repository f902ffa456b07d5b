// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "common/coupling/interface_map.hpp"
#include "common/coupling/participant.hpp"
#include "solid_solver/body/solid_body.hpp"
#include "solid_solver/body/solid_state.hpp"
#include "solid_solver/parameters/interface_data.hpp"

namespace couplet::solid {

/// What a solid takes through its interface patches and gives there.
class SolidInterface final {
 public:
  /// Throws Error if a temperature or a surface density is wanted where there is no interface. Collective.
  explicit SolidInterface(const SolidBody& body);

  const coupling::Interface& description() const { return description_; }
  /// A temperature comes with the load, so that the loads it makes cannot be prepared before.
  bool takes_temperature() const { return takes_temperature_; }
  /// Hands on the temperature that was given. Collective.
  void take_temperature(const coupling::Exchange& in) const;
  /// Sum of the given forces, `dim` values a boundary face of owned cells; empty without interface.
  std::vector<double> load(const coupling::Exchange& in) const;
  /// Displacement and velocity at the vertices, and what answers within a step `dt` if it was asked for. Collective.
  coupling::Exchange values(const SolidState& state, double dt) const;

 private:
  const SolidBody& body_;
  std::unique_ptr<coupling::InterfaceMap> map_;  // none: no interface patch
  coupling::Interface description_;
  std::optional<WallImpedance> impedance_;  // none: not given
  bool takes_temperature_ = false;
};

}  // namespace couplet::solid
