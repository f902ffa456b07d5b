/* SPDX-License-Identifier: Apache-2.0 */
/* Rigid cylinder on a spring, m y'' + c y' + k y = F_y (trapezoidal rule), as a participant of a job.
 * Usage: spring_cylinder_c PARTICIPANT MASS DAMPING STIFFNESS START (per meter of depth; START is y at rest at t = 0) */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "couplet.h"

enum { N = 64 };

static double sum_of_y(const double* force) {
  double sum = 0;
  for (int i = 0; force && i < N; ++i) sum += force[2 * i + 1];
  return sum;
}

int main(int argc, char** argv) {
  if (argc < 6) return 2;
  const double m = atof(argv[2]), c = atof(argv[3]), k = atof(argv[4]), y0 = atof(argv[5]), pi = acos(-1.), r = 0.5;
  couplet_client* job = couplet_join(argv[1], "spring_cylinder_c");
  double xyz[3 * N], centres[3 * N], areas[3 * N], moved[2 * N], velocity[2 * N];
  int64_t first[N + 1] = {0}, corners[2 * N];
  for (int i = 0; i < N; ++i) {
    const double a = 2 * pi * i / N, b = a + pi / N, length = 2 * r * sin(pi / N);
    for (int d = 0; d < 3; ++d) {
      xyz[3 * i + d] = d == 0 ? r * cos(a) : d == 1 ? r * sin(a) : 0;
      centres[3 * i + d] = r * cos(pi / N) * (d == 0 ? cos(b) : d == 1 ? sin(b) : 0);
      areas[3 * i + d] = length * (d == 0 ? cos(b) : d == 1 ? sin(b) : 0);
    }
    corners[2 * i] = i, corners[2 * i + 1] = (i + 1) % N;
    first[i + 1] = 2 * (i + 1);
  }
  couplet_vertices(job, 2, N, xyz);
  couplet_faces(job, N, centres, areas, first, corners);
  couplet_takes(job, "pressure-force", "N", COUPLET_FACES, 0);
  couplet_takes(job, "viscous-force", "N", COUPLET_FACES, 0);
  couplet_gives(job, "displacement", "m", COUPLET_VERTICES, 0);
  couplet_gives(job, "velocity", "m/s", COUPLET_VERTICES, 0);
  char file_name[256];
  snprintf(file_name, sizeof file_name, "%s.csv", argv[1]);
  FILE* file = fopen(file_name, "w");
  double y = 0, v = 0, y_next = 0, v_next = 0;
  for (enum couplet_event event; (event = couplet_next(job)) != COUPLET_END;) {
    if (event == COUPLET_SOLVE) {
      const double dt = couplet_dt(job);
      const double force = sum_of_y(couplet_read(job, "pressure-force")) + sum_of_y(couplet_read(job, "viscous-force"));
      v_next = ((m / dt - c / 2) * v - k * (y + y0 + dt / 4 * v) + force) / (m / dt + c / 2 + k * dt / 4);
      y_next = y + dt / 2 * (v + v_next);
      for (int i = 0; i < N; ++i) {
        moved[2 * i] = velocity[2 * i] = 0;
        moved[2 * i + 1] = y_next, velocity[2 * i + 1] = v_next;
      }
      couplet_write(job, "displacement", moved);
      couplet_write(job, "velocity", velocity);
    }
    if (event == COUPLET_ACCEPT) {
      y = y_next, v = v_next;
      fprintf(file, "%.17g,%.17g,%.17g\n", couplet_time(job), y + y0, v);
      fflush(file);
    }
  }
  fclose(file);
  couplet_leave(job);
  return 0;
}
