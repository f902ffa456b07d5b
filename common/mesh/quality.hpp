// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "common/mesh/mesh.hpp"

namespace couplet::mesh {

struct MeshQuality {
  double min_volume = 0, max_volume = 0;  ///< [m^3]
  /// Largest angle between a face vector and the line through the two cell centers [degree].
  double max_non_orthogonality = 0;
  /// Largest distance between the face center and the intersection of that line with the face, relative to
  /// the length of the line.
  double max_skewness = 0;
  /// Largest (longest edge) x (largest face) / volume: 1 for a cube, length over thickness for a flat cell,
  /// 2.3 for an equilateral triangle.
  double max_aspect_ratio = 0;
  /// Locations [m] of the smallest volume, largest angle, skewness and aspect ratio.
  Vec3 volume_at = Vec3::Zero(), angle_at = Vec3::Zero(), skewness_at = Vec3::Zero(),
       aspect_at = Vec3::Zero();
};

/// Measures the mesh. Collective, with the same result on all ranks.
MeshQuality measure_quality(const Mesh& mesh, const Geometry& geometry);

struct CellTrouble {
  GlobalIndex cell_id;
  Vec3 centre;    ///< mean of the face centers, because an inverted cell has no centroid [m]
  double volume;  ///< [m^3]
};

/// Cell with the smallest volume if that is not positive or not a number, else nothing. Collective, with the
/// same result on all ranks.
std::optional<CellTrouble> find_inverted(const Mesh& mesh, const Geometry& geometry);

/// Cell whose boundary intersects itself although its volume is positive, if there is one. It is a
/// quadrilateral with two reversed corners, or has a quadrilateral face that folds along both diagonals.
/// Collective, with the same result on all ranks.
std::optional<CellTrouble> find_crossed(const Mesh& mesh, const Geometry& geometry);

/// Cell with the lowest cell_id that lies on the wrong side of one of its faces, so that cells overlap or
/// fold over. `centre` is that of the face. Collective, with the same result on all ranks.
std::optional<CellTrouble> find_fold(const Mesh& mesh, const Geometry& geometry);

/// Throws Error for inverted and crossed cells. Otherwise logs the number of cells, smallest volume, largest
/// angle, skewness and aspect ratio with their locations. Collective.
void check_and_report(const Mesh& mesh, const Geometry& geometry);

}  // namespace couplet::mesh
