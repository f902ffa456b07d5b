// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include "common/diagnostics/diagnostics.hpp"

namespace couplet::app {

/// Judges what the case gives by what it did in the run (fv::uses): loads, inlets, bodies and tables that never
/// acted, values that no step sees, and those outside a table or the usual range.
diagnostics::Made use_of_case(MPI_Comm comm);

}  // namespace couplet::app
