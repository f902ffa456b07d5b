// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <spdlog/spdlog.h>

#include <string>

namespace couplet::log {

enum class Verbosity { quiet, normal, verbose };

/// Sets up the log with prefix "[fluid 0]". Below verbose only rank 0 prints, but every rank prints errors: a
/// warning speaks for all. Lines go to stdout, errors to stderr. Rank 0 also writes to `file` unless it is "".
void setup(const std::string& participant, int rank, Verbosity verbosity, const std::string& file = "");

using spdlog::debug;
using spdlog::error;
using spdlog::info;
using spdlog::warn;

}  // namespace couplet::log
