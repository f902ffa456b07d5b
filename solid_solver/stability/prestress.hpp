// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/elasticity/finite/stress_stiffness.hpp"
#include "solid_solver/body/solid_fields.hpp"

namespace couplet::solid {

/// Of the linear solution that the fields hold, under the pressures at `time` (type: pressure), which follow the surface; tractions and
/// forces keep their direction. Collective.
elastic::Prestress prestress_of(const SolidBody& body, const SolidFields& fields, double time);

/// The largest compression in it [Pa], at least 0. Collective.
double compression(const mesh::Mesh& mesh, const elastic::Prestress& prestress);

/// Forces on the rows of ElasticOperator without symmetry, smooth and the same on any number of ranks: where a search for a soft motion
/// starts.
std::vector<double> any_start(const SolidBody& body);

}  // namespace couplet::solid
