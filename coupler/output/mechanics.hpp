// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "coupler/exchange/side.hpp"
#include "coupler/exchange/transfer.hpp"
#include "coupler/mapping/links.hpp"

namespace couplet::coupler {

/// Sums of the loads on one side of the interface.
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

/// Forces and work of one participant over a step.
struct SideBalance {
  std::string label;   ///< its role or name
  bool gives = false;  ///< it gives the load (a fluid); else it takes it
  Balance balance;
};

/// Those participants that give or take forces at walls that move: what a fluid's walls do and what the
/// structures take must be the same work. Each side's is its load times the way of its own wall: the fluid's
/// is where its last pass put it, which in the explicit scheme is the guess.
class Mechanics {
 public:
  /// `labels`: of each side, for columns.
  Mechanics(MPI_Comm comm, const std::vector<Side>& sides, const Links& links,
            std::vector<std::string> labels);

  bool empty() const { return members_.empty(); }
  /// Whether all sides tell the vertices of their faces, so that there is work to compare.
  bool knows_work() const { return knows_work_; }
  int dim() const { return dim_; }
  /// Balances of the accepted step from what each has given and taken; moves the walls. Collective.
  std::vector<SideBalance> accepted(const std::vector<coupling::Exchange>& given,
                                    const std::vector<coupling::Exchange>& taken);

  /// Displacement of each member's wall at t^n, for checkpoints.
  std::vector<std::vector<double>>& walls() { return walls_; }
  const std::vector<std::vector<double>>& walls() const { return walls_; }
  std::size_t side_of_wall(std::size_t i) const { return members_[i].side; }

 private:
  struct Member {
    std::size_t side;
    bool gives;  // the load
    Balancing balancing;
    std::vector<coupling::Interface::Datum> loads;
  };
  std::vector<Member> members_;
  std::vector<std::string> labels_;
  std::vector<std::vector<double>> walls_;
  bool knows_work_ = true;
  int dim_ = 3;
};

}  // namespace couplet::coupler
