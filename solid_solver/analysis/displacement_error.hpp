// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solid_solver/body/solid_body.hpp"
#include "solid_solver/body/solid_state.hpp"

namespace couplet::solid {

/// Estimates the error e of the displacement of a linear static body by its mesh, root mean square over the body relative to the
/// displacement; NaN without one. By defect correction [stetter1978], K e = r with the residual of a smooth reconstruction w,
///   r . v = int b . v + int t . v - int sigma(w) : eps(v)
/// for test functions v that are linear in the parts (cell center, face center, edge) of all cells. In each cell w is a cubic: a
/// quadratic by least squares over the cells that share a vertex, whose third derivatives are the slopes of the neighbors' second
/// ones. The operator's own residual is zero, so r is the error of its integrals. Half of e counts, because w has an error like that
/// of the operator, which doubles e on smooth fields. The error of interpolation between the unknowns adds.
/// `loads` as in the last solve. Requires the symmetric kernel. Throws SolveFailure. Collective.
double displacement_error(const SolidBody& body, const SolidState& state, const elastic::ElasticLoads& loads,
                          SolutionMethod& method);

}  // namespace couplet::solid
