// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <optional>
#include <span>

#include "common/base/types.hpp"
#include "common/diagnostics/finding.hpp"

namespace couplet::diagnostics {

/// Finding about a fluid's forces [N] that are one even pressure, about that of the atmosphere, on faces that neither surround
/// a body nor lie on opposite sides of it. `force`: `dim` values per face; faces without a force do not count. `area` [m^2]: out of the
/// body. Collective over `comm`, over whose ranks the faces are distributed.
std::optional<Finding> atmosphere_on_one_side(MPI_Comm comm, int dim, std::span<const double> force,
                                              std::span<const Vec3> area, std::span<const Vec3> centre);

}  // namespace couplet::diagnostics
