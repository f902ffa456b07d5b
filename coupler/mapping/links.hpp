// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "coupler/exchange/side.hpp"
#include "coupler/mapping/mapping.hpp"

namespace couplet::coupler {

/// Connections between any number of participants. A datum comes from another participant that gives one of
/// the same name. If several give it (two structures in one fluid), each place takes the nearest; if several
/// take an amount (N, W), each place gives it to the nearest. Their surfaces must not touch. Amounts keep
/// their sum; other data are mapped consistently. A datum named "own-..." is taken from the participant
/// itself: its value from the last pass, accelerated with the rest of the unknown.
class Links {
 public:
  /// Throws Error if a datum has no giver or several in the same place, or if units or numbers of components
  /// differ. Collective.
  Links(MPI_Comm comm, const std::vector<Side>& sides, const MappingParameters& mapping);

  struct Link {
    std::size_t giver, taker;
    coupling::Interface::Datum datum;  ///< as given
    int components;
    coupling::Interface::Place to;           ///< place where it is taken
    std::shared_ptr<const Mapping> mapping;  ///< shared by all data between the same places
    bool whole = true;    ///< between all places of both; false if some have other partners
    bool within = false;  ///< its values within the step are mapped, too: requested, and from one giver
  };
  const std::vector<Link>& all() const { return links_; }

  /// Input of participant `taker` from all data `given` so far; missing ones are omitted. Values within the
  /// step go to those that requested them. Collective.
  coupling::Exchange input(std::size_t taker, const std::vector<coupling::Exchange>& given) const;

  /// Transferred amount: sums over the places of giver and taker.
  struct Amount {
    std::string column;  ///< for example "tank gives force x [N]"
    double value = 0;
  };
  std::vector<Amount> amounts(const std::vector<coupling::Exchange>& given) const;

  /// One sentence per link, and one for data without a receiver.
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  std::vector<double> carried(const Link& link, const std::string& name,
                              const std::vector<double>& values) const;
  MPI_Comm comm_;
  std::vector<std::string> names_;
  // Numbers of this rank's vertices and faces, per participant.
  std::vector<std::vector<std::size_t>> entries_;
  std::vector<Link> links_;
  std::vector<std::string> notes_;
};

}  // namespace couplet::coupler
