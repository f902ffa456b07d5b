// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/quality.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/parallel/collective.hpp"

namespace couplet {
namespace {

/// Stays within the cell's bounding box however it is turned over; the centroid of a cell without volume does
/// not.
Vec3 mean_face_centre(const Mesh& mesh, const Geometry& geometry, Index cell) {
  Vec3 sum = Vec3::Zero();
  int n = 0;
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    if (mesh.owner[f] != cell && (f >= mesh.n_interior || mesh.neighbour[f] != cell)) continue;
    sum += geometry.face_centre[f];
    ++n;
  }
  return sum / n;
}

}  // namespace

MeshQuality measure_quality(const Mesh& mesh, const Geometry& geometry) {
  MeshQuality q{std::numeric_limits<double>::max(), -std::numeric_limits<double>::max(), 0, 0};
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    q.min_volume = std::min(q.min_volume, geometry.volume[c]);
    q.max_volume = std::max(q.max_volume, geometry.volume[c]);
  }
  for (Index f = 0; f < mesh.n_interior; ++f) {
    const Vec3& from = geometry.cell_centre[mesh.owner[f]];
    const Vec3 line = geometry.cell_centre[mesh.neighbour[f]] + mesh.shift(f) - from;
    const Vec3& area = geometry.face_area[f];
    const double along = line.dot(area), length = line.norm(), size = area.norm();
    if (length == 0 || size == 0) continue;
    const double cosine = std::clamp(along / (length * size), -1.0, 1.0);
    q.max_non_orthogonality = std::max(q.max_non_orthogonality, std::acos(cosine) * 180 / std::numbers::pi);
    if (along <= 0) continue;
    const Vec3 to_face = geometry.face_centre[f] - from;
    const Vec3 pierced = to_face.dot(area) / along * line;
    q.max_skewness = std::max(q.max_skewness, (to_face - pierced).norm() / length);
  }
  return {min(mesh.comm, q.min_volume), max(mesh.comm, q.max_volume), max(mesh.comm, q.max_non_orthogonality),
          max(mesh.comm, q.max_skewness)};
}

std::optional<CellTrouble> find_inverted(const Mesh& mesh, const Geometry& geometry) {
  CellTrouble worst{std::numeric_limits<GlobalIndex>::max(), Vec3::Zero(),
                    std::numeric_limits<double>::max()};
  const auto worse = [](const CellTrouble& a, const CellTrouble& b) {
    // A volume that is not a number is worse than any.
    const auto key = [](const CellTrouble& t) {
      return std::pair(std::isnan(t.volume) ? -std::numeric_limits<double>::infinity() : t.volume, t.cell_id);
    };
    return key(a) < key(b);
  };
  Index cell = -1;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    const CellTrouble here{mesh.cell_id[c], Vec3::Zero(), geometry.volume[c]};
    if (here.volume > 0 || !worse(here, worst)) continue;
    worst = here;
    cell = c;
  }
  if (cell >= 0) worst.centre = mean_face_centre(mesh, geometry, cell);
  if (!any(mesh.comm, !(worst.volume > 0))) return std::nullopt;
  const std::vector<CellTrouble> all = all_gather(mesh.comm, std::vector<CellTrouble>{worst});
  return *std::min_element(all.begin(), all.end(), worse);
}

}  // namespace couplet
