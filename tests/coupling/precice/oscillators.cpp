// SPDX-License-Identifier: Apache-2.0
// One end of six pairs of masses on springs, m u'' + k u + 15 (u - w) = 0 with the other end's displacement w, by the
// trapezoidal rule, on preCICE's interface. Usage: precice_oscillators Left|Right XML STEPS [parallel]
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "couplet_precice.h"
#include "precice/precice.hpp"

int main(int argc, char** argv) {
  if (argc < 4) return 2;
  const std::string name = argv[1], mesh = name + "-Mesh", other = name == "Left" ? "Right" : "Left";
  const bool left = name == "Left";
  const int steps = std::atoi(argv[3]), pairs = 6;
  int rank = 0, size = 1;
  if (argc > 4) {
    MPI_Comm_rank(couplet_precice_comm(argv[1]), &rank);
    MPI_Comm_size(couplet_precice_comm(argv[1]), &size);
  }
  precice::Participant participant(name, argv[2], rank, size);
  std::vector<double> xy, u, k;
  for (int i = pairs * rank / size; i < pairs * (rank + 1) / size; ++i) {
    const double x = left ? i : pairs - 1 - i;  // the other end counts from its own side
    xy.insert(xy.end(), {x, 0});
    u.push_back(left ? 1 - 0.1 * x : 0.3 * x - 0.5);
    k.push_back(left ? 40 + 4 * x : 30 + 2 * x);
  }
  const std::size_t n = u.size();
  std::vector<double> v(n, 0), w0(n), w1(n);
  std::vector<int> ids(n);
  participant.setMeshVertices(mesh, xy, ids);
  if (participant.requiresInitialData()) participant.writeData(mesh, "Displacement-" + name, ids, u);
  participant.initialize();
  std::ofstream file(name + "-" + std::to_string(rank) + ".txt");
  file.precision(17);
  double t = 0, t_kept = 0;
  const double spring = 15, window = participant.getMaxTimeStepSize();
  std::vector<double> u_kept, v_kept;
  while (participant.isCouplingOngoing()) {
    if (participant.requiresWritingCheckpoint()) u_kept = u, v_kept = v, t_kept = t;
    const double most = participant.getMaxTimeStepSize(),
                 h = most < 1.5 * window / steps ? most : window / steps;
    participant.readData(mesh, "Displacement-" + other, ids, 0, w0);
    participant.readData(mesh, "Displacement-" + other, ids, h, w1);
    for (std::size_t i = 0; i < n; ++i) {
      const double stiffness = k[i] + spring;
      const double force = spring * (w0[i] + w1[i]) / 2 - stiffness * (u[i] + h / 4 * v[i]);
      const double v_new = (v[i] + h * force) / (1 + h * h / 4 * stiffness);
      u[i] += h / 2 * (v[i] + v_new);
      v[i] = v_new;
    }
    participant.writeData(mesh, "Displacement-" + name, ids, u);
    participant.advance(h);
    t += h;
    if (participant.requiresReadingCheckpoint()) {
      u = u_kept, v = v_kept, t = t_kept;
    } else if (participant.isTimeWindowComplete()) {
      file << t;
      for (const double value : u) file << ' ' << value;
      file << std::endl;
    }
  }
  participant.finalize();
}
