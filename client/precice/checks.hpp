// SPDX-License-Identifier: Apache-2.0
// What calls are checked for, and in which words.
#pragma once

#include <string>

#include "session.hpp"

namespace couplet::dropin {

/// Throws precice::Error; the participant remembers it, should the program go down with it in silence.
[[noreturn]] void fail(const Session& s, const std::string& why);
/// Texts that must be put together are not worth it in a call that is right: they take fail().
template <std::size_t n>
void check(const Session& s, bool right, const char (&why)[n]) {
  if (!right) fail(s, why);
}

/// A number as it stands in a sentence.
std::string text(double value);
/// A mesh that the participant provides or receives.
const Configuration::Mesh& known_mesh(const Session& s, ::precice::string_view name);
/// A mesh that it provides, which may still grow. `call`: what needs it.
Mesh& open_mesh(Session& s, ::precice::string_view name, const char* call);
/// A datum that it writes or reads on a mesh that it provides.
const Configuration::Data& used_data(const Session& s, ::precice::string_view mesh,
                                     ::precice::string_view data, bool written);
std::string unknown_data(const Session& s, const std::string& mesh, const std::string& data);
/// As many values as vertices and components, and vertices that there are.
void check_values(const Session& s, const char* call, const Configuration::Data& d,
                  ::precice::span<const ::precice::VertexID> ids, std::size_t values);
/// Vertices of a face or cell: there, and not the same twice.
void check_corners(const Session& s, const char* call, const Mesh& mesh,
                   ::precice::span<const ::precice::VertexID> ids);

}  // namespace couplet::dropin
