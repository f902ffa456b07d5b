// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "common/config/load.hpp"

namespace couplet::config {

/// Every single value of the document with the overrides of --set, under its dotted path: "participants.solid.mesh",
/// "participants.solid.boundaries.top.value[0]". Empty mappings and lists stand as "{}" and "[]".
std::map<std::string, std::string> leaves(const Document& document);

/// Whether two texts of a value say the same: "20 ms" and "0.02 s" do, and so does "0.02", which is in SI.
bool same_value(const std::string& a, const std::string& b);

}  // namespace couplet::config
