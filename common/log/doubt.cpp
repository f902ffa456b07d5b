// SPDX-License-Identifier: Apache-2.0
#include "common/log/doubt.hpp"

#include "common/log/log.hpp"

namespace couplet::log {
namespace {

int& doubt_count() {
  static int count = 0;
  return count;
}

}  // namespace

void doubt(int rank, const std::string& text) {
  ++doubt_count();
  if (rank == 0) warn("{}", text);
}

int doubts() { return doubt_count(); }

}  // namespace couplet::log
