// SPDX-License-Identifier: Apache-2.0
// Calls of precice::Participant about meshes, and unsupported ones.
#include "checks.hpp"

namespace precice {

using namespace couplet::dropin;

namespace {

/// Adds elements of `n` vertices each.
template <class Add>
void elements(Session& s, string_view name, const char* call, span<const VertexID> ids, std::size_t n,
              Add add) {
  Mesh& mesh = open_mesh(s, name, call);
  if (ids.size() % n != 0)
    fail(s, std::string(call) + " was given " + std::to_string(ids.size()) +
                " vertex ids, which is not a multiple of " + std::to_string(n) + ".");
  for (std::size_t i = 0; i < ids.size(); i += n) {
    const span<const VertexID> one(ids.data() + i, n);
    check_corners(s, call, mesh, one);
    add(mesh, one);
  }
}

void add_face(Mesh& mesh, span<const VertexID> ids) { mesh.faces.emplace_back(ids.begin(), ids.end()); }

/// Adds a line, which is a face of the surface in 2-D. In 3-D it is ignored.
void add_edge(Mesh& mesh, span<const VertexID> ids) {
  if (mesh.dimensions == 2) add_face(mesh, ids);
}

/// Adds a face in 3-D. Areas in 2-D and volumes are ignored; values are mapped by their vertices.
void add_surface(Mesh& mesh, span<const VertexID> ids) {
  if (mesh.dimensions == 3) add_face(mesh, ids);
}

[[noreturn]] void refuse(const Session& s, const char* call, const char* what) {
  fail(s, std::string(call) + " is not supported by Couplet's library on preCICE's interface: " + what + ".");
}

}  // namespace

bool Participant::requiresMeshConnectivityFor(string_view mesh) const {
  return known_mesh(*session_, mesh).needs_connectivity;
}

VertexID Participant::setMeshVertex(string_view name, span<const double> position) {
  Session& s = *session_;
  Mesh& mesh = open_mesh(s, name, "setMeshVertex(...)");
  if (position.size() != std::size_t(mesh.dimensions))
    fail(s, "setMeshVertex(...) was given " + std::to_string(position.size()) + " coordinates for mesh \"" +
                mesh.name + "\", which has " + std::to_string(mesh.dimensions) + " dimensions.");
  return mesh.add(position.data());
}

int Participant::getMeshVertexSize(string_view name) const {
  const auto& known = known_mesh(*session_, name);
  if (!known.provided)
    refuse(*session_, "getMeshVertexSize(...) of a received mesh", "direct access to received meshes");
  return int(session_->mesh(known.name)->vertices());
}

void Participant::setMeshVertices(string_view name, span<const double> coordinates, span<VertexID> ids) {
  Session& s = *session_;
  Mesh& mesh = open_mesh(s, name, "setMeshVertices(...)");
  const auto n = std::size_t(mesh.dimensions);
  if (coordinates.size() != n * ids.size())
    fail(s, "setMeshVertices(...) was given " + std::to_string(coordinates.size()) + " coordinates and " +
                std::to_string(ids.size()) + " ids for mesh \"" + mesh.name + "\", which has " +
                std::to_string(n) + " dimensions.");
  for (std::size_t i = 0; i < ids.size(); ++i) ids[i] = mesh.add(coordinates.data() + n * i);
}

void Participant::setMeshEdge(string_view mesh, VertexID a, VertexID b) {
  const VertexID ids[] = {a, b};
  elements(*session_, mesh, "setMeshEdge(...)", span<const VertexID>(ids), 2, add_edge);
}
void Participant::setMeshEdges(string_view mesh, span<const VertexID> ids) {
  elements(*session_, mesh, "setMeshEdges(...)", ids, 2, add_edge);
}
void Participant::setMeshTriangle(string_view mesh, VertexID a, VertexID b, VertexID c) {
  const VertexID ids[] = {a, b, c};
  elements(*session_, mesh, "setMeshTriangle(...)", span<const VertexID>(ids), 3, add_surface);
}
void Participant::setMeshTriangles(string_view mesh, span<const VertexID> ids) {
  elements(*session_, mesh, "setMeshTriangles(...)", ids, 3, add_surface);
}
void Participant::setMeshQuad(string_view mesh, VertexID a, VertexID b, VertexID c, VertexID d) {
  const VertexID ids[] = {a, b, c, d};
  elements(*session_, mesh, "setMeshQuad(...)", span<const VertexID>(ids), 4, add_surface);
}
void Participant::setMeshQuads(string_view mesh, span<const VertexID> ids) {
  elements(*session_, mesh, "setMeshQuads(...)", ids, 4, add_surface);
}
void Participant::setMeshTetrahedron(string_view mesh, VertexID a, VertexID b, VertexID c, VertexID d) {
  const VertexID ids[] = {a, b, c, d};
  elements(*session_, mesh, "setMeshTetrahedron(...)", span<const VertexID>(ids), 4, [](Mesh&, auto) {});
}
void Participant::setMeshTetrahedra(string_view mesh, span<const VertexID> ids) {
  elements(*session_, mesh, "setMeshTetrahedra(...)", ids, 4, [](Mesh&, auto) {});
}

void Participant::resetMesh(string_view) {
  refuse(*session_, "resetMesh(...)", "meshes that change during the run");
}
void Participant::writeAndMapData(string_view, string_view, span<const double>, span<const double>) {
  refuse(*session_, "writeAndMapData(...)", "just-in-time mapping");
}
void Participant::mapAndReadData(string_view, string_view, span<const double>, double, span<double>) const {
  refuse(*session_, "mapAndReadData(...)", "just-in-time mapping");
}
void Participant::setMeshAccessRegion(string_view, span<const double>) const {
  refuse(*session_, "setMeshAccessRegion(...)", "direct access to received meshes");
}
void Participant::getMeshVertexIDsAndCoordinates(string_view, span<VertexID>, span<double>) const {
  refuse(*session_, "getMeshVertexIDsAndCoordinates(...)", "direct access to received meshes");
}
bool Participant::requiresGradientDataFor(string_view mesh, string_view data) const {
  if (!session_->configuration.find(mesh.str(), data.str(), true)) used_data(*session_, mesh, data, false);
  return false;
}
void Participant::writeGradientData(string_view, string_view, span<const VertexID>, span<const double>) {
  refuse(*session_, "writeGradientData(...)", "gradients of data");
}

void Participant::startProfilingSection(string_view name) {
  if (name.str().find('/') != std::string::npos)
    fail(*session_, "startProfilingSection(...): the name \"" + name.str() + "\" contains a slash.");
  ++session_->profiling_sections;
}
void Participant::stopLastProfilingSection() {
  check(*session_, session_->profiling_sections > 0,
        "stopLastProfilingSection(): no section has been started.");
  --session_->profiling_sections;
}

}  // namespace precice
