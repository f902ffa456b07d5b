// SPDX-License-Identifier: Apache-2.0
#include "common/app/start_guard.hpp"

#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <csignal>
#include <iostream>
#include <mutex>
#include <sstream>

namespace couplet {

StartGuard::StartGuard(double seconds, std::string label) {
  if (!(seconds > 0)) return;
  guard_ = std::jthread([seconds, label = std::move(label)](const std::stop_token& stop) {
    sigset_t all;  // signals are for the main thread
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, nullptr);
    std::mutex mutex;
    std::condition_variable_any bell;
    std::unique_lock lock(mutex);
    bell.wait_for(lock, stop, std::chrono::duration<double>(seconds), [] { return false; });
    if (stop.stop_requested()) return;
    std::ostringstream text;
    text
        << "[" << label << "] error: the programs of this job have not all answered within " << seconds
        << " s of its start (simulation.hang-timeout): one of them hangs or was not started. The job ends.\n";
    std::cerr << text.str() << std::flush;
    ::_exit(1);  // the launcher ends the others, stopped ones too
  });
}

}  // namespace couplet
