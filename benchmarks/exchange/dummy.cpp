// SPDX-License-Identifier: Apache-2.0
// A participant without computations: n vertices on a sheet, three numbers in each direction, y_i = c_i - g_i
// x_i. Usage: dummy one|two VERTICES [changing], where `changing` varies g in each step, to defeat an
// accelerator; or dummy plain VERTICES on two processes, which sends the same bytes there and back by MPI only,
// or on three, through the second, which has the coupler's place.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "couplet.hpp"

namespace {

using Clock = std::chrono::steady_clock;
double seconds(Clock::time_point since) {
  return std::chrono::duration<double>(Clock::now() - since).count();
}

int plain(int n) {
  int rank = 0, ranks = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  std::vector<double> values(3 * std::size_t(n), rank);
  constexpr int rounds = 200;
  double least = 1e9;
  for (int k = 0; k < rounds; ++k) {
    MPI_Barrier(MPI_COMM_WORLD);
    const auto start = Clock::now();
    for (int hop = 0; hop < 2 * (ranks - 1); ++hop) {
      const bool back = hop >= ranks - 1;
      const int from = back ? 2 * (ranks - 1) - hop : hop, to = back ? from - 1 : from + 1;
      if (rank == from)
        MPI_Send(values.data(), 3 * n, MPI_DOUBLE, to, 0, MPI_COMM_WORLD);
      else if (rank == to)
        MPI_Recv(values.data(), 3 * n, MPI_DOUBLE, from, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    }
    least = std::min(least, seconds(start));
  }
  if (rank == 0) std::printf("plain %.6f ms there and back\n", 1e3 * least);
  MPI_Finalize();
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  const std::string name = argv[1];
  const int n = std::atoi(argv[2]), columns = int(std::sqrt(double(n)));
  if (name == "plain") return MPI_Init(&argc, &argv), plain(n);
  couplet::Client job(name, "dummy");
  std::vector<double> xyz;
  for (int i = 0; i < n; ++i) xyz.insert(xyz.end(), {double(i % columns), double(i / columns), 0.});
  job.vertices(3, xyz);
  job.faces({}, {});
  const bool first = name == "one";
  job.takes(first ? "force" : "motion", first ? "Pa" : "m", COUPLET_VERTICES);
  job.gives(first ? "motion" : "force", first ? "m" : "Pa", COUPLET_VERTICES);
  std::vector<double> answer(3 * std::size_t(n)), push(answer), slope(answer);
  const bool changing = argc > 3;
  std::size_t steps = 0;
  auto before = Clock::now();
  double own = 0, all = 0;
  int passes = 0;
  for (couplet_event event; (event = job.next()) != COUPLET_END;) {
    if (event == COUPLET_BEGIN) {
      for (std::size_t i = 0; i < push.size(); ++i) push[i] = std::sin(10 * job.time() + 1e-4 * double(i));
      for (std::size_t i = 0; i < slope.size(); ++i)
        slope[i] = 0.05 + 0.9 * double((i + 13 * steps) % 97) / 97;
      steps += changing;
      before = Clock::now();
    }
    if (event != COUPLET_SOLVE) continue;
    const auto start = Clock::now();
    const std::vector<double> x = job.read(first ? "force" : "motion");
    for (std::size_t i = 0; i < answer.size(); ++i) answer[i] = first ? push[i] - slope[i] * x[i] : x[i];
    job.write(first ? "motion" : "force", answer);
    own += seconds(start);
    all += seconds(before);
    before = Clock::now();
    ++passes;
  }
  if (first)
    std::printf("passes %d, %.6f ms a pass, of it the dummies' own %.6f ms\n", passes, 1e3 * all / passes,
                2e3 * own / passes);
  return 0;
}
