// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "common/mesh/mesh.hpp"

namespace couplet::mesh {

struct MeshQuality {
  double min_volume = 0, max_volume = 0;  ///< [m^3]
  /// Largest angle between a face vector and the line through the two cell centres [degree].
  double max_non_orthogonality = 0;
  /// Largest distance between the face centre and the point where that line pierces the face, over the line's
  /// length.
  double max_skewness = 0;
  /// Largest (longest edge) x (largest face) / volume: 1 for a cube, the ratio of length to thickness for a
  /// flat cell, 2.3 for an equilateral triangle.
  double max_aspect_ratio = 0;
  /// Where these are [m]: of the smallest volume, the angle, the skewness, the aspect ratio.
  Vec3 volume_at = Vec3::Zero(), angle_at = Vec3::Zero(), skewness_at = Vec3::Zero(),
       aspect_at = Vec3::Zero();
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

/// A cell whose boundary crosses itself though its volume is positive, if there is one: a quadrilateral two
/// of whose corners turn the other way, or a quadrilateral face both of whose diagonals cut it into triangles
/// that face each other. Collective; the same answer on all ranks.
std::optional<CellTrouble> find_crossed(const Mesh& mesh, const Geometry& geometry);

/// A cell that does not lie behind one of its faces, as seen from the cell (or boundary face) across: cells overlap, or one
/// is bent over. The lowest cell_id; `centre` is that of the face. Collective; the same answer on all ranks.
std::optional<CellTrouble> find_fold(const Mesh& mesh, const Geometry& geometry);

/// Refuses inverted and crossed cells (Error), then logs one line: cells, smallest volume, largest angle,
/// skewness and aspect ratio with their places. Collective.
void check_and_report(const Mesh& mesh, const Geometry& geometry);

}  // namespace couplet::mesh
