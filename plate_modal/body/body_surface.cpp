// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/body/body_surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "common/base/error.hpp"
#include "common/base/text.hpp"

namespace couplet::plate {
namespace {

/// Throws Error for a patch that the mesh does not have.
void check_patches(const mesh::RawMesh& raw, const std::vector<std::string>& patches,
                   const std::string& key) {
  for (const std::string& patch : patches)
    if (std::ranges::find(raw.patches, patch) == raw.patches.end())
      throw Error("{}: the mesh has no patch '{}'; it has {}.", key, patch, base::join(raw.patches));
}

/// Cells at each point.
mesh::Csr cells_at_points(const mesh::RawMesh& raw) {
  std::vector<std::vector<Index>> at(raw.points.size());
  for (Index c = 0; c < raw.cell_points.size(); ++c)
    for (const Index p : raw.cell_points[c]) at[std::size_t(p)].push_back(c);
  mesh::Csr cells;
  for (const std::vector<Index>& one : at) cells.push_row(one);
  return cells;
}

/// Mean of the points of the cell that has all corners of a face.
Vec3 cell_behind(const mesh::RawMesh& raw, const mesh::Csr& cells_at, std::span<const Index> corners) {
  for (const Index cell : cells_at[corners[0]]) {
    const auto points = raw.cell_points[cell];
    if (!std::ranges::all_of(corners, [&](Index p) { return std::ranges::find(points, p) != points.end(); }))
      continue;
    Vec3 mean = Vec3::Zero();
    for (const Index p : points) mean += raw.points[std::size_t(p)] / double(points.size());
    return mean;
  }
  const Vec3& x = raw.points[std::size_t(corners[0])];
  throw Error("The mesh has no cell behind its boundary face at ({:g}, {:g}, {:g}).", x.x(), x.y(), x.z());
}

Vec3 area_of(std::span<const Index> corners, const std::vector<Vec3>& x) {
  if (corners.size() == 2) {  // 1 m deep
    const Vec3 along = x[std::size_t(corners[1])] - x[std::size_t(corners[0])];
    return {along.y(), -along.x(), 0};
  }
  Vec3 area = Vec3::Zero();
  const Vec3& first = x[std::size_t(corners[0])];
  for (std::size_t i = 2; i < corners.size(); ++i)
    area += 0.5 * (x[std::size_t(corners[i - 1])] - first).cross(x[std::size_t(corners[i])] - first);
  return area;
}

/// Volume behind the faces, about the mean of their centers.
double volume_behind(const BodySurface& surface) {
  Vec3 middle = Vec3::Zero();
  for (const Vec3& x : surface.centres) middle += x / double(surface.centres.size());
  double volume = 0;
  for (std::size_t f = 0; f < surface.areas.size(); ++f)
    volume += (surface.centres[f] - middle).dot(surface.areas[f]) / surface.dimension;
  return volume;
}

}  // namespace

coupling::Interface BodySurface::describe() const {
  coupling::Interface interface;
  interface.dim = dimension;
  interface.vertices = vertices;
  interface.face_centres = centres;
  interface.face_areas = areas;
  interface.face_offset = faces.offset;
  interface.face_vertices = faces.index;
  return interface;
}

BodySurface surface_of(const mesh::RawMesh& raw, const std::vector<std::string>& patches, int dimension,
                       const std::string& key) {
  if (raw.dim != dimension)
    throw Error("{}: the mesh has {} dimensions, but the body has {}: set 'body.dimension: {}'.", key,
                raw.dim, dimension, raw.dim);
  check_patches(raw, patches, key);
  BodySurface surface;
  surface.dimension = dimension;
  const mesh::Csr cells_at = cells_at_points(raw);
  std::vector<Index> number(raw.points.size(), -1);
  std::vector<Index> corners;
  for (Index b = 0; b < raw.boundary_points.size(); ++b) {
    const std::string& patch = raw.patches[std::size_t(raw.boundary_patch[std::size_t(b)])];
    if (std::ranges::find(patches, patch) == patches.end()) continue;
    corners.assign(raw.boundary_points[b].begin(), raw.boundary_points[b].end());
    Vec3 centre = Vec3::Zero();
    for (const Index p : corners) centre += raw.points[std::size_t(p)] / double(corners.size());
    if (area_of(corners, raw.points).dot(centre - cell_behind(raw, cells_at, corners)) < 0)
      std::ranges::reverse(corners);
    for (Index& p : corners) {
      Index& own = number[std::size_t(p)];
      if (own < 0) {
        own = Index(surface.vertices.size());
        surface.vertices.push_back(raw.points[std::size_t(p)]);
      }
      p = own;
    }
    surface.faces.push_row(corners);
    surface.centres.push_back(centre);
    surface.areas.push_back(area_of(corners, surface.vertices));
  }
  if (surface.areas.empty()) throw Error("{}: its patches have no faces.", key);
  surface.enclosed = volume_behind(surface);
  if (surface.enclosed >= 0) return surface;
  // The mesh is that of the fluid around the body, so its boundary points into the body.
  surface.enclosed = -surface.enclosed;
  for (Vec3& area : surface.areas) area = -area;
  for (Index f = 0; f < surface.faces.size(); ++f)
    std::reverse(surface.faces.index.begin() + surface.faces.offset[std::size_t(f)],
                 surface.faces.index.begin() + surface.faces.offset[std::size_t(f) + 1]);
  return surface;
}

}  // namespace couplet::plate
