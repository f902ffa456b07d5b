// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "coupler/exchange/side.hpp"
#include "coupler/mapping/links.hpp"
#include "coupler/parameters/parameters.hpp"
#include "coupler/parameters/schedule.hpp"

namespace couplet::coupler {

/// Throws SolveFailure on all ranks, naming datum, entry and place, if one of the values is not finite.
/// Collective.
void require_finite(MPI_Comm comm, const coupling::Exchange& data, const coupling::Interface& interface,
                    const std::vector<coupling::Interface::Datum>& of, const std::string& who);

/// What is wrong with two coupled surfaces that need not match, as far as their places tell.
struct PlaceReport {
  std::string problem;             ///< empty: none
  std::vector<std::string> notes;  ///< what the user should know
  bool nests = true;               ///< vertices of one side are vertices of the other
};
/// `from` gives motion to `to`: distances are judged against the local face size of both sides, the extents
/// against each other; several vertices that follow one (a staircase) are said. Collective.
PlaceReport judge_places(MPI_Comm comm, const Side& from, const Side& to);

/// Throws Error where a fluid that foresees its walls' answer (it takes its own data back) is asked before them: `group`
/// in the order of a pass.
void check_foreseen(const std::vector<Side>& sides, const Links& links, const Schedule& schedule,
                    const std::vector<std::size_t>& group);

/// judge_places() before the first step, for every giver of motion and its taker; throws Error.
void check_places(MPI_Comm comm, const std::vector<Side>& sides, const Links& links,
                  const MappingParameters& mapping);

}  // namespace couplet::coupler
