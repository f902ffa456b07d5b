// SPDX-License-Identifier: Apache-2.0
// preCICE's interface of version 3, spoken to a Couplet job (docs/precice.md): a program that is written for preCICE
// takes part as it is. All calls throw precice::Error with a sentence.
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
  /// `configurationFileName`: the XML file, or the case that `couplet import` made of it. All processes of the participant, each with its rank and their number.
  Participant(string_view participantName, string_view configurationFileName, int solverProcessIndex,
              int solverProcessSize);
  /// `communicator`: an MPI_Comm* of these processes.
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

  // Meshes: `coordinates` point by point; edges and faces by the ids of their vertices
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
  /// `relativeReadTime`: from the start of the next time step, at most getMaxTimeStepSize().
  void readData(string_view meshName, string_view dataName, span<const VertexID> ids, double relativeReadTime,
                span<double> values) const;

  // Not supported by this library: each throws Error, the questions answer no
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

  // Accepted and not used: the coupler measures the time of all participants by itself
  void startProfilingSection(string_view sectionName);
  void stopLastProfilingSection();

 private:
  std::unique_ptr<couplet::dropin::Session> session_;
};

}  // namespace precice
