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
#include "solid_solver/thermal/heat.hpp"

namespace couplet::solid {

/// Thermal interface of a solid that conducts heat: takes "heat", the mean over the step [W], and gives a film,
/// "film-coefficient" [W/(m^2 K)] and "ambient-temperature" [K] at t^{n+1}.
class HeatInterface final {
 public:
  /// `map`: of the thermal interface patches. Both must outlive this.
  HeatInterface(Heat& heat, const coupling::InterfaceMap& map);
  static void describe(coupling::Interface& description);
  /// Without values yet, no heat passes. Collective.
  void take(const coupling::Exchange& in) const;
  /// Collective.
  void add_film(coupling::Exchange& out) const;

 private:
  Heat& heat_;
  const coupling::InterfaceMap& map_;
};

/// Coupling interface of a solid: the data it takes and gives at its interface patches.
class SolidInterface final {
 public:
  /// Throws Error if a temperature is requested without an interface. Collective.
  explicit SolidInterface(const SolidBody& body);

  const coupling::Interface& description() const { return description_; }
  /// True if a temperature or heat arrives with the load, so that thermal loads cannot be prepared earlier.
  bool is_heated() const { return takes_temperature_ || heat_; }
  /// Passes the given temperature or heat on. Collective.
  void take_heating(const coupling::Exchange& in) const;
  /// Sum of the given forces, `dim` values per boundary face of owned cells; empty without an interface.
  std::vector<double> load(const coupling::Exchange& in) const;
  /// Displacement and velocity at the vertices, film at the faces, after a solve. Collective.
  coupling::Exchange values(const SolidState& state) const;

 private:
  const SolidBody& body_;
  std::unique_ptr<coupling::InterfaceMap> map_;  // nullptr if there is no interface patch
  coupling::Interface description_;
  bool is_loaded_ = false, takes_temperature_ = false;
  std::optional<HeatInterface> heat_;
};

}  // namespace couplet::solid
