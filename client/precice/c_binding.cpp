// SPDX-License-Identifier: Apache-2.0
#include "precice/preciceC.h"

#include "only_participant.hpp"

namespace couplet::dropin {
namespace {

std::unique_ptr<::precice::Participant> participant;
std::string kept;
bool keeps = false;

}  // namespace

::precice::Participant& only_participant() {
  if (!participant)
    throw ::precice::Error(
        "The participant has not been created: precicec_createParticipant comes before all other calls.");
  return *participant;
}

void create_only_participant(::precice::string_view name, ::precice::string_view file, int rank, int size,
                             void* communicator) {
  participant = communicator == nullptr
                    ? std::make_unique<::precice::Participant>(name, file, rank, size)
                    : std::make_unique<::precice::Participant>(name, file, rank, size, communicator);
}

void told(const std::string& error) {
  if (!error.empty() && !keeps) end_the_job(error);
  kept = error;
}

}  // namespace couplet::dropin

using namespace couplet::dropin;
using precice::Participant;
using Ids = precice::span<const int>;
using Values = precice::span<const double>;

namespace {

std::size_t count(int n) {
  if (n < 0) throw precice::Error("A size is " + std::to_string(n) + ": it must not be negative.");
  return std::size_t(n);
}
std::size_t dimensions(Participant& p, const char* mesh) { return std::size_t(p.getMeshDimensions(mesh)); }
std::size_t components(Participant& p, const char* mesh, const char* data) {
  return std::size_t(p.getDataDimensions(mesh, data));
}

}  // namespace

