// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "coupler/exchange/side.hpp"
#include "coupler/exchange/transfer.hpp"

namespace couplet::coupler {

/// What the loads on one side of the interface add up to.
struct Balance {
  Vec3 force = Vec3::Zero();   ///< [N]
  Vec3 moment = Vec3::Zero();  ///< about the origin, on the reference configuration [N m]
  double work = 0;             ///< over the step [J]
};

/// Sums the forces (data in N at faces or vertices) of one side and the work they do along the way of the vertices, or
/// of the faces, which is the mean of their vertices'.
class Balancing {
 public:
  /// Throws Error if a face names a vertex that there is not. Collective.
  Balancing(MPI_Comm comm, const Side& side);
  /// False if the side does not say which vertices its faces have: there is no work of forces at faces then.
  bool knows_work() const { return knows_work_; }
  /// `data`: this rank's values of `of`; `increment`: dim values at each of its vertices, the way of the step
  /// [m]. The same on all ranks. Collective.
  Balance operator()(const coupling::Exchange& data, const std::vector<coupling::Interface::Datum>& of,
                     const std::vector<double>& increment) const;

 private:
  MPI_Comm comm_;
  int dim_;
  std::vector<Vec3> centres_, vertices_;
  bool knows_work_ = false;
  Transfer to_faces_;  // means over the faces
};

}  // namespace couplet::coupler
