// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/analysis/reconstruction.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

#include "common/elasticity/vector_at.hpp"
#include "common/mesh/topology.hpp"

namespace couplet::solid {
namespace {

constexpr int curvatures = 6;                       // second derivatives of a component
constexpr int values_of_cell = 3 * curvatures + 3;  // second derivatives, and their place

}  // namespace

Reconstruction::Reconstruction(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows,
                               const SolidState& state)
    : mesh_(mesh),
      rows_(rows),
      state_(state),
      cells_of_point_(mesh::transpose(mesh_.cell_points, 0, mesh_.points.n_local())),
      boundary_faces_(boundary_faces_of_cells(mesh_)),
      mark_(std::size_t(mesh_.cells.n_local()), -1),
      curvature_(std::size_t(mesh_.cells.n_local()) * values_of_cell, 0.0) {
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    gather(c);
    keep(c, fit(samples_).curvature);
  }
  mesh_.cells.update_ghosts(curvature_, values_of_cell);
  std::ranges::fill(mark_, -1);
}

Cubic Reconstruction::fitted(Index cell) {
  gather(cell);
  Cubic known;
  known.cubes = cubes_of(cell);
  for (Sample& s : samples_) s.u -= known.cubic_part(s.x);
  Cubic cubic = fit(samples_);
  cubic.cubes = known.cubes;
  return cubic;
}

Cubic Reconstruction::fit(const std::vector<Sample>& samples) {
  Cubic cubic;
  double reach = 0;
  for (const Sample& s : samples) reach = std::max(reach, s.x.squaredNorm());
  cubic.value = samples.front().u;
  if (!(reach > 0)) return cubic;
  const int dim = mesh_.dim;
  const double inverse = 1 / std::sqrt(reach);
  quadratic_.start(dim, 3, Vec3::Zero(), 1 / inverse);
  for (const Sample& s : samples) quadratic_.add_near(s.x, {s.u.data(), 3});
  quadratic_.solve_near();
  const QuadraticFit::Row& c = quadratic_.coefficients();
  cubic.value = c.row(0);
  for (int j = 0; j < dim; ++j)
    for (int a = 0, i = 1 + dim; a < dim; ++a) {
      cubic.slope(a, j) = inverse * c(1 + a, j);
      for (int b = a; b < dim; ++b, ++i) {
        Tensor3& h = cubic.curvature[std::size_t(j)];
        h(a, b) = h(b, a) = (a == b ? 2 : 1) * inverse * inverse * c(i, j);
      }
    }
  return cubic;
}

void Reconstruction::keep(Index cell, const std::array<Tensor3, 3>& curvature) {
  double* to = curvature_.data() + std::size_t(cell) * values_of_cell;
  for (const Tensor3& h : curvature) {
    const PackedTensor packed = pack(h);
    to = std::copy(packed.begin(), packed.end(), to);
  }
  Vec3 middle = Vec3::Zero();
  for (const Sample& s : samples_) middle += s.x / double(samples_.size());
  const Vec3 place = rows_.geometry().cell_centre[cell] + middle;
  std::ranges::copy(place, to);
}

void Reconstruction::gather(Index cell) {
  patch_.clear();
  gather_cells(mesh_, cells_of_point_, cell, mark_, patch_);
  samples_.clear();
  const mesh::Geometry& g = rows_.geometry();
  const Vec3 centre = g.cell_centre[cell];
  std::vector<MirrorPlane> mirrors;
  for (const Index f : boundary_faces_[cell])
    if (rows_.mirrored(f)) add_mirror(g, f, mirrors);
  const auto add = [&](const Vec3& x, const Vec3& u) {
    samples_.push_back({x - centre, u});
    for (const MirrorPlane& m : mirrors) samples_.push_back({m.image(x) - centre, m.reflect(u)});
  };
  for (const Index c : patch_) {
    add(g.cell_centre[c], elastic::vector_at(state_.cell_u, c, mesh_.dim));
    for (const Index f : boundary_faces_[c])
      if (!rows_.mirrored(f))
        add(g.face_centre[f], elastic::vector_at(state_.face_u, f - mesh_.n_interior, mesh_.dim));
  }
}

/// Third derivatives by the slopes of the neighbors' second ones, which are those at the middle of their samples.
std::array<std::array<double, 10>, 3> Reconstruction::cubes_of(Index cell) const {
  using Values = Eigen::Matrix<double, 1, 3 * curvatures>;
  const auto values = [&](Index c) {
    return Eigen::Map<const Values>(curvature_.data() + std::size_t(c) * values_of_cell);
  };
  const std::vector<Vec3>& centre = rows_.geometry().cell_centre;
  Eigen::Matrix3d of = Eigen::Matrix3d::Zero();
  std::array<Values, 3> right{Values::Zero(), Values::Zero(), Values::Zero()};
  for (const Index c : patch_) {
    const Vec3 x = place(c) - place(cell);
    const double far = (centre[c] - centre[cell]).squaredNorm();
    if (c == cell || !(far > 0)) continue;
    const Vec3 weighted = x / far;  // the places of two cells across a body coincide
    of += weighted * x.transpose();
    const Values change = values(c) - values(cell);
    for (int i = 0; i < 3; ++i) right[std::size_t(i)] += weighted[i] * change;
  }
  of.diagonal().array() += 1e-6 * of.trace() + 1e-300;
  const Eigen::Matrix3d inverse = of.inverse();
  std::array<Values, 3> slope;
  for (int i = 0; i < 3; ++i)
    slope[std::size_t(i)] = inverse(i, 0) * right[0] + inverse(i, 1) * right[1] + inverse(i, 2) * right[2];
  std::array<std::array<double, 10>, 3> cubes;
  for (int j = 0; j < 3; ++j) {
    enum Packed { xx, yy, zz, xy, yz, xz };
    const auto along = [&](std::size_t axis, Packed of_what) {
      return slope[axis][j * curvatures + int(of_what)] / 6;
    };
    cubes[std::size_t(j)] = {along(0, xx),
                             along(1, xx) + 2 * along(0, xy),
                             along(2, xx) + 2 * along(0, xz),
                             along(0, yy) + 2 * along(1, xy),
                             2 * (along(0, yz) + along(1, xz) + along(2, xy)),
                             along(0, zz) + 2 * along(2, xz),
                             along(1, yy),
                             along(2, yy) + 2 * along(1, yz),
                             along(1, zz) + 2 * along(2, yz),
                             along(2, zz)};
  }
  return cubes;
}

Vec3 Reconstruction::place(Index cell) const {
  return Vec3(curvature_.data() + std::size_t(cell) * values_of_cell + 3 * curvatures);
}

}  // namespace couplet::solid
