// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

namespace couplet::log {

/// Where the watch over a job (common/app/watch/watch) hears that this process is alive.
struct LifeSigns {
  std::atomic<double>* last = nullptr;    ///< time of the last sign [s], machine's steady clock
  std::atomic<int>* long_work = nullptr;  ///< above 0: within LongWork
};
void listen_for_life(LifeSigns signs);

/// A sign of life out of work that may take long: an iteration of a solver, a field written. Costs 30 ns.
void alive();

/// Work that can give no sign while it lasts (a factorisation, a mesh being made by another program): until the end of
/// the scope the processor time of the process and of its children is the sign.
class LongWork {
 public:
  LongWork();
  ~LongWork();
  LongWork(const LongWork&) = delete;
  LongWork& operator=(const LongWork&) = delete;
};

}  // namespace couplet::log
