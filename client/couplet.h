/* SPDX-License-Identifier: Apache-2.0 */
/* A program of any kind as a participant of a Couplet job, over MPI alone. The protocol is docs/protocol.md.
 *
 *   couplet_client* c = couplet_join("solid", "my_solver");     all processes of the participant
 *   couplet_vertices(c, ...); couplet_faces(c, ...);             each process what it owns, or process 0 all
 *   couplet_takes(c, "pressure-force", "N", COUPLET_FACES, 0); couplet_gives(c, ...);
 *   while ((event = couplet_next(c)) != COUPLET_END) switch (event) ...
 *   couplet_leave(c);
 *
 * Between two calls of couplet_next the program does what the event asks for; the next call answers for it. Units
 * are SI. An error that is no failed step ends the whole job with a sentence (MPI_Abort). */
#ifndef COUPLET_H
#define COUPLET_H

#include <mpi.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct couplet_client couplet_client;

/* COUPLET_SURFACE + s: the vertices of surface s alone (couplet_surfaces). */
enum couplet_place { COUPLET_VERTICES = 0, COUPLET_FACES = 1, COUPLET_SURFACE = 2 };

enum couplet_event {
  COUPLET_END = 0,    /* the job is over */
  COUPLET_BEGIN = 2,  /* a step from state n begins (again, perhaps shorter): couplet_time, couplet_dt */
  COUPLET_SOLVE = 3,  /* solve it from state n for couplet_read, then couplet_write */
  COUPLET_ACCEPT = 4, /* what was solved last is state n now */
  COUPLET_OUTPUT = 5, /* write fields for couplet_time, number couplet_output */
  COUPLET_SAVE = 6,   /* save state n in the file couplet_checkpoint */
  COUPLET_LOAD = 7,   /* load it from there */
  COUPLET_START = 9   /* only after initial values of its own: couplet_read has those of the others */
};

/* Takes part in the start of the job, collective over all its processes; calls MPI_Init if the program has not, with the
 * transports that the other programs choose on one machine (a program that calls it itself probes all networks, and on
 * a machine with some of them may choose one that the others do not have). `participant`: its name under
 * `participants:` of the case; `program`: of that entry. */
couplet_client* couplet_join(const char* participant, const char* program);
/* The same for a program that is launched separately from the job: where the environment has COUPLET_JOIN=FILE, both functions
 * join through the relay that wrote FILE (docs/protocol.md, "Launched separately"), collective over `processes`, which are all
 * of the participant (couplet_join: MPI_COMM_WORLD). Without COUPLET_JOIN `processes` is not looked at. */
couplet_client* couplet_join_with(const char* participant, const char* program, MPI_Comm processes);
/* The processes of this participant. */
MPI_Comm couplet_comm(const couplet_client* c);

/* The interface, before the first couplet_next: what this process owns. `xyz`: 3 n coordinates [m], reference
 * configuration. `dimension`: 2 (z = 0, areas per metre of depth) or 3. */
void couplet_vertices(couplet_client* c, int dimension, int n, const double* xyz);
/* Vertices may belong to several surfaces, each with data of its own, which are carried between that surface's vertices
 * alone: of each vertex the number of its surface, from 0. Values are given and taken for all vertices all the same. */
void couplet_surfaces(couplet_client* c, const int* surface_of_vertex);
/* `areas`: vectors out of this participant [m^2]. `first` (n + 1) and `vertices` (first[n]): the vertices of face f
 * are vertices[first[f]] up to vertices[first[f + 1]], positions in the list of all processes' vertices, process by
 * process; both may be NULL, there is no work in the coupler's balance then. */
void couplet_faces(couplet_client* c, int n, const double* centres, const double* areas, const int64_t* first,
                   const int64_t* vertices);
/* `components`: values a place; 0: one a dimension (a vector). */
void couplet_takes(couplet_client* c, const char* datum, const char* unit, enum couplet_place place,
                   int components);
void couplet_gives(couplet_client* c, const char* datum, const char* unit, enum couplet_place place,
                   int components);

/* What the program was configured by, for the coupler to compare (docs/protocol.md, initialise); before the first couplet_next. */
void couplet_introduce(couplet_client* c, const char* text);

/* Answers for the last event and waits, without burning a core, for the next. Collective over couplet_comm. */
enum couplet_event couplet_next(couplet_client* c);

double couplet_time(const couplet_client* c); /* BEGIN, SOLVE: t^n; ACCEPT, OUTPUT: the accepted time [s] */
double couplet_dt(const couplet_client* c);
int couplet_output(const couplet_client* c); /* ACCEPT, OUTPUT: number of the output that is due, or -1 */
const char* couplet_checkpoint(
    const couplet_client* c); /* SAVE, LOAD: folder of the checkpoint + /<participant> */
/* SOLVE: values of a datum that is taken, place by place, this process's; NULL if nobody has given it yet or this
 * process owns no such place. Valid until the next couplet_next. END: as the others gave it last. */
const double* couplet_read(const couplet_client* c, const char* datum);
/* SOLVE: values of a datum that is given. Before the first couplet_next: its value before the first step; all data or
 * none, by all processes. */
void couplet_write(couplet_client* c, const char* datum, const double* values);
/* Values within a step, of programs that subdivide it. They go to those that ask for them, before the first couplet_next and
 * after couplet_takes. */
void couplet_takes_within(couplet_client* c, const char* datum);
/* SOLVE, besides couplet_write, which has the end of the step; `share`: of the step, between 0 and 1. */
void couplet_write_within(couplet_client* c, const char* datum, double share, const double* values);
/* SOLVE: how many there are of a datum that is taken; the values of one of them, by ascending share, counted from 0. Valid until
 * the next couplet_next. */
int couplet_within(const couplet_client* c, const char* datum);
const double* couplet_read_within(const couplet_client* c, const char* datum, int number, double* share);
/* SOLVE: instead of writing: the step could not be solved; `halving_helps`: a shorter one may be. */
void couplet_fail(couplet_client* c, const char* why, int halving_helps);
/* The largest step that is advised from now on [s]. */
void couplet_advise(couplet_client* c, double dt);
/* ACCEPT: what the accepted step was like: iterations of solvers, estimated time error, energy [J]; NAN: unknown. */
void couplet_report(couplet_client* c, int64_t iterations, double error, double energy);

/* After COUPLET_END. Calls MPI_Finalize if couplet_join has called MPI_Init. */
void couplet_leave(couplet_client* c);

#ifdef __cplusplus
}
#endif
#endif