extern "C" {

void couplet_precice_keep_errors(int keep) { keeps = keep != 0; }
const char* couplet_precice_error() { return kept.c_str(); }
/* What of a configuration is not supported for a participant, for couplet import; empty: nothing. */
const char* couplet_precice_problem(const char* file, const char* name) {
  static std::string problem;
  try {
    problem.clear();
    read_configuration(file, name);
  } catch (const precice::Error& error) {
    problem = error.what();
  }
  return problem.c_str();
}

void precicec_createParticipant(const char* name, const char* file, int rank, int size) {
  precicec_createParticipant_withCommunicator(name, file, rank, size, nullptr);
}
void precicec_createParticipant_withCommunicator(const char* name, const char* file, int rank, int size,
                                                 void* comm) {
  guarded([&] { create_only_participant(name, file, rank, size, comm); });
}

void precicec_initialize() {
  with_participant([](Participant& p) { p.initialize(); });
}
void precicec_advance(double dt) {
  with_participant([&](Participant& p) { p.advance(dt); });
}
void precicec_finalize() {
  with_participant([](Participant& p) { p.finalize(); });
}

int precicec_getMeshDimensions(const char* mesh) {
  return with_participant([&](Participant& p) { return p.getMeshDimensions(mesh); });
}
int precicec_getDataDimensions(const char* mesh, const char* data) {
  return with_participant([&](Participant& p) { return p.getDataDimensions(mesh, data); });
}
int precicec_isCouplingOngoing() {
  return with_participant([](Participant& p) { return p.isCouplingOngoing(); });
}
int precicec_isTimeWindowComplete() {
  return with_participant([](Participant& p) { return p.isTimeWindowComplete(); });
}
double precicec_getMaxTimeStepSize() {
  return with_participant([](Participant& p) { return p.getMaxTimeStepSize(); });
}
int precicec_requiresInitialData() {
  return with_participant([](Participant& p) { return p.requiresInitialData(); });
}
int precicec_requiresWritingCheckpoint() {
  return with_participant([](Participant& p) { return p.requiresWritingCheckpoint(); });
}
int precicec_requiresReadingCheckpoint() {
  return with_participant([](Participant& p) { return p.requiresReadingCheckpoint(); });
}

int precicec_requiresMeshConnectivityFor(const char* mesh) {
  return with_participant([&](Participant& p) { return p.requiresMeshConnectivityFor(mesh); });
}
void precicec_resetMesh(const char* mesh) {
  with_participant([&](Participant& p) { p.resetMesh(mesh); });
}
int precicec_setMeshVertex(const char* mesh, const double* position) {
  return with_participant([&](Participant& p) {
    return p.setMeshVertex(mesh, {position, dimensions(p, mesh)});
  });
}
int precicec_getMeshVertexSize(const char* mesh) {
  return with_participant([&](Participant& p) { return p.getMeshVertexSize(mesh); });
}
void precicec_setMeshVertices(const char* mesh, int size, const double* positions, int* ids) {
  with_participant([&](Participant& p) {
    p.setMeshVertices(mesh, {positions, count(size) * dimensions(p, mesh)}, {ids, count(size)});
  });
}
void precicec_setMeshEdge(const char* mesh, int a, int b) {
  with_participant([&](Participant& p) { p.setMeshEdge(mesh, a, b); });
}
void precicec_setMeshEdges(const char* mesh, int size, const int* ids) {
  with_participant([&](Participant& p) { p.setMeshEdges(mesh, Ids(ids, 2 * count(size))); });
}
void precicec_setMeshTriangle(const char* mesh, int a, int b, int c) {
  with_participant([&](Participant& p) { p.setMeshTriangle(mesh, a, b, c); });
}
void precicec_setMeshTriangles(const char* mesh, int size, const int* ids) {
  with_participant([&](Participant& p) { p.setMeshTriangles(mesh, Ids(ids, 3 * count(size))); });
}
void precicec_setMeshQuad(const char* mesh, int a, int b, int c, int d) {
  with_participant([&](Participant& p) { p.setMeshQuad(mesh, a, b, c, d); });
}
void precicec_setMeshQuads(const char* mesh, int size, const int* ids) {
  with_participant([&](Participant& p) { p.setMeshQuads(mesh, Ids(ids, 4 * count(size))); });
}
void precicec_setMeshTetrahedron(const char* mesh, int a, int b, int c, int d) {
  with_participant([&](Participant& p) { p.setMeshTetrahedron(mesh, a, b, c, d); });
}
void precicec_setMeshTetrahedra(const char* mesh, int size, const int* ids) {
  with_participant([&](Participant& p) { p.setMeshTetrahedra(mesh, Ids(ids, 4 * count(size))); });
}

void precicec_writeData(const char* mesh, const char* data, int size, const int* ids, const double* values) {
  with_participant([&](Participant& p) {
    p.writeData(mesh, data, Ids(ids, count(size)), Values(values, count(size) * components(p, mesh, data)));
  });
}
void precicec_readData(const char* mesh, const char* data, int size, const int* ids, double time,
                       double* values) {
  with_participant([&](Participant& p) {
    p.readData(mesh, data, Ids(ids, count(size)), time, {values, count(size) * components(p, mesh, data)});
  });
}
void precicec_writeAndMapData(const char* mesh, const char* data, int, const double*, const double*) {
  with_participant([&](Participant& p) { p.writeAndMapData(mesh, data, {}, {}); });
}
void precicec_mapAndReadData(const char* mesh, const char* data, int, const double*, double time, double*) {
  with_participant([&](Participant& p) { p.mapAndReadData(mesh, data, {}, time, {}); });
}
int precicec_requiresGradientDataFor(const char* mesh, const char* data) {
  return with_participant([&](Participant& p) { return p.requiresGradientDataFor(mesh, data); });
}
void precicec_writeGradientData(const char* mesh, const char* data, int, const int*, const double*) {
  with_participant([&](Participant& p) { p.writeGradientData(mesh, data, {}, {}); });
}
void precicec_setMeshAccessRegion(const char* mesh, const double*) {
  with_participant([&](Participant& p) { p.setMeshAccessRegion(mesh, {}); });
}
void precicec_getMeshVertexIDsAndCoordinates(const char* mesh, int, int*, double*) {
  with_participant([&](Participant& p) { p.getMeshVertexIDsAndCoordinates(mesh, {}, {}); });
}

const char* precicec_getVersionInformation() {
  static const std::string text = precice::getVersionInformation();
  return text.c_str();
}
void precicec_startProfilingSection(const char* section) {
  with_participant([&](Participant& p) { p.startProfilingSection(section); });
}
void precicec_stopLastProfilingSection() {
  with_participant([](Participant& p) { p.stopLastProfilingSection(); });
}

}  // extern "C"
