// SPDX-License-Identifier: Apache-2.0
// A pass of many vertices by preCICE's interface or by the client itself: prints the mean time between two windows, and a sum
// of all that was read. Usage: precice_cost precice|native One|Two XML VERTICES
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "client/couplet.h"
#include "precice/precice.hpp"

namespace {

struct Work {
  std::vector<double> xyz, values, read;
  std::vector<int> ids;
  double sum = 0, seconds = 0;
  int windows = 0;
  std::chrono::steady_clock::time_point since;

  explicit Work(int n)
      : xyz(3 * std::size_t(n)), values(3 * std::size_t(n)), read(3 * std::size_t(n)), ids(std::size_t(n)) {
    for (std::size_t i = 0; i < std::size_t(n); ++i) {
      xyz[3 * i] = double(i % 317) / 317, xyz[3 * i + 1] = double(i) / n;
      ids[i] = int(i);
    }
  }
  /// The window's work: values from what was read; the first two windows are not timed.
  void window() {
    const auto now = std::chrono::steady_clock::now();
    if (++windows > 2) seconds += std::chrono::duration<double>(now - since).count();
    since = now;
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = 0.5 * read[i] + double(i % 100) / windows;
    for (const double v : read) sum += v;
  }
  void tell() const { std::printf("%.6f s a window, sum %.17g\n", seconds / (windows - 2), sum); }
};

void by_precice(const std::string& name, const std::string& xml, Work& w) {
  const std::string mesh = name + "-Mesh", mine = "Data-" + name,
                    other = name == "One" ? "Data-Two" : "Data-One";
  precice::Participant p(name, xml, 0, 1);
  p.setMeshVertices(mesh, w.xyz, w.ids);
  p.initialize();
  while (p.isCouplingOngoing()) {
    const double dt = p.getMaxTimeStepSize();
    p.readData(mesh, other, w.ids, dt, w.read);
    w.window();
    p.writeData(mesh, mine, w.ids, w.values);
    p.advance(dt);
  }
  p.finalize();
}

void by_client(const std::string& name, Work& w) {
  const std::string mine = "Data-" + name, other = name == "One" ? "Data-Two" : "Data-One";
  couplet_client* c = couplet_join(name.c_str(), "precice");
  couplet_vertices(c, 3, int(w.ids.size()), w.xyz.data());
  couplet_takes(c, other.c_str(), "1", COUPLET_VERTICES, 0);
  couplet_gives(c, mine.c_str(), "1", COUPLET_VERTICES, 0);
  couplet_write(c, mine.c_str(), w.values.data());
  for (couplet_event event; (event = couplet_next(c)) != COUPLET_END;) {
    if (event != COUPLET_SOLVE) continue;
    if (const double* values = couplet_read(c, other.c_str())) w.read.assign(values, values + w.read.size());
    w.window();
    couplet_write(c, mine.c_str(), w.values.data());
  }
  couplet_leave(c);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 5) return 2;
  Work w(std::atoi(argv[4]));
  if (std::string(argv[1]) == "precice")
    by_precice(argv[2], argv[3], w);
  else
    by_client(argv[2], w);
  w.tell();
}
