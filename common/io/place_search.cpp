// SPDX-License-Identifier: Apache-2.0
#include "common/io/place_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nanoflann.hpp>
#include <span>

#include "common/parallel/collective.hpp"

namespace couplet {
namespace {

struct Cloud {
  std::vector<Vec3> points;
  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t d) const { return points[i][Eigen::Index(d)]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using Tree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 3, Index>;

/// Everything within a radius, in the form that nanoflann fills.
struct Within {
  double square;
  std::vector<Index> found;
  std::size_t size() const { return found.size(); }
  bool full() const { return true; }
  bool addPoint(double distance, Index i) {
    if (distance <= square) found.push_back(i);
    return true;
  }
  double worstDist() const { return std::nextafter(square, INFINITY); }
};

}  // namespace

struct Balls::Group {
  double radius = 0;  // largest
  Cloud cloud{};
  std::vector<Index> number{};
  std::unique_ptr<Tree> tree{};
};

Balls::Balls(std::vector<Vec3> centres, std::vector<double> radii) {
  std::map<int, std::unique_ptr<Group>> by_size;
  for (std::size_t i = 0; i < centres.size(); ++i) {
    auto& group = by_size[radii[i] > 0 ? std::ilogb(radii[i]) : -10000];
    if (!group) group = std::make_unique<Group>();
    group->radius = std::max(group->radius, radii[i]);
    group->cloud.points.push_back(centres[i]);
    group->number.push_back(static_cast<Index>(i));
  }
  for (auto& [size, group] : by_size) {
    group->tree = std::make_unique<Tree>(3, group->cloud, nanoflann::KDTreeSingleIndexAdaptorParams(10));
    group->tree->buildIndex();
    groups_.push_back(std::move(group));
  }
}
Balls::~Balls() = default;
Balls::Balls(Balls&&) noexcept = default;

std::vector<Index> Balls::near(const Vec3& x, double slack) const {
  std::vector<Index> all;
  for (const auto& group : groups_) {
    const double reach = group->radius * (1 + 1e-6) + slack;
    Within within{reach * reach, {}};
    group->tree->radiusSearchCustomCallback(x.data(), within);
    for (const Index i : within.found) all.push_back(group->number[i]);
  }
  std::ranges::sort(all);
  return all;
}

namespace {

/// About the mean of some points.
void add_ball(const Mesh& mesh, std::span<const Index> points, std::vector<Vec3>& centres,
              std::vector<double>& radii) {
  Vec3 centre = Vec3::Zero();
  for (const Index p : points) centre += mesh.reference_points[p] / double(points.size());
  double radius = 0;
  for (const Index p : points) radius = std::max(radius, (mesh.reference_points[p] - centre).norm());
  centres.push_back(centre);
  radii.push_back(radius);
}

Balls point_balls(const Mesh& mesh) {
  const auto n = mesh.points.n_owned();
  return {{mesh.reference_points.begin(), mesh.reference_points.begin() + n}, std::vector<double>(n, 0.0)};
}

Balls cell_balls(const Mesh& mesh) {
  std::vector<Vec3> centres;
  std::vector<double> radii;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) add_ball(mesh, mesh.cell_points[c], centres, radii);
  return {std::move(centres), std::move(radii)};
}

Balls face_balls(const Mesh& mesh) {
  std::vector<Vec3> centres;
  std::vector<double> radii;
  for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f)
    add_ball(mesh, mesh.face_points[f], centres, radii);
  return {std::move(centres), std::move(radii)};
}

}  // namespace

double mesh_size(const Mesh& mesh) {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()),
       high = Vec3::Constant(-std::numeric_limits<double>::infinity());
  for (const Vec3& p : mesh.reference_points) low = low.cwiseMin(p), high = high.cwiseMax(p);
  MPI_Allreduce(MPI_IN_PLACE, low.data(), 3, MPI_DOUBLE, MPI_MIN, mesh.comm);
  MPI_Allreduce(MPI_IN_PLACE, high.data(), 3, MPI_DOUBLE, MPI_MAX, mesh.comm);
  return (high - low).norm();
}

PlaceSearch::PlaceSearch(const Mesh& mesh)
    : mesh_(mesh),
      size_(mesh_size(mesh)),
      points_(point_balls(mesh)),
      cells_(cell_balls(mesh)),
      faces_(face_balls(mesh)) {}

std::vector<Index> PlaceSearch::faces(const Vec3& x, double slack) const {
  std::vector<Index> faces = faces_.near(x, slack);
  for (Index& f : faces) f += mesh_.n_interior;
  return faces;
}

}  // namespace couplet
