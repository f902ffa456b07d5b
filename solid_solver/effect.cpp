// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/effect.hpp"

namespace couplet {

std::vector<std::unique_ptr<SolidEffect>> make_effects(const Mesh&, const ElasticOperator&,
                                                       const SolidParameters&) {
  return {};
}

}  // namespace couplet
