// SPDX-License-Identifier: Apache-2.0
#include "common/log/life.hpp"

#include <ctime>

namespace couplet::log {
namespace {

LifeSigns& listener() {
  static LifeSigns signs;
  return signs;
}

}  // namespace

void listen_for_life(LifeSigns signs) { listener() = signs; }

void alive() {
  if (listener().last == nullptr) return;
  timespec t{};
  ::clock_gettime(CLOCK_MONOTONIC, &t);
  *listener().last = double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

LongWork::LongWork() {
  alive();
  if (listener().long_work) ++*listener().long_work;
}

LongWork::~LongWork() {
  if (listener().long_work) --*listener().long_work;
  alive();
}

}  // namespace couplet::log
