// SPDX-License-Identifier: Apache-2.0
// The first step of a run whose initial data have not all been given: nothing can be predicted, and the first
// pass takes what there is.
#include "common/parallel/collective.hpp"
#include "coupler/coupler.hpp"

namespace couplet::coupler {

/// True once all data of the unknown have been given, or if there are none. Collective, because a rank may have no
/// places.
bool Coupler::has_history() const {
  const bool known = !history_.now.unknown.empty() || !history_.now.dependent.empty();
  return unknown_->parts().empty() || parallel::any(comm_, known);
}

/// First pass without data.
Iterate Coupler::first_pass() { return pass_from(std::vector<coupling::Exchange>(pass_.partners().size())); }

}  // namespace couplet::coupler
