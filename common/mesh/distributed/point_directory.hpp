// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mesh/distributed/shares.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::mesh {

/// Which ranks have cells at which points, kept by each rank for the points of its share.
class PointDirectory {
 public:
  /// `points`: of this rank's own cells, ascending. Collective.
  PointDirectory(MPI_Comm comm, const Shares& shares, const std::vector<GlobalIndex>& points);
  /// The ranks at each of these points, ascending both. Collective.
  Csr ranks_at(const std::vector<GlobalIndex>& points) const;

 private:
  MPI_Comm comm_;
  Shares shares_;
  GlobalIndex first_;
  Csr ranks_;
};

}  // namespace couplet::mesh
