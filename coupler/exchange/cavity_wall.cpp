// SPDX-License-Identifier: Apache-2.0
#include "coupler/exchange/cavity_wall.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::coupler {

CavityWall::CavityWall(MPI_Comm comm, const Side& side, bool moves)
    : dim_(side.interface.dim),
      moves_(moves),
      n_vertices_(side.interface.vertices.size()),
      offset_(side.interface.face_offset),
      reference_(side.interface.face_areas) {
  const coupling::Interface& i = side.interface;
  const coupling::Starts corners = coupling::starts_of(
      parallel::all_gather(comm, std::vector<GlobalIndex>{GlobalIndex(i.face_vertices.size())}));
  if (corners.back() == 0)
    throw Error("'{}' does not provide the corners of its faces, so its volume is unknown.", side.name);
  if (offset_.size() != reference_.size() + 1) offset_.assign(reference_.size() + 1, 0);
  std::vector<Transfer::Entry> entries;
  for (std::size_t k = 0; k < i.face_vertices.size(); ++k)
    entries.push_back(
        {corners[std::size_t(parallel::comm_rank(comm))] + GlobalIndex(k), i.face_vertices[k], 1.});
  to_corners_ = Transfer(comm, corners, side.vertices, std::move(entries));
  std::vector<double> xyz;
  for (const Vec3& v : i.vertices) xyz.insert(xyz.end(), v.data(), v.data() + 3);
  const std::vector<double> at = to_corners_.apply(xyz, 3);
  for (std::size_t k = 0; 3 * k < at.size(); ++k)
    corners_.emplace_back(at[3 * k], at[3 * k + 1], at[3 * k + 2]);
}

std::vector<double> CavityWall::at_corners(const std::vector<double>& values) const {
  if (!values.empty()) return to_corners_.apply(values, dim_);
  return to_corners_.apply(std::vector<double>(n_vertices_ * std::size_t(dim_), 0.), dim_);
}

std::vector<Vec3> CavityWall::areas(const std::vector<double>& displacement) const {
  if (!moves_) return reference_;
  const std::vector<double> moved = at_corners(displacement);
  const auto corner = [&](Index k) {
    Vec3 x = corners_[std::size_t(k)];
    for (int c = 0; c < dim_; ++c) x[c] += moved[std::size_t(k) * std::size_t(dim_) + std::size_t(c)];
    return x;
  };
  std::vector<Vec3> list;
  for (std::size_t f = 0; f < reference_.size(); ++f) {
    const Index first = offset_[f], last = offset_[f + 1];
    Vec3 area = Vec3::Zero(), rest = Vec3::Zero();  // by the corners' order, displaced and not
    const auto x = [&](Index k) -> const Vec3& { return corners_[std::size_t(k)]; };
    if (dim_ == 2) {
      const Vec3 t = corner(first + 1) - corner(first), t0 = x(first + 1) - x(first);
      area = Vec3(t.y(), -t.x(), 0), rest = Vec3(t0.y(), -t0.x(), 0);
    } else {
      for (Index k = first + 1; k + 1 < last; ++k) {
        area += (corner(k) - corner(first)).cross(corner(k + 1) - corner(first)) / 2;
        rest += (x(k) - x(first)).cross(x(k + 1) - x(first)) / 2;
      }
    }
    list.push_back(rest.dot(reference_[f]) < 0 ? Vec3(-area) : area);
  }
  return list;
}

CavityWall::Flux CavityWall::flux(const std::vector<double>& velocity, const std::vector<Vec3>& areas) const {
  const std::vector<double> at = at_corners(velocity);
  Flux flux;
  for (std::size_t f = 0; f < areas.size(); ++f) {
    double sum = 0;
    for (Index k = offset_[f]; k < offset_[f + 1]; ++k)
      for (int c = 0; c < dim_; ++c)
        sum += at[std::size_t(k) * std::size_t(dim_) + std::size_t(c)] * areas[f][c];
    sum /= double(offset_[f + 1] - offset_[f]);
    flux.net += sum;
    flux.size += std::abs(sum);
  }
  return flux;
}

/// Simpson's rule: S is a parabola of the way.
double CavityWall::swept(const std::vector<double>& from, const std::vector<double>& to) const {
  std::vector<double> way(n_vertices_ * std::size_t(dim_), 0.), middle = way;
  for (std::size_t i = 0; i < way.size(); ++i) {
    const double a = from.empty() ? 0 : from[i], b = to.empty() ? 0 : to[i];
    way[i] = b - a, middle[i] = (a + b) / 2;
  }
  if (!moves_) return flux(way, reference_).net;
  return (flux(way, areas(from)).net + 4 * flux(way, areas(middle)).net + flux(way, areas(to)).net) / 6;
}

}  // namespace couplet::coupler
