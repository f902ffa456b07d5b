// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <string>
#include <vector>

#include "coupler/exchange/side.hpp"

namespace couplet::coupler {

/// Watches for structures that are loaded and do not move at all: their interface is held, or the load does not arrive.
/// However stiff a structure is, a load moves it by more than nothing.
class StillGuard {
 public:
  StillGuard(MPI_Comm comm, const std::vector<Side>& sides);
  /// After an accepted step: a sentence for each structure that a load has left in its place, to the last bit, for
  /// `patience` steps in a row; once each. Collective.
  std::vector<std::string> accepted(const std::vector<coupling::Exchange>& given,
                                    const std::vector<coupling::Exchange>& taken);

  static constexpr int patience = 10;  ///< steps

 private:
  struct Structure {
    std::size_t side;
    std::string name;
    std::vector<std::string> loads;
    std::string unit;  // of one of them, for the message
    int steps = 0;     // in a row, under load and without motion
    bool told = false;
  };
  MPI_Comm comm_;
  std::vector<Structure> structures_;
};

}  // namespace couplet::coupler
