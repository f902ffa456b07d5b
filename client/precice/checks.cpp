// SPDX-License-Identifier: Apache-2.0
#include "checks.hpp"

#include <cstdio>

namespace couplet::dropin {

void fail(const Session& s, const std::string& why) {
  s.last_error = why;
  throw ::precice::Error(why);
}

std::string text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%g", value);
  return buffer;
}

namespace {

template <class List, class Wanted>
std::string names(const List& list, Wanted wanted) {
  std::string all;
  for (const auto& item : list)
    if (wanted(item)) all += (all.empty() ? "\"" : ", \"") + item.name + "\"";
  return all.empty() ? "none" : all;
}

}  // namespace

const Configuration::Mesh& known_mesh(const Session& s, ::precice::string_view name) {
  const Configuration::Mesh* found = s.configuration.mesh(name.str());
  if (!found)
    fail(s, "The mesh named \"" + name.str() + "\" is unknown to preCICE. Known meshes of \"" +
                s.configuration.participant +
                "\" are: " + names(s.configuration.meshes, [](const auto&) { return true; }) + ".");
  return *found;
}

Mesh& open_mesh(Session& s, ::precice::string_view name, const char* call) {
  const Configuration::Mesh& known = known_mesh(s, name);
  if (!known.provided)
    fail(s, std::string(call) + ": the participant \"" + s.configuration.participant +
                "\" does not provide the mesh \"" + known.name + "\", it receives it.");
  if (s.initialised)
    fail(s,
         std::string(call) + ": the mesh \"" + known.name + "\" is locked, because initialize() was called.");
  return *s.mesh(known.name);
}

std::string unknown_data(const Session& s, const std::string& mesh, const std::string& data) {
  return "The data \"" + data + "\" is unknown on mesh \"" + mesh + "\". Data of \"" +
         s.configuration.participant +
         "\" there are: " + names(s.configuration.data, [&](const auto& d) { return d.mesh == mesh; }) + ".";
}

const Configuration::Data& used_data(const Session& s, ::precice::string_view mesh,
                                     ::precice::string_view data, bool written) {
  for (const Configuration::Data& d : s.configuration.data)
    if (d.written == written && d.name.size() == data.size() && d.mesh.size() == mesh.size() &&
        d.name.compare(0, d.name.npos, data.data(), data.size()) == 0 &&
        d.mesh.compare(0, d.mesh.npos, mesh.data(), mesh.size()) == 0)
      return d;
  const Configuration::Mesh& known = known_mesh(s, mesh);
  if (s.configuration.find(known.name, data.str(), !written))
    fail(s, "The participant \"" + s.configuration.participant + "\" does not " +
                (written ? "write" : "read") + " the data \"" + data.str() + "\" on mesh \"" + known.name +
                "\", it " + (written ? "reads" : "writes") + " it.");
  fail(s, unknown_data(s, known.name, data.str()));
}

void check_values(const Session& s, const char* call, const Configuration::Data& d,
                  ::precice::span<const ::precice::VertexID> ids, std::size_t values) {
  const std::size_t wanted = ids.size() * s.components(d);
  if (values != wanted)
    fail(s, std::string(call) + "(...) of \"" + d.name + "\" on mesh \"" + d.mesh + "\" was given " +
                std::to_string(values) + " values where " + std::to_string(ids.size()) + " vertices need " +
                std::to_string(wanted) + ".");
  std::int64_t n = 0;
  for (const Mesh& m : s.meshes)
    if (m.name == d.mesh) n = m.vertices();
  for (const ::precice::VertexID id : ids)
    if (id < 0 || id >= n)
      fail(s, std::string(call) + "(...) of \"" + d.name + "\": the vertex id " + std::to_string(id) +
                  " is invalid on mesh \"" + d.mesh + "\", which has " + std::to_string(n) +
                  " vertices on this process.");
}

void check_corners(const Session& s, const char* call, const Mesh& mesh,
                   ::precice::span<const ::precice::VertexID> ids) {
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (ids[i] < 0 || ids[i] >= mesh.vertices())
      fail(s, std::string(call) + ": the vertex id " + std::to_string(ids[i]) + " is invalid on mesh \"" +
                  mesh.name + "\", which has " + std::to_string(mesh.vertices()) +
                  " vertices on this process.");
    for (std::size_t j = 0; j < i; ++j)
      if (ids[i] == ids[j])
        fail(s, std::string(call) + ": the vertex id " + std::to_string(ids[i]) +
                    " occurs twice in one element of mesh \"" + mesh.name + "\".");
  }
}

}  // namespace couplet::dropin
