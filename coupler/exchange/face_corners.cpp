// SPDX-License-Identifier: Apache-2.0
#include "coupler/exchange/transfer.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::coupler {
namespace {

/// Area of the polygon (2-D: of the edge, 1 m deep) with corners `first` to `last` - 1, in order.
Vec3 area_of(const std::vector<Vec3>& x, Index first, Index last, int dim) {
  const auto at = [&](Index k) -> const Vec3& { return x[std::size_t(k)]; };
  if (dim == 2) {
    const Vec3 edge = at(first + 1) - at(first);
    return {edge.y(), -edge.x(), 0};
  }
  Vec3 area = Vec3::Zero();
  for (Index k = first + 1; k + 1 < last; ++k) area += (at(k) - at(first)).cross(at(k + 1) - at(first)) / 2;
  return area;
}

}  // namespace

FaceCorners::FaceCorners(MPI_Comm comm, const Side& side)
    : dim_(side.interface.dim),
      n_vertices_(side.interface.vertices.size()),
      offset_(side.interface.face_offset),
      areas_(side.interface.face_areas) {
  const coupling::Interface& i = side.interface;
  const coupling::Starts corners = coupling::starts_of(
      parallel::all_gather(comm, std::vector<GlobalIndex>{GlobalIndex(i.face_vertices.size())}));
  known_ = corners.back() > 0;
  if (offset_.size() != areas_.size() + 1) offset_.assign(areas_.size() + 1, 0);
  const GlobalIndex first = corners[std::size_t(parallel::comm_rank(comm))];
  std::vector<Transfer::Entry> entries;
  for (std::size_t k = 0; k < i.face_vertices.size(); ++k)
    entries.push_back({first + GlobalIndex(k), i.face_vertices[k], 1});
  to_corners_ = Transfer(comm, corners, side.vertices, std::move(entries));
  std::vector<double> xyz;
  for (const Vec3& v : i.vertices) xyz.insert(xyz.end(), v.data(), v.data() + 3);
  const std::vector<double> at = to_corners_.apply(xyz, 3);
  for (std::size_t k = 0; k < at.size(); k += 3) points_.emplace_back(at[k], at[k + 1], at[k + 2]);
}

std::vector<double> FaceCorners::values(const std::vector<double>& at_vertices, int components) const {
  if (!at_vertices.empty()) return to_corners_.apply(at_vertices, components);
  return to_corners_.apply(std::vector<double>(n_vertices_ * std::size_t(components), 0.), components);
}

std::vector<Vec3> FaceCorners::areas(const std::vector<double>& displacement) const {
  const std::vector<double> moved = values(displacement, dim_);
  std::vector<Vec3> x = points_;
  for (std::size_t k = 0; k < x.size(); ++k)
    for (int c = 0; c < dim_; ++c) x[k][c] += moved[k * std::size_t(dim_) + std::size_t(c)];
  std::vector<Vec3> list;
  for (std::size_t f = 0; f < areas_.size(); ++f) {
    // The corners may be in either order around the face.
    const bool turned = area_of(points_, begin(f), end(f), dim_).dot(areas_[f]) < 0;
    const Vec3 area = area_of(x, begin(f), end(f), dim_);
    list.push_back(turned ? Vec3(-area) : area);
  }
  return list;
}

CavityWall::CavityWall(MPI_Comm comm, const Side& side, bool moves)
    : dim_(side.interface.dim),
      moves_(moves),
      n_values_(side.interface.vertices.size() * std::size_t(dim_)),
      corners_(comm, side) {
  if (!corners_.known())
    throw Error("'{}' does not provide the corners of its faces, so its volume is unknown.", side.name);
}

CavityWall::Flux CavityWall::flux(const std::vector<double>& velocity, const std::vector<Vec3>& areas) const {
  const std::vector<double> at = corners_.values(velocity, dim_);
  Flux flux;
  for (std::size_t f = 0; f < areas.size(); ++f) {
    double sum = 0;
    for (Index k = corners_.begin(f); k < corners_.end(f); ++k)
      for (int c = 0; c < dim_; ++c)
        sum += at[std::size_t(k) * std::size_t(dim_) + std::size_t(c)] * areas[f][c];
    sum /= double(corners_.end(f) - corners_.begin(f));
    flux.net += sum;
    flux.size += std::abs(sum);
  }
  return flux;
}

/// Simpson's rule, because S is quadratic along the path.
double CavityWall::swept(const std::vector<double>& from, const std::vector<double>& to) const {
  std::vector<double> way(n_values_, 0.), middle = way;
  for (std::size_t i = 0; i < way.size(); ++i) {
    const double a = from.empty() ? 0 : from[i], b = to.empty() ? 0 : to[i];
    way[i] = b - a, middle[i] = (a + b) / 2;
  }
  if (!moves_) return flux(way, areas({})).net;
  return (flux(way, areas(from)).net + 4 * flux(way, areas(middle)).net + flux(way, areas(to)).net) / 6;
}

}  // namespace couplet::coupler
