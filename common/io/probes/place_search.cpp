// SPDX-License-Identifier: Apache-2.0
#include "common/io/probes/place_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>

#include "common/base/point_tree.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::io {

struct Balls::Group {
  double radius = 0;  // largest
  std::vector<Vec3> centres{};
  std::vector<Index> number{};
  std::unique_ptr<base::PointTree> tree{};
};

Balls::Balls(std::vector<Vec3> centres, std::vector<double> radii) {
  std::map<int, std::unique_ptr<Group>> by_size;
  for (std::size_t i = 0; i < centres.size(); ++i) {
    auto& group = by_size[radii[i] > 0 ? std::ilogb(radii[i]) : -10000];
    if (!group) group = std::make_unique<Group>();
    group->radius = std::max(group->radius, radii[i]);
    group->centres.push_back(centres[i]);
    group->number.push_back(static_cast<Index>(i));
  }
  for (auto& [size, group] : by_size) {
    group->tree = std::make_unique<base::PointTree>(group->centres);
    groups_.push_back(std::move(group));
  }
}
Balls::~Balls() = default;
Balls::Balls(Balls&&) noexcept = default;

std::vector<Index> Balls::near(const Vec3& x, double slack) const {
  std::vector<Index> all;
  for (const auto& group : groups_)
    for (const Index i : group->tree->within(x, group->radius * (1 + 1e-6) + slack))
      all.push_back(group->number[i]);
  std::ranges::sort(all);
  return all;
}

namespace {

/// About the mean of some points.
void add_ball(std::span<const Vec3> places, std::span<const Index> points, std::vector<Vec3>& centres,
              std::vector<double>& radii) {
  Vec3 centre = Vec3::Zero();
  for (const Index p : points) centre += places[p] / double(points.size());
  double radius = 0;
  for (const Index p : points) radius = std::max(radius, (places[p] - centre).norm());
  centres.push_back(centre);
  radii.push_back(radius);
}

Balls point_balls(const mesh::Mesh& mesh, std::span<const Vec3> places) {
  const auto n = mesh.points.n_owned();
  return {{places.begin(), places.begin() + n}, std::vector<double>(n, 0.0)};
}

Balls cell_balls(const mesh::Mesh& mesh, std::span<const Vec3> places) {
  std::vector<Vec3> centres;
  std::vector<double> radii;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) add_ball(places, mesh.cell_points[c], centres, radii);
  return {std::move(centres), std::move(radii)};
}

Balls face_balls(const mesh::Mesh& mesh, std::span<const Vec3> places) {
  std::vector<Vec3> centres;
  std::vector<double> radii;
  for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f)
    add_ball(places, mesh.face_points[f], centres, radii);
  return {std::move(centres), std::move(radii)};
}

}  // namespace

double mesh_size(const mesh::Mesh& mesh, std::span<const Vec3> places) {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()),
       high = Vec3::Constant(-std::numeric_limits<double>::infinity());
  for (const Vec3& p : places) low = low.cwiseMin(p), high = high.cwiseMax(p);
  MPI_Allreduce(MPI_IN_PLACE, low.data(), 3, MPI_DOUBLE, MPI_MIN, mesh.comm);
  MPI_Allreduce(MPI_IN_PLACE, high.data(), 3, MPI_DOUBLE, MPI_MAX, mesh.comm);
  return (high - low).norm();
}

PlaceSearch::PlaceSearch(const mesh::Mesh& mesh, std::span<const Vec3> places)
    : mesh_(mesh),
      places_(places),
      size_(mesh_size(mesh, places)),
      points_(point_balls(mesh, places)),
      cells_(cell_balls(mesh, places)),
      faces_(face_balls(mesh, places)) {}

std::vector<Index> PlaceSearch::faces(const Vec3& x, double slack) const {
  std::vector<Index> faces = faces_.near(x, slack);
  for (Index& f : faces) f += mesh_.n_interior;
  return faces;
}

}  // namespace couplet::io
