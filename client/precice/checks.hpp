// SPDX-License-Identifier: Apache-2.0
// Checks of calls, with their messages.
#pragma once

#include <string>

#include "session.hpp"

namespace couplet::dropin {

/// Throws precice::Error. The participant remembers the text in case the program ends without printing it.
[[noreturn]] void fail(const Session& s, const std::string& why);
/// Checks a condition. Composed texts would cost time in valid calls, so they use fail().
template <std::size_t n>
void check(const Session& s, bool right, const char (&why)[n]) {
  if (!right) fail(s, why);
}

/// Formats a number for a message.
std::string text(double value);
/// Finds a mesh that the participant provides or receives.
const Configuration::Mesh& known_mesh(const Session& s, ::precice::string_view name);
/// Finds a provided mesh that may still grow. `call` is the function that needs it.
Mesh& open_mesh(Session& s, ::precice::string_view name, const char* call);
/// Finds a datum that the participant writes or reads on a mesh that it provides.
const Configuration::Data& used_data(const Session& s, ::precice::string_view mesh,
                                     ::precice::string_view data, bool written);
std::string unknown_data(const Session& s, const std::string& mesh, const std::string& data);
/// Checks that vertices exist and that the number of values is that of vertices times components.
void check_values(const Session& s, const char* call, const Configuration::Data& d,
                  ::precice::span<const ::precice::VertexID> ids, std::size_t values);
/// Checks that the vertices of a face or cell exist and are distinct.
void check_corners(const Session& s, const char* call, const Mesh& mesh,
                   ::precice::span<const ::precice::VertexID> ids);

}  // namespace couplet::dropin
