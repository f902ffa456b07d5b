// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "common/mesh/mesh.hpp"

namespace couplet::io {

/// Shape functions of a cell at one position, one per cell point in VTK order. They sum to one and
/// interpolate linear fields exactly.
struct ShapeValues {
  std::array<double, 8> weight{};
  std::array<Vec3, 8> gradient{};  ///< with respect to the reference coordinates
};
ShapeValues shape_functions(mesh::CellType type, const Vec3& reference);

/// Weights of the cell's points at `place`. Returns nothing if the position is outside the cell by more than
/// `slack` in reference coordinates, where a cell has about unit size. A triangle or quadrilateral lies in
/// the plane z = 0.
std::optional<std::array<double, 8>> weights_in_cell(mesh::CellType type, std::span<const Vec3> points,
                                                     const Vec3& place, double slack);

/// Finds the balls that contain a position. Their radii may differ widely, so each power of two of the radius
/// has a k-d tree of centers. Building takes n log n, a query log n plus the number of results.
class Balls {
 public:
  Balls(std::vector<Vec3> centres, std::vector<double> radii);
  ~Balls();
  Balls(Balls&&) noexcept;
  /// Balls within radius + slack of x in ascending order. A few others may be included.
  std::vector<Index> near(const Vec3& x, double slack) const;

 private:
  struct BallGroup;
  std::vector<std::unique_ptr<BallGroup>> groups_;
};

/// Diagonal of the bounding box of the reference mesh [m]. Collective.
double mesh_size(const mesh::Mesh& mesh, std::span<const Vec3> places);

/// Finds candidates for positions in the reference configuration: owned points, owned cells and boundary
/// faces of this rank. The mesh must outlive it. The constructor is collective.
class PlaceSearch {
 public:
  PlaceSearch(const mesh::Mesh& mesh, std::span<const Vec3> places);
  const mesh::Mesh& mesh() const { return mesh_; }
  std::span<const Vec3> places() const { return places_; }
  double size() const { return size_; }  ///< [m]
  /// Candidates within `slack` [m] of x in ascending order. A few others may be included.
  std::vector<Index> points(const Vec3& x, double slack) const { return points_.near(x, slack); }
  std::vector<Index> cells(const Vec3& x, double slack) const { return cells_.near(x, slack); }
  std::vector<Index> faces(const Vec3& x, double slack) const;

 private:
  const mesh::Mesh& mesh_;
  std::span<const Vec3> places_;
  double size_;
  Balls points_, cells_, faces_;
};

/// Shows the extents of the mesh among the results and warns about one in millimeters that is read in meters: some extent is above
/// 2 km, or all `places` of the YAML (probes) lie within 1/300 of its size. Collective.
void check_mesh_scale(const mesh::Mesh& mesh, std::span<const Vec3> points, std::span<const Vec3> places,
                      double mesh_scale);

}  // namespace couplet::io
