// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <unordered_map>
#include <vector>

#include "common/base/error.hpp"
#include "common/mesh/inp/inp_deck.hpp"
#include "common/mesh/load.hpp"

namespace couplet::mesh {

/// A mesh on its way from the deck.
struct InpBody {
  InpLines& lines;
  InpDeck deck;
  RawMesh raw;
  std::unordered_map<std::int64_t, Index> cell_of_element;
  std::vector<const InpElements::Element*> elements;  ///< per cell
  std::int64_t work = 300000000;                      ///< members of ranges that may still be looked at

  /// Calls use(number in `index`) for the members that are there. Throws Error where a crafted deck has too many.
  template <class Use>
  void visit(const std::vector<InpRange>& members, const std::unordered_map<std::int64_t, Index>& index,
             const Use& use);
};

/// Numbers of names whose case does not count.
class InpNames {
 public:
  /// Appended to `names` where it is new.
  int number_of(std::vector<std::string>& names, const std::string& name);
  bool contains(const std::string& name) const { return numbers_.contains(upper(name)); }

 private:
  std::map<std::string, int> numbers_;
};

/// Gives every boundary face of the cells its patch: by *SURFACE, by elements of one dimension less with an ELSET, by the smallest
/// NSET that has all its nodes; the patch "rest" is what is left. Returns how many faces of surfaces lie between two cells.
/// Throws Error.
std::size_t name_patches(InpBody& body);

template <class Use>
void InpBody::visit(const std::vector<InpRange>& members,
                    const std::unordered_map<std::int64_t, Index>& index, const Use& use) {
  if (!for_each_member(members, index, work, use))
    throw Error("{}: the sets of this deck have too many members.", lines.place());
}

}  // namespace couplet::mesh
