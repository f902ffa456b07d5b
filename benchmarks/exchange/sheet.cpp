// SPDX-License-Identifier: Apache-2.0
// One side of a wall of about VERTICES vertices on any number of processes: a wavy sheet of quadrilaterals,
// different on each side, one block per process. `fluid` gives forces at faces for displacements at vertices,
// `solid` the reverse. Usage: sheet fluid|solid VERTICES, or sheet plain VERTICES on an even number of
// processes, which sends the same bytes between the halves. Prints start of the first step and time per step.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "couplet.hpp"

namespace {

using Clock = std::chrono::steady_clock;
double seconds(Clock::time_point since) {
  return std::chrono::duration<double>(Clock::now() - since).count();
}

struct Block {
  std::int64_t first, end;
};
Block block_of(std::int64_t n, int blocks, int b) { return {n * b / blocks, n * (b + 1) / blocks}; }

/// nx by ny vertices over columns by rows of processes.
struct Sheet {
  std::int64_t nx, ny;
  int columns, rows, rank;
  bool down;  ///< looks down: out of the body above
  std::vector<double> xyz, centres, areas;
  std::vector<std::int64_t> first{0}, corners;

  Sheet(std::int64_t n, bool is_fluid, int ranks, int own) : rank(own), down(is_fluid) {
    const auto side = std::int64_t(std::sqrt(double(n)));
    nx = is_fluid ? side : side * 99 / 100, ny = n / nx;
    columns = std::max(1, int(std::sqrt(double(ranks))));
    while (ranks % columns != 0) --columns;
    rows = ranks / columns;
    fill();
  }
  /// Position in the list of all processes' vertices.
  std::int64_t position(std::int64_t i, std::int64_t j) const {
    int c = 0, r = 0;
    while (block_of(nx, columns, c).end <= i) ++c;
    while (block_of(ny, rows, r).end <= j) ++r;
    const Block x = block_of(nx, columns, c), y = block_of(ny, rows, r);
    return y.first * nx + x.first * (y.end - y.first) + (j - y.first) * (x.end - x.first) + i - x.first;
  }
  void place(double i, double j, std::vector<double>& to) const {
    const double x = i / double(nx - 1), y = j / double(ny - 1);
    to.insert(to.end(), {x, y, 0.02 * std::sin(6 * x) * std::sin(7 * y)});
  }
  void fill() {
    const Block x = block_of(nx, columns, rank % columns), y = block_of(ny, rows, rank / columns);
    for (std::int64_t j = y.first; j < y.end; ++j)
      for (std::int64_t i = x.first; i < x.end; ++i) place(double(i), double(j), xyz);
    for (std::int64_t j = y.first; j < std::min(y.end, ny - 1); ++j)
      for (std::int64_t i = x.first; i < std::min(x.end, nx - 1); ++i) add_face(i, j);
  }
  void add_face(std::int64_t i, std::int64_t j) {
    std::vector<double> p;
    for (const auto& [a, b] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}})
      place(double(i + a), double(j + b), p), corners.push_back(position(i + a, j + b));
    if (down) std::swap(corners[corners.size() - 3], corners.back());
    first.push_back(std::int64_t(corners.size()));
    double u[3], v[3];
    for (int c = 0; c < 3; ++c) {
      centres.push_back((p[c] + p[3 + c] + p[6 + c] + p[9 + c]) / 4);
      u[c] = p[6 + c] - p[c], v[c] = p[9 + c] - p[3 + c];
    }
    const double sign = down ? -0.5 : 0.5;
    for (int c = 0; c < 3; ++c)
      areas.push_back(sign * (u[(c + 1) % 3] * v[(c + 2) % 3] - u[(c + 2) % 3] * v[(c + 1) % 3]));
  }
};

/// Sends and receives the data of a pass; each process has a partner in the other half.
int plain(std::int64_t n) {
  int rank = 0, ranks = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  const int half = ranks / 2, other = (rank + half) % ranks, count = int(3 * n / half);
  std::vector<double> values(std::size_t(count), rank);
  double least = 1e9;
  for (int k = 0; k < 20; ++k) {
    MPI_Barrier(MPI_COMM_WORLD);
    const auto start = Clock::now();
    for (int way = 0; way < 2; ++way)
      if ((rank < half) == (way == 0))
        MPI_Send(values.data(), count, MPI_DOUBLE, other, 0, MPI_COMM_WORLD);
      else
        MPI_Recv(values.data(), count, MPI_DOUBLE, other, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    MPI_Barrier(MPI_COMM_WORLD);
    least = std::min(least, seconds(start));
  }
  if (rank == 0) std::printf("plain %.6f s there and back\n", least);
  MPI_Finalize();
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  const std::string name = argv[1];
  const std::int64_t n = std::atoll(argv[2]);
  if (name == "plain") return MPI_Init(&argc, &argv), plain(n);
  couplet::Client job(name, "sheet");
  int rank = 0, ranks = 0;
  MPI_Comm_rank(job.comm(), &rank);
  MPI_Comm_size(job.comm(), &ranks);
  const auto joined = Clock::now();
  const bool fluid = name == "fluid";
  const Sheet sheet(n, fluid, ranks, rank);
  job.vertices(3, sheet.xyz);
  job.faces(sheet.centres, sheet.areas, sheet.first, sheet.corners);
  (fluid ? job.takes("displacement", "m", COUPLET_VERTICES) : job.takes("force", "N", COUPLET_FACES));
  (fluid ? job.gives("force", "N", COUPLET_FACES) : job.gives("displacement", "m", COUPLET_VERTICES));
  // Linear in position, for checking: displacement (z, x, y) of the position, force area times (1, 2, 3).
  std::vector<double> answer;
  const std::vector<double>& from = fluid ? sheet.areas : sheet.xyz;
  for (std::size_t i = 0; i < from.size(); i += 3)
    if (fluid) {
      const double area =
          std::sqrt(from[i] * from[i] + from[i + 1] * from[i + 1] + from[i + 2] * from[i + 2]);
      answer.insert(answer.end(), {area, 2 * area, 3 * area});
    } else
      answer.insert(answer.end(), {from[i + 2], from[i], from[i + 1]});
  bool begun = false;
  int steps = 0;
  double wrong = 0, least = 1e9;
  auto before = Clock::now();
  for (couplet_event event; (event = job.next()) != COUPLET_END;) {
    if (event == COUPLET_BEGIN && !begun) {
      begun = true;
      if (rank == 0) std::printf("%s: first step after %.3f s\n", name.c_str(), seconds(joined));
    }
    if (event == COUPLET_BEGIN) {
      if (steps++ > 0) least = std::min(least, seconds(before));
      before = Clock::now();
    }
    if (event != COUPLET_SOLVE) continue;
    const std::vector<double> came = job.read(fluid ? "displacement" : "force");
    if (fluid && steps > 1)
      for (std::size_t i = 0; i < came.size(); i += 3)
        for (std::size_t c = 0; c < 3; ++c)
          wrong = std::max(wrong, std::abs(came[i + c] - sheet.xyz[i + (c + 2) % 3]));
    job.write(fluid ? "force" : "displacement", answer);
  }
  double most = 0;
  MPI_Reduce(&wrong, &most, 1, MPI_DOUBLE, MPI_MAX, 0, job.comm());
  if (fluid && rank == 0)
    std::printf("fluid: %d steps, %.6f s a step, displacement off by %.3g m\n", steps, least, most);
  return 0;
}
