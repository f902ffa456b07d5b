// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "coupler/mapping/links.hpp"
#include "coupler/output/balance.hpp"

namespace couplet::coupler {

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
  std::vector<std::string> labels() const;
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
