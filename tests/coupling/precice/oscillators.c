/* SPDX-License-Identifier: Apache-2.0 */
/* oscillators.cpp in C, on one process. Usage: precice_oscillators_c Left|Right XML STEPS */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "precice/preciceC.h"

enum { N = 6 };

int main(int argc, char** argv) {
  if (argc < 4) return 2;
  const int left = strcmp(argv[1], "Left") == 0, steps = atoi(argv[3]);
  const char *mesh = left ? "Left-Mesh" : "Right-Mesh",
             *mine = left ? "Displacement-Left" : "Displacement-Right",
             *other = left ? "Displacement-Right" : "Displacement-Left";
  double xy[2 * N], u[N], v[N] = {0}, k[N], w0[N], w1[N], u_kept[N], v_kept[N], t = 0, t_kept = 0;
  int ids[N];
  precicec_createParticipant(argv[1], argv[2], 0, 1);
  for (int i = 0; i < N; ++i) {
    const double x = left ? i : N - 1 - i;
    xy[2 * i] = x, xy[2 * i + 1] = 0;
    u[i] = left ? 1 - 0.1 * x : 0.3 * x - 0.5;
    k[i] = left ? 40 + 4 * x : 30 + 2 * x;
    ids[i] = precicec_setMeshVertex(mesh, xy + 2 * i);
  }
  if (precicec_requiresInitialData()) precicec_writeData(mesh, mine, N, ids, u);
  precicec_initialize();
  char name[32];
  snprintf(name, sizeof name, "%s-0.txt", argv[1]);
  FILE* file = fopen(name, "w");
  const double spring = 15, window = precicec_getMaxTimeStepSize();
  while (precicec_isCouplingOngoing()) {
    if (precicec_requiresWritingCheckpoint()) {
      memcpy(u_kept, u, sizeof u), memcpy(v_kept, v, sizeof v);
      t_kept = t;
    }
    const double most = precicec_getMaxTimeStepSize(),
                 h = most < 1.5 * window / steps ? most : window / steps;
    precicec_readData(mesh, other, N, ids, 0, w0);
    precicec_readData(mesh, other, N, ids, h, w1);
    for (int i = 0; i < N; ++i) {
      const double stiffness = k[i] + spring;
      const double force = spring * (w0[i] + w1[i]) / 2 - stiffness * (u[i] + h / 4 * v[i]);
      const double v_new = (v[i] + h * force) / (1 + h * h / 4 * stiffness);
      u[i] += h / 2 * (v[i] + v_new);
      v[i] = v_new;
    }
    precicec_writeData(mesh, mine, N, ids, u);
    precicec_advance(h);
    t += h;
    if (precicec_requiresReadingCheckpoint()) {
      memcpy(u, u_kept, sizeof u), memcpy(v, v_kept, sizeof v);
      t = t_kept;
    } else if (precicec_isTimeWindowComplete()) {
      fprintf(file, "%.17g", t);
      for (int i = 0; i < N; ++i) fprintf(file, " %.17g", u[i]);
      fprintf(file, "\n");
    }
  }
  fclose(file);
  precicec_finalize();
  return 0;
}
