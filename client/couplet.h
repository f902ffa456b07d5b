/* SPDX-License-Identifier: Apache-2.0 */
/* Makes any program a participant of a Couplet job, using only MPI. docs/protocol.md defines the protocol.
 *
 *   couplet_client* c = couplet_join("solid", "my_solver");     all processes of the participant
 *   couplet_vertices(c, ...); couplet_faces(c, ...);             each process its part, or process 0 everything
 *   couplet_takes(c, "pressure-force", "N", COUPLET_FACES, 0); couplet_gives(c, ...);
 *   while ((event = couplet_next(c)) != COUPLET_END) switch (event) ...
 *   couplet_leave(c);
 *
 * Between two calls of couplet_next the program handles the event, and the next call sends its reply. All units are
 * SI. Any error except a failed step ends the whole job with a message (MPI_Abort). */
#ifndef COUPLET_H
#define COUPLET_H

#include <mpi.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct couplet_client couplet_client;

/* COUPLET_SURFACE + s means only the vertices of surface s (couplet_surfaces). */
enum couplet_place { COUPLET_VERTICES = 0, COUPLET_FACES = 1, COUPLET_SURFACE = 2 };

enum couplet_event {
  COUPLET_END = 0,    /* the job is over */
  COUPLET_BEGIN = 2,  /* a step from state n begins (again, perhaps shorter): couplet_time, couplet_dt */
  COUPLET_SOLVE = 3,  /* solve it from state n with the input of couplet_read, then couplet_write */
  COUPLET_ACCEPT = 4, /* the last solution becomes state n */
  COUPLET_OUTPUT = 5, /* write fields for couplet_time, number couplet_output */
  COUPLET_SAVE = 6,   /* save state n to the file couplet_checkpoint */
  COUPLET_LOAD = 7,   /* load state n from that file */
  COUPLET_START = 9   /* only if it wrote initial values: couplet_read returns those of the others */
};

/* Takes part in the start of the job. Collective over all its processes. Calls MPI_Init unless the program has done so,
 * with the transports of the other programs on one machine. (A program that calls it itself probes all networks and may
 * choose one that the others do not use.) `participant` is the name under `participants:` of the case, `program` that of
 * the entry. */
couplet_client* couplet_join(const char* participant, const char* program);
/* Joins also if the program was launched separately. If the environment has COUPLET_JOIN=FILE, both functions join through
 * the relay that wrote FILE (docs/protocol.md, "Launched separately"). This is collective over `processes`, all those of the
 * participant (couplet_join: MPI_COMM_WORLD). Without COUPLET_JOIN, `processes` is ignored. */
couplet_client* couplet_join_with(const char* participant, const char* program, MPI_Comm processes);
/* Communicator of this participant's processes. */
MPI_Comm couplet_comm(const couplet_client* c);

/* Declares the vertices that this process owns, before the first couplet_next. `xyz` holds 3 n coordinates [m] in the
 * reference configuration. `dimension` is 2 (z = 0, areas per meter of depth) or 3. */
void couplet_vertices(couplet_client* c, int dimension, int n, const double* xyz);
/* Assigns each vertex to a surface, numbered from 0. Data of a surface are mapped only between its own vertices, but values
 * are still exchanged for all vertices. */
void couplet_surfaces(couplet_client* c, const int* surface_of_vertex);
/* Declares faces. `areas` are vectors out of this participant [m^2]. Face f has the vertices vertices[first[f]] to
 * vertices[first[f + 1] - 1], positions in the concatenated list of all processes' vertices. `first` (n + 1 values) and
 * `vertices` may be NULL; the coupler then computes no work balance. */
void couplet_faces(couplet_client* c, int n, const double* centres, const double* areas, const int64_t* first,
                   const int64_t* vertices);
/* `components`: values a place; 0: one a dimension (a vector). */
void couplet_takes(couplet_client* c, const char* datum, const char* unit, enum couplet_place place,
                   int components);
void couplet_gives(couplet_client* c, const char* datum, const char* unit, enum couplet_place place,
                   int components);

/* Sends the program's configuration to the coupler for comparison (docs/protocol.md, initialise), before couplet_next. */
void couplet_introduce(couplet_client* c, const char* text);

/* Replies to the last event and waits for the next one without busy polling. Collective over couplet_comm. */
enum couplet_event couplet_next(couplet_client* c);

double couplet_time(const couplet_client* c); /* BEGIN, SOLVE: t^n; ACCEPT, OUTPUT: the accepted time [s] */
double couplet_dt(const couplet_client* c);
int couplet_output(const couplet_client* c); /* ACCEPT, OUTPUT: number of the output that is due, or -1 */
const char* couplet_checkpoint(
    const couplet_client* c); /* SAVE, LOAD: folder of the checkpoint + /<participant> */
/* SOLVE: values of a datum that is taken, place by place, this process's; NULL if nobody has given it yet or this
 * process owns no such place. Valid until the next couplet_next. END: as the others gave it last. */
const double* couplet_read(const couplet_client* c, const char* datum);
/* SOLVE: sets the values of a datum to send. Before the first couplet_next: its initial values. All processes must then
 * write all data or none. */
void couplet_write(couplet_client* c, const char* datum, const double* values);
/* Requests values within a step from programs with sub-steps, after couplet_takes and before the first couplet_next. */
void couplet_takes_within(couplet_client* c, const char* datum);
/* SOLVE: sets values at a fraction `share` of the step, between 0 and 1. couplet_write sets those at its end. */
void couplet_write_within(couplet_client* c, const char* datum, double share, const double* values);
/* SOLVE: number of values within the step of a received datum, and one of them by its index from 0, in order of ascending
 * share. Valid until the next couplet_next. */
int couplet_within(const couplet_client* c, const char* datum);
const double* couplet_read_within(const couplet_client* c, const char* datum, int number, double* share);
/* SOLVE: reports a failed step instead of writing. `halving_helps` if a shorter step may succeed. */
void couplet_fail(couplet_client* c, const char* why, int halving_helps);
/* SOLVE: leaves the coupling before its end instead of writing. couplet_next must be called until COUPLET_END. If all programs
 * leave in the same step, the job ends without an error. */
void couplet_quit(couplet_client* c, const char* why);
/* Recommends a largest time step from now on [s]. */
void couplet_advise(couplet_client* c, double dt);
/* ACCEPT: reports solver iterations, estimated time error and energy [J] of the step, NAN if unknown. */
void couplet_report(couplet_client* c, int64_t iterations, double error, double energy);

/* Must be called after COUPLET_END. Calls MPI_Finalize if couplet_join called MPI_Init. */
void couplet_leave(couplet_client* c);

#ifdef __cplusplus
}
#endif
#endif
