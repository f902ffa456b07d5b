// SPDX-License-Identifier: Apache-2.0
// preCICE's Fortran interface on top of the C interface. Each argument is an address, lengths of texts are
// hidden arguments at the end, and trailing blanks of texts are ignored.
#include <algorithm>
#include <cstring>
#include <string>

#include "precice/preciceC.h"

namespace {

std::string trimmed(const char* text, int length) {
  std::string all(text, std::size_t(std::max(length, 0)));
  all.erase(all.find_last_not_of(std::string(" \0", 2)) + 1);
  return all;
}

}  // namespace

extern "C" {

void precicef_create_(const char* name, const char* file, const int* rank, const int* size, int name_length,
                      int file_length) {
  precicec_createParticipant(trimmed(name, name_length).c_str(), trimmed(file, file_length).c_str(), *rank,
                             *size);
}
void precicef_initialize_() { precicec_initialize(); }
void precicef_advance_(const double* dt) { precicec_advance(*dt); }
void precicef_finalize_() { precicec_finalize(); }

void precicef_get_mesh_dimensions_(const char* mesh, int* dimensions, int n) {
  *dimensions = precicec_getMeshDimensions(trimmed(mesh, n).c_str());
}
void precicef_get_data_dimensions_(const char* mesh, const char* data, int* dimensions, int n, int k) {
  *dimensions = precicec_getDataDimensions(trimmed(mesh, n).c_str(), trimmed(data, k).c_str());
}
void precicef_is_coupling_ongoing_(int* answer) { *answer = precicec_isCouplingOngoing(); }
void precicef_is_time_window_complete_(int* answer) { *answer = precicec_isTimeWindowComplete(); }
void precicef_get_max_time_step_size_(double* dt) { *dt = precicec_getMaxTimeStepSize(); }
void precicef_requires_initial_data_(int* answer) { *answer = precicec_requiresInitialData(); }
void precicef_requires_writing_checkpoint_(int* answer) { *answer = precicec_requiresWritingCheckpoint(); }
void precicef_requires_reading_checkpoint_(int* answer) { *answer = precicec_requiresReadingCheckpoint(); }

void precicef_requires_mesh_connectivity_for_(const char* mesh, int* answer, int n) {
  *answer = precicec_requiresMeshConnectivityFor(trimmed(mesh, n).c_str());
}
void precicef_reset_mesh_(const char* mesh, int n) { precicec_resetMesh(trimmed(mesh, n).c_str()); }
void precicef_set_vertex_(const char* mesh, const double* position, int* id, int n) {
  *id = precicec_setMeshVertex(trimmed(mesh, n).c_str(), position);
}
void precicef_get_mesh_vertex_size_(const char* mesh, int* size, int n) {
  *size = precicec_getMeshVertexSize(trimmed(mesh, n).c_str());
}
void precicef_set_vertices_(const char* mesh, const int* size, const double* positions, int* ids, int n) {
  precicec_setMeshVertices(trimmed(mesh, n).c_str(), *size, positions, ids);
}
void precicef_set_edge_(const char* mesh, const int* a, const int* b, int n) {
  precicec_setMeshEdge(trimmed(mesh, n).c_str(), *a, *b);
}
void precicef_set_mesh_edges_(const char* mesh, const int* size, const int* ids, int n) {
  precicec_setMeshEdges(trimmed(mesh, n).c_str(), *size, ids);
}
void precicef_set_triangle_(const char* mesh, const int* a, const int* b, const int* c, int n) {
  precicec_setMeshTriangle(trimmed(mesh, n).c_str(), *a, *b, *c);
}
void precicef_set_mesh_triangles_(const char* mesh, const int* size, const int* ids, int n) {
  precicec_setMeshTriangles(trimmed(mesh, n).c_str(), *size, ids);
}
void precicef_set_quad_(const char* mesh, const int* a, const int* b, const int* c, const int* d, int n) {
  precicec_setMeshQuad(trimmed(mesh, n).c_str(), *a, *b, *c, *d);
}
void precicef_set_mesh_quads_(const char* mesh, const int* size, const int* ids, int n) {
  precicec_setMeshQuads(trimmed(mesh, n).c_str(), *size, ids);
}
void precicef_set_tetrahedron_(const char* mesh, const int* a, const int* b, const int* c, const int* d,
                               int n) {
  precicec_setMeshTetrahedron(trimmed(mesh, n).c_str(), *a, *b, *c, *d);
}
void precicef_set_mesh_tetrahedra_(const char* mesh, const int* size, const int* ids, int n) {
  precicec_setMeshTetrahedra(trimmed(mesh, n).c_str(), *size, ids);
}

// Aliases with the names of preCICE's later releases.
void precicef_set_mesh_vertex_(const char* mesh, const double* position, int* id, int n) {
  precicef_set_vertex_(mesh, position, id, n);
}
void precicef_set_mesh_vertices_(const char* mesh, const int* size, const double* positions, int* ids,
                                 int n) {
  precicef_set_vertices_(mesh, size, positions, ids, n);
}
void precicef_set_mesh_edge_(const char* mesh, const int* a, const int* b, int n) {
  precicef_set_edge_(mesh, a, b, n);
}
void precicef_set_mesh_triangle_(const char* mesh, const int* a, const int* b, const int* c, int n) {
  precicef_set_triangle_(mesh, a, b, c, n);
}
void precicef_set_mesh_quad_(const char* mesh, const int* a, const int* b, const int* c, const int* d,
                             int n) {
  precicef_set_quad_(mesh, a, b, c, d, n);
}
void precicef_set_mesh_tetrahedron_(const char* mesh, const int* a, const int* b, const int* c, const int* d,
                                    int n) {
  precicef_set_tetrahedron_(mesh, a, b, c, d, n);
}

void precicef_write_data_(const char* mesh, const char* data, const int* size, const int* ids,
                          const double* values, int n, int k) {
  precicec_writeData(trimmed(mesh, n).c_str(), trimmed(data, k).c_str(), *size, ids, values);
}
void precicef_read_data_(const char* mesh, const char* data, const int* size, const int* ids,
                         const double* time, double* values, int n, int k) {
  precicec_readData(trimmed(mesh, n).c_str(), trimmed(data, k).c_str(), *size, ids, *time, values);
}
void precicef_write_and_map_data_(const char* mesh, const char* data, const int* size,
                                  const double* coordinates, const double* values, int n, int k) {
  precicec_writeAndMapData(trimmed(mesh, n).c_str(), trimmed(data, k).c_str(), *size, coordinates, values);
}
void precicef_map_and_read_data_(const char* mesh, const char* data, const int* size,
                                 const double* coordinates, const double* time, double* values, int n,
                                 int k) {
  precicec_mapAndReadData(trimmed(mesh, n).c_str(), trimmed(data, k).c_str(), *size, coordinates, *time,
                          values);
}
void precicef_requires_gradient_data_for_(const char* mesh, const char* data, int* answer, int n, int k) {
  *answer = precicec_requiresGradientDataFor(trimmed(mesh, n).c_str(), trimmed(data, k).c_str());
}
void precicef_write_gradient_data_(const char* mesh, const char* data, const int* size, const int* ids,
                                   const double* gradients, int n, int k) {
  precicec_writeGradientData(trimmed(mesh, n).c_str(), trimmed(data, k).c_str(), *size, ids, gradients);
}
void precicef_set_mesh_access_region_(const char* mesh, const double* box, int n) {
  precicec_setMeshAccessRegion(trimmed(mesh, n).c_str(), box);
}
void precicef_get_mesh_vertex_ids_and_coordinates_(const char* mesh, const int* size, int* ids,
                                                   double* coordinates, int n) {
  precicec_getMeshVertexIDsAndCoordinates(trimmed(mesh, n).c_str(), *size, ids, coordinates);
}

void precicef_get_version_information_(char* text, int n) {
  const std::string version = precicec_getVersionInformation();
  if (n <= 0) return;
  std::memset(text, ' ', std::size_t(n));
  std::copy_n(version.begin(), std::min(version.size(), std::size_t(n)), text);
}
void precicef_start_profiling_section_(const char* section, int n) {
  precicec_startProfilingSection(trimmed(section, n).c_str());
}
void precicef_stop_last_profiling_section_() { precicec_stopLastProfilingSection(); }

}  // extern "C"
