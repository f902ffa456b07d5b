// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/elasticity/solve/elastic_preconditioner.hpp"

namespace couplet::benchmark {

/// What ComponentMultigrid does, by a preconditioner of PETSc for each component (its options without a prefix). Collective.
elastic::ComponentCycle petsc_cycle(linalg::ComponentMultigrid::Rows rows,
                                    const linalg::ComponentMultigrid::Options& options);

}  // namespace couplet::benchmark
