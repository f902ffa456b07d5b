// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "common/mesh/mesh.hpp"

namespace couplet {

struct MeshQuality {
  double min_volume = 0, max_volume = 0;  ///< [m^3]
  /// Largest angle between a face vector and the line through the two cell centres [degree].
  double max_non_orthogonality = 0;
  /// Largest distance between the face centre and the point where that line pierces the face, over the line's
  /// length.
  double max_skewness = 0;
};

/// Collective; the same on all ranks.
MeshQuality measure_quality(const Mesh& mesh, const Geometry& geometry);

struct CellTrouble {
  GlobalIndex cell_id;
  Vec3 centre;    ///< mean of its face centres: an inverted cell has no centroid to speak of [m]
  double volume;  ///< [m^3]
};

/// The cell with the smallest volume if that is not positive (or not a number), else nothing. Collective; the
/// same answer on all ranks.
std::optional<CellTrouble> find_inverted(const Mesh& mesh, const Geometry& geometry);

}  // namespace couplet
