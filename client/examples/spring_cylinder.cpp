// SPDX-License-Identifier: Apache-2.0
// Rigid cylinder on a spring, m y'' + c y' + k y = F_y (trapezoidal rule), as a participant of a job. Usage:
// spring_cylinder PARTICIPANT MASS DAMPING STIFFNESS START (per meter of depth; START is y at rest at t = 0)
#include <cmath>
#include <cstdlib>
#include <fstream>

#include "couplet.hpp"

struct State {
  double y = 0, v = 0;
};

int main(int argc, char** argv) {
  if (argc < 6) return 2;
  const std::string name = argv[1];
  const double m = std::atof(argv[2]), c = std::atof(argv[3]), k = std::atof(argv[4]),
               y0 = std::atof(argv[5]);
  {
    couplet::Client job(name, "spring_cylinder");
    const int n = 64;
    const double pi = std::acos(-1.), r = 0.5;
    std::vector<double> xyz, centres, areas;
    std::vector<std::int64_t> first{0}, corners;
    for (int i = 0; i < n; ++i) {
      const double a = 2 * pi * i / n, b = a + pi / n, length = 2 * r * std::sin(pi / n);
      xyz.insert(xyz.end(), {r * std::cos(a), r * std::sin(a), 0});
      centres.insert(centres.end(),
                     {r * std::cos(pi / n) * std::cos(b), r * std::cos(pi / n) * std::sin(b), 0});
      areas.insert(areas.end(), {length * std::cos(b), length * std::sin(b), 0});
      corners.insert(corners.end(), {i, (i + 1) % n});
      first.push_back(2 * (i + 1));
    }
    job.vertices(2, xyz);
    job.faces(centres, areas, first, corners);
    job.takes("pressure-force", "N", COUPLET_FACES);
    job.takes("viscous-force", "N", COUPLET_FACES);
    job.gives("displacement", "m", COUPLET_VERTICES);
    job.gives("velocity", "m/s", COUPLET_VERTICES);
    State now, next;
    std::ofstream file(name + ".csv");
    file.precision(17);
    while (const auto event = job.next()) {
      if (event == COUPLET_SOLVE) {
        double force = 0;
        for (const char* part : {"pressure-force", "viscous-force"}) {
          const std::vector<double> f = job.read(part);
          for (std::size_t i = 1; i < f.size(); i += 2) force += f[i];
        }
        // The displacement is relative to the initial mesh, so the spring acts with y0 from the start.
        const double dt = job.dt();
        next.v = ((m / dt - c / 2) * now.v - k * (now.y + y0 + dt / 4 * now.v) + force) /
                 (m / dt + c / 2 + k * dt / 4);
        next.y = now.y + dt / 2 * (now.v + next.v);
        std::vector<double> displacement, velocity;
        for (int i = 0; i < n; ++i) {
          displacement.insert(displacement.end(), {0, next.y});
          velocity.insert(velocity.end(), {0, next.v});
        }
        job.write("displacement", displacement);
        job.write("velocity", velocity);
      }
      if (event == COUPLET_ACCEPT) {
        now = next;
        file << job.time() << ',' << now.y + y0 << ',' << now.v << std::endl;
      }
      if (event == COUPLET_SAVE) {
        std::ofstream state(job.checkpoint() + ".txt");
        state.precision(17);
        state << now.y << ' ' << now.v;
      }
      if (event == COUPLET_LOAD) std::ifstream(job.checkpoint() + ".txt") >> now.y >> now.v;
    }
  }
}
