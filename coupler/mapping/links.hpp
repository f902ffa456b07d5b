// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "coupler/exchange/side.hpp"
#include "coupler/mapping/mapping.hpp"

namespace couplet::coupler {

/// Who gives what to whom among any number of participants: each datum that one takes comes from another that
/// gives a datum of the same name. Where several give it (two structures in one fluid), every place takes it
/// from the one that is nearest, and where several take an amount (N, W), every place gives it to the
/// nearest: the surfaces must be apart. Amounts are shared out with their sum kept, all else is carried
/// consistently. A datum whose name begins with "own-" a participant takes from itself: what it gave in the last
/// pass, accelerated with the rest of the unknown.
class Links {
 public:
  /// Throws Error if a datum is taken and given by nobody or by several in the same place, or if units or
  /// numbers of components differ. Collective.
  Links(MPI_Comm comm, const std::vector<Side>& sides, const MappingParameters& mapping);

  struct Link {
    std::size_t giver, taker;
    coupling::Interface::Datum datum;  ///< as given
    int components;
    coupling::Interface::Place to;           ///< where it is taken
    std::shared_ptr<const Mapping> mapping;  ///< shared by all data that go the same way
    bool whole = true;                       ///< between all places of both; false: some have other partners
    bool within = false;  ///< its values within the step go over, too: wanted, and of one giver
  };
  const std::vector<Link>& all() const { return links_; }

  /// What participant `taker` takes of what all have `given` so far; data that have not been given yet are
  /// left out. Values within the step go to those that asked for them. Collective.
  coupling::Exchange input(std::size_t taker, const std::vector<coupling::Exchange>& given) const;

  /// An amount on its way: sums over the places of giver and taker.
  struct Amount {
    std::string column;  ///< "tank gives force x [N]"
    double value = 0;
  };
  std::vector<Amount> amounts(const std::vector<coupling::Exchange>& given) const;

  /// One sentence a link, and data that nobody takes.
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  std::vector<double> carried(const Link& link, const std::string& name,
                              const std::vector<double>& values) const;
  MPI_Comm comm_;
  std::vector<std::string> names_;
  std::vector<std::vector<std::size_t>> entries_;  // by participant: vertices, faces of this rank
  std::vector<Link> links_;
  std::vector<std::string> notes_;
};

}  // namespace couplet::coupler
