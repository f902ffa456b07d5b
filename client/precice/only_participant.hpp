// SPDX-License-Identifier: Apache-2.0
// Single participant of a process, for languages without classes.
#pragma once

#include <utility>

#include "session.hpp"

namespace couplet::dropin {

/// Throws precice::Error before the participant is created.
::precice::Participant& only_participant();
void create_only_participant(::precice::string_view name, ::precice::string_view file, int rank, int size,
                             void* communicator);
/// Reports an error to a caller without exceptions: ends the job, unless errors are kept.
void told(const std::string& error);

/// Calls a function and converts an exception to its text.
template <class Call>
auto guarded(Call call) -> decltype(call()) {
  told("");
  try {
    return call();
  } catch (const std::exception& error) {
    told(error.what());
    return decltype(call())();
  }
}

/// Calls the participant. Does nothing if an error is kept.
template <class Call>
auto with_participant(Call call) {
  return guarded([&] { return call(only_participant()); });
}

}  // namespace couplet::dropin
