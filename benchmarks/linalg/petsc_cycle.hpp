// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/elasticity/solve/elastic_preconditioner.hpp"

namespace couplet::benchmark {

/// Replaces ComponentMultigrid by a PETSc preconditioner per component (options without prefix). Collective.
elastic::ComponentCycle petsc_cycle(linalg::ComponentMultigrid::Rows rows,
                                    const linalg::ComponentMultigrid::MultigridOptions& options);

}  // namespace couplet::benchmark
