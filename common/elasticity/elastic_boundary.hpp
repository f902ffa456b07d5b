// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/base/types.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet {

/// What is known at a boundary face of a solid.
enum class ElasticCondition : std::uint8_t {
  traction,    ///< the force is known, the displacement of the face is an unknown
  prescribed,  ///< the displacement is known at face and vertices; no unknown
  symmetry,    ///< no displacement across the plane, no shear on it; no unknown
  support,     ///< some components of the displacement are known, or springs hold the face (ElasticSupport)
  zero_gradient,  ///< n . grad u = 0, thesis (2.62); the displacement of the face is an unknown
  bonded,         ///< one side of a face between two materials; both sides share one unknown
};

/// A support with the projector P on the known directions and the spring stiffness k. With the known vector
/// g of the face (displacement along P, place of the far end of the springs across) and a traction T:
///   P (u_B - g) = 0,   (I - P) [sigma . n + k (u_B - g) - T] = 0
struct ElasticSupport {
  Tensor3 known = Tensor3::Zero();   ///< P, symmetric; I is better served by ElasticCondition::prescribed
  Tensor3 spring = Tensor3::Zero();  ///< k, symmetric [N/m^3]
  bool operator==(const ElasticSupport& other) const {
    return known == other.known && spring == other.spring;
  }
};

/// The condition of each local boundary face (entry of mesh.boundary, ghosts included).
struct ElasticBoundary {
  std::vector<ElasticCondition> condition;
  std::vector<Index> support_of_face;  ///< index into `supports`, -1: none; empty: no face is a support
  std::vector<ElasticSupport> supports;

  const ElasticSupport& support(Index entry) const { return supports[support_of_face[entry]]; }
};

/// One condition a patch, none of them a support. Faces between materials are bonded whatever is given for
/// their patch.
ElasticBoundary boundary_of_patches(const Mesh& mesh, std::span<const ElasticCondition> conditions);

}  // namespace couplet
