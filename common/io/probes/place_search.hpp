// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "common/mesh/mesh.hpp"

namespace couplet::io {

/// Values of the shape functions of a cell at one place, one a cell point in VTK order. They sum to one and,
/// summed over the points' coordinates, give the place: so they interpolate linear fields exactly.
struct ShapeValues {
  std::array<double, 8> weight{};
  std::array<Vec3, 8> gradient{};  ///< by the reference coordinates
};
ShapeValues shape_functions(mesh::CellType type, const Vec3& reference);

/// The weights of the cell's points at `place`, or nothing when the place is outside the cell by more than
/// `slack` (in reference coordinates, where the cell has about unit size). A triangle or quadrilateral is
/// taken in the plane z = 0.
std::optional<std::array<double, 8>> weights_in_cell(mesh::CellType type, std::span<const Vec3> points,
                                                     const Vec3& place, double slack);

/// Balls of very different sizes, asked for those that hold a place: k-d trees of their centres, one for
/// each power of two of the radius. n log n to build; log n a question and what it finds.
class Balls {
 public:
  Balls(std::vector<Vec3> centres, std::vector<double> radii);
  ~Balls();
  Balls(Balls&&) noexcept;
  /// Those within radius + slack of x, in ascending order, and perhaps some more.
  std::vector<Index> near(const Vec3& x, double slack) const;

 private:
  struct Group;
  std::vector<std::unique_ptr<Group>> groups_;
};

/// Diagonal of the box around the reference mesh [m]. Collective.
double mesh_size(const mesh::Mesh& mesh, std::span<const Vec3> places);

/// What of a mesh in its reference configuration may hold a place, for many places: owned points, owned cells,
/// boundary faces of this rank. The mesh must outlive it. Making one is collective.
class PlaceSearch {
 public:
  PlaceSearch(const mesh::Mesh& mesh, std::span<const Vec3> places);
  const mesh::Mesh& mesh() const { return mesh_; }
  std::span<const Vec3> places() const { return places_; }
  double size() const { return size_; }  ///< [m]
  /// Within `slack` [m] of x, ascending, and perhaps some more.
  std::vector<Index> points(const Vec3& x, double slack) const { return points_.near(x, slack); }
  std::vector<Index> cells(const Vec3& x, double slack) const { return cells_.near(x, slack); }
  std::vector<Index> faces(const Vec3& x, double slack) const;

 private:
  const mesh::Mesh& mesh_;
  std::span<const Vec3> places_;
  double size_;
  Balls points_, cells_, faces_;
};

/// Doubts a mesh in millimetres that is read in metres: its size is no body's, or all `places` of the YAML (probes) lie
/// within a three-hundredth of it. Collective.
void doubt_mesh_scale(const mesh::Mesh& mesh, std::span<const Vec3> points, std::span<const Vec3> places);

}  // namespace couplet::io
