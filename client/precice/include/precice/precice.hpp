// SPDX-License-Identifier: Apache-2.0
// Version 3 of preCICE's interface for Couplet jobs (docs/precice.md). Programs written for preCICE take part
// without changes. All calls throw precice::Error.
#pragma once

#include <memory>

#include "precice/Exceptions.hpp"
#include "precice/Tooling.hpp"
#include "precice/Types.hpp"
#include "precice/Version.h"
#include "precice/views.hpp"

namespace couplet {
namespace dropin {
class Session;
}
}  // namespace couplet

namespace precice {

class Participant {
 public:
  /// `configurationFileName` is the XML file or the case that `couplet import` made of it. Collective.
  Participant(string_view participantName, string_view configurationFileName, int solverProcessIndex,
              int solverProcessSize);
  /// Overload with `communicator`, an MPI_Comm* of these processes.
  Participant(string_view participantName, string_view configurationFileName, int solverProcessIndex,
              int solverProcessSize, void* communicator);
  ~Participant();
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  // Steering
  void initialize();
  void advance(double computedTimeStepSize);
  void finalize();

  // Status
  int getMeshDimensions(string_view meshName) const;
  int getDataDimensions(string_view meshName, string_view dataName) const;
  bool isCouplingOngoing() const;
  bool isTimeWindowComplete() const;
  double getMaxTimeStepSize() const;

  // Requirements
  bool requiresInitialData();
  bool requiresWritingCheckpoint();
  bool requiresReadingCheckpoint();

  // Meshes: `coordinates` point by point, edges and faces by the ids of their vertices
  bool requiresMeshConnectivityFor(string_view meshName) const;
  void resetMesh(string_view meshName);
  VertexID setMeshVertex(string_view meshName, span<const double> position);
  int getMeshVertexSize(string_view meshName) const;
  void setMeshVertices(string_view meshName, span<const double> coordinates, span<VertexID> ids);
  void setMeshEdge(string_view meshName, VertexID first, VertexID second);
  void setMeshEdges(string_view meshName, span<const VertexID> ids);
  void setMeshTriangle(string_view meshName, VertexID first, VertexID second, VertexID third);
  void setMeshTriangles(string_view meshName, span<const VertexID> ids);
  void setMeshQuad(string_view meshName, VertexID first, VertexID second, VertexID third, VertexID fourth);
  void setMeshQuads(string_view meshName, span<const VertexID> ids);
  void setMeshTetrahedron(string_view meshName, VertexID first, VertexID second, VertexID third,
                          VertexID fourth);
  void setMeshTetrahedra(string_view meshName, span<const VertexID> ids);

  // Data: values vertex by vertex
  void writeData(string_view meshName, string_view dataName, span<const VertexID> ids,
                 span<const double> values);
  /// `relativeReadTime` is measured from the start of the next time step, at most getMaxTimeStepSize().
  void readData(string_view meshName, string_view dataName, span<const VertexID> ids, double relativeReadTime,
                span<double> values) const;

  // Not supported by this library: each throws Error, queries return false
  void writeAndMapData(string_view meshName, string_view dataName, span<const double> coordinates,
                       span<const double> values);
  void mapAndReadData(string_view meshName, string_view dataName, span<const double> coordinates,
                      double relativeReadTime, span<double> values) const;
  void setMeshAccessRegion(string_view meshName, span<const double> boundingBox) const;
  void getMeshVertexIDsAndCoordinates(string_view meshName, span<VertexID> ids,
                                      span<double> coordinates) const;
  bool requiresGradientDataFor(string_view meshName, string_view dataName) const;
  void writeGradientData(string_view meshName, string_view dataName, span<const VertexID> ids,
                         span<const double> gradients);

  // Accepted but ignored: the coupler measures the time of all participants
  void startProfilingSection(string_view sectionName);
  void stopLastProfilingSection();

 private:
  void construct(string_view participantName, string_view configurationFileName, int solverProcessIndex,
                 int solverProcessSize, void* communicator);
  std::unique_ptr<couplet::dropin::Session> session_;
};

}  // namespace precice
