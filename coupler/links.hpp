// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "coupler/wiring.hpp"

namespace couplet {

/// Who gives what to whom among any number of participants: each datum that one takes comes from the one
/// other that gives a datum of the same name. Amounts (N, W) are shared out with their sum kept, all else is
/// taken from the nearest place.
class Links {
 public:
  /// Throws Error if a datum is taken and given by nobody or by several, or if units or numbers of components
  /// differ.
  Links(const std::vector<Side>& sides, const MappingParameters& mapping);

  /// What participant `taker` takes of what all have `given` so far; data that have not been given yet are
  /// left out.
  Exchange input(std::size_t taker, const std::vector<Exchange>& given) const;

  /// An amount on its way: sums over the places of giver and taker.
  struct Amount {
    std::string column;  ///< "tank gives force x [N]"
    double value = 0;
  };
  std::vector<Amount> amounts(const std::vector<Exchange>& given) const;

  /// Names of the data that participant `giver` gives and somebody takes.
  std::vector<std::string> given_by(std::size_t giver) const;

  /// One sentence a link.
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  struct Link {
    std::size_t giver, taker;
    Interface::Datum datum;
    int components;
    Mapping mapping;
  };
  std::vector<double> carried(const Link& link, const std::vector<Exchange>& given) const;
  std::vector<std::string> names_;
  std::vector<Link> links_;
  std::vector<std::string> notes_;
};

}  // namespace couplet
