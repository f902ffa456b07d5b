// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "common/coupling/interface_map.hpp"
#include "common/coupling/participant.hpp"
#include "solid_solver/body/solid_body.hpp"
#include "solid_solver/body/solid_state.hpp"
#include "solid_solver/parameters/interface_data.hpp"

namespace couplet::solid {

/// Coupling interface of a solid: the data it takes and gives at its interface patches.
class SolidInterface final {
 public:
  /// Throws Error if a temperature is requested without an interface. Collective.
  explicit SolidInterface(const SolidBody& body);

  const coupling::Interface& description() const { return description_; }
  /// True if a temperature arrives with the load, so that thermal loads cannot be prepared earlier.
  bool takes_temperature() const { return takes_temperature_; }
  /// Passes the given temperature on. Collective.
  void take_temperature(const coupling::Exchange& in) const;
  /// Sum of the given forces, `dim` values per boundary face of owned cells; empty without an interface.
  std::vector<double> load(const coupling::Exchange& in) const;
  /// Displacement and velocity at the vertices. Collective.
  coupling::Exchange values(const SolidState& state) const;

 private:
  const SolidBody& body_;
  std::unique_ptr<coupling::InterfaceMap> map_;  // nullptr if there is no interface patch
  coupling::Interface description_;
  bool takes_temperature_ = false;
};

}  // namespace couplet::solid
