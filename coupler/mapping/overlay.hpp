// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/coupling/participant.hpp"

namespace couplet::coupler {

/// The part of a face that a face of the other surface covers: integrals of the products of the corner functions
/// of the former over it [m^2] (2-D: [m]). These functions are 1 at their corner, linear along an edge (2-D) or
/// over the triangles of the face (more than three corners: about the mean of the corners).
struct Cover {
  Index other;
  Eigen::MatrixXd products;
};

/// How the faces of `other` among `candidates`, seen along the normal of `face`, cover it: those alone that look
/// against it and, where there are several layers, the nearest ones. What none covers goes to the nearest face. So
/// the products sum to those over all of the face, but for what a fold between faces hides or shows twice.
std::vector<Cover> covers(const coupling::Interface& surface, Index face, const coupling::Interface& other,
                          const std::vector<Index>& candidates);

}  // namespace couplet::coupler
