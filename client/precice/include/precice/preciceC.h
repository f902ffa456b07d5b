/* SPDX-License-Identifier: Apache-2.0 */
/* Version 3 of preCICE's C interface, with one participant per process. An error ends the whole job with a message. */
#ifndef COUPLET_PRECICE_C_H
#define COUPLET_PRECICE_C_H

#include "precice/Version.h"

#ifdef __cplusplus
extern "C" {
#endif

void precicec_createParticipant(const char* participantName, const char* configFileName,
                                int solverProcessIndex, int solverProcessSize);
/* `communicator` is an MPI_Comm*. */
void precicec_createParticipant_withCommunicator(const char* participantName, const char* configFileName,
                                                 int solverProcessIndex, int solverProcessSize,
                                                 void* communicator);

void precicec_initialize(void);
void precicec_advance(double computedTimeStepSize);
void precicec_finalize(void);

int precicec_getMeshDimensions(const char* meshName);
int precicec_getDataDimensions(const char* meshName, const char* dataName);
int precicec_isCouplingOngoing(void);
int precicec_isTimeWindowComplete(void);
double precicec_getMaxTimeStepSize(void);

int precicec_requiresInitialData(void);
int precicec_requiresWritingCheckpoint(void);
int precicec_requiresReadingCheckpoint(void);

int precicec_requiresMeshConnectivityFor(const char* meshName);
void precicec_resetMesh(const char* meshName);
int precicec_setMeshVertex(const char* meshName, const double* position);
int precicec_getMeshVertexSize(const char* meshName);
void precicec_setMeshVertices(const char* meshName, int size, const double* positions, int* ids);
void precicec_setMeshEdge(const char* meshName, int firstVertexID, int secondVertexID);
void precicec_setMeshEdges(const char* meshName, int size, const int* ids);
void precicec_setMeshTriangle(const char* meshName, int firstVertexID, int secondVertexID, int thirdVertexID);
void precicec_setMeshTriangles(const char* meshName, int size, const int* ids);
void precicec_setMeshQuad(const char* meshName, int firstVertexID, int secondVertexID, int thirdVertexID,
                          int fourthVertexID);
void precicec_setMeshQuads(const char* meshName, int size, const int* ids);
void precicec_setMeshTetrahedron(const char* meshName, int firstVertexID, int secondVertexID,
                                 int thirdVertexID, int fourthVertexID);
void precicec_setMeshTetrahedra(const char* meshName, int size, const int* ids);

void precicec_writeData(const char* meshName, const char* dataName, int size, const int* ids,
                        const double* values);
void precicec_readData(const char* meshName, const char* dataName, int size, const int* ids,
                       double relativeReadTime, double* values);
/* Not supported by this library: */
void precicec_writeAndMapData(const char* meshName, const char* dataName, int size, const double* coordinates,
                              const double* values);
void precicec_mapAndReadData(const char* meshName, const char* dataName, int size, const double* coordinates,
                             double relativeReadTime, double* values);
int precicec_requiresGradientDataFor(const char* meshName, const char* dataName);
void precicec_writeGradientData(const char* meshName, const char* dataName, int size, const int* ids,
                                const double* gradients);
void precicec_setMeshAccessRegion(const char* meshName, const double* boundingBox);
void precicec_getMeshVertexIDsAndCoordinates(const char* meshName, int size, int* ids, double* coordinates);

const char* precicec_getVersionInformation(void);
void precicec_startProfilingSection(const char* sectionName);
void precicec_stopLastProfilingSection(void);

/* Extension for languages with exceptions: with `keep` an error does not end the job but is stored until the next call. */
void couplet_precice_keep_errors(int keep);
const char* couplet_precice_error(void);

#ifdef __cplusplus
}
#endif
#endif
