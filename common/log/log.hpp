// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <spdlog/spdlog.h>

#include <string>

namespace couplet::log {

enum class Verbosity { quiet, normal, verbose };

/// Prefix "[fluid 0]". Below verbose only rank 0 speaks (warnings and errors: every rank); all go to stdout,
/// errors to stderr. `file`: also write there (rank 0), empty for none.
void setup(const std::string& participant, int rank, Verbosity verbosity, const std::string& file = "");

using spdlog::debug;
using spdlog::error;
using spdlog::info;
using spdlog::warn;

}  // namespace couplet::log
