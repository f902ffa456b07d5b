// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "common/mesh/mesh.hpp"

namespace couplet::io {

/// Doubts a mesh in millimetres that is read in metres: its size is no body's, or all `places` of the YAML (probes) lie
/// within a three-hundredth of it. Collective.
void doubt_mesh_scale(const mesh::Mesh& mesh, std::span<const Vec3> points, std::span<const Vec3> places);

}  // namespace couplet::io
