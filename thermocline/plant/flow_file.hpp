// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "thermocline/plant/flow.hpp"

namespace couplet::thermocline {

/// Rows of a schedule from a CSV (may be compressed): '#' begins a comment, the first line names the columns with their
/// units, in any order: "time [h],mass-flow [kg/s],inlet-temperature [degC]" and, where wanted, "stop-above [degC]",
/// "stop-below [degC]", which may be empty in a row. A row holds until the next one. Throws Error with file:line.
std::vector<ScheduleRow> read_flow_file(const std::filesystem::path& file);

}  // namespace couplet::thermocline
