// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <yaml-cpp/yaml.h>
#include <filesystem>
#include <string>
#include <string_view>

#include "common/config/section.hpp"

namespace couplet::config {

/// Writes the node's value to the member, in the key's unit and range. Throws Error with a sentence without
/// place. Files of tables are relative to `folder`.
void read_value(const YAML::Node& node, const Key::Facts& facts, const Slot& slot,
                const std::filesystem::path& folder = {});

/// "above 0 Pa", "from 0 to 0.5", "at most 3"; empty without limits.
std::string describe_range(const Key::Facts& facts);

/// "unknown key. Did you mean ...?", or where a key stands that this program has in another way.
std::string unknown_key(std::string_view name, const std::vector<std::string>& known);

/// "number", "list of texts", "one word": what a value of this slot looks like.
std::string describe_type(const Slot& slot);

/// The value in the member now, as it would stand in the YAML, with its unit where it needs one; empty optional: "".
std::string format_value(const Slot& slot, std::string_view unit);

/// Pairs of keys each of which is plausible alone; for Section::doubt. Empty: nothing to say.

/// sqrt(modulus/density): 1 m/s (gels) to 20 km/s (diamond).
std::string doubt_of_wave_speed(double modulus, double density);
/// viscosity/density: hardly any fluid has less than 5e-8 m^2/s (mercury: 1e-7, water: 1e-6).
std::string doubt_of_kinematic_viscosity(double viscosity, double density);

}  // namespace couplet::config
