// SPDX-License-Identifier: Apache-2.0
// The one participant of a process, for the languages without classes.
#pragma once

#include <utility>

#include "session.hpp"

namespace couplet::dropin {

/// Throws precice::Error before it is created.
::precice::Participant& only_participant();
void create_only_participant(::precice::string_view name, ::precice::string_view file, int rank, int size,
                             void* communicator);
/// What a caller without exceptions gets: the end of the job, unless errors are kept.
void told(const std::string& error);

/// Calls, and turns an error into its text.
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

/// A call of the participant; nothing if an error is kept.
template <class Call>
auto with_participant(Call call) {
  return guarded([&] { return call(only_participant()); });
}

}  // namespace couplet::dropin
