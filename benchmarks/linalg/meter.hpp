// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <malloc.h>
#include <mpi.h>
#include <sys/resource.h>

#include <cstdio>
#include <fstream>
#include <string>

#include "common/parallel/collective.hpp"

namespace couplet::benchmark {

/// CPU time of all ranks together, and the memory added since construction.
class Meter {
 public:
  explicit Meter(MPI_Comm comm) : comm_(comm) {
    malloc_trim(0);
    std::ofstream("/proc/self/clear_refs") << "5";  // reset the peak
    megabytes_ = of_process("VmRSS:");
    MPI_Barrier(comm);
    seconds_ = now();
  }
  /// CPU time of all ranks [s].
  double seconds() const { return parallel::sum(comm_, now() - seconds_); }
  /// Largest additional memory of all ranks [MB].
  double peak() const { return parallel::sum(comm_, of_process("VmHWM:") - megabytes_); }

 private:
  static double now() {
    rusage used{};
    getrusage(RUSAGE_SELF, &used);
    const auto of = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
    return of(used.ru_utime) + of(used.ru_stime);
  }
  static double of_process(const std::string& key) {
    std::ifstream file("/proc/self/status");
    std::string word;
    double kilobytes = 0;
    while (file >> word)
      if (word == key && file >> kilobytes) return kilobytes / 1024;
    return 0;
  }

  MPI_Comm comm_;
  double seconds_ = 0, megabytes_ = 0;
};

}  // namespace couplet::benchmark
