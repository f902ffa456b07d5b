// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace couplet::log {

/// A result that is not to be trusted: a warning that is counted, so that a run with --strict can fail by it.
/// Called on every rank; rank 0 speaks.
void doubt(int rank, const std::string& text);
/// How many so far.
int doubts();

}  // namespace couplet::log
