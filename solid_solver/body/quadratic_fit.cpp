// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/body/quadratic_fit.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/mesh/topology.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::solid {

namespace {

// Relative to the sum of the weights; in units of the scale, a good sample contributes about 0.1.
constexpr double least_curvature = 1e-4, least_slope = 1e-12;

}  // namespace

void QuadraticFit::start(int dim, int components, const Vec3& centre, double scale) {
  dim_ = dim, centre_ = centre, scale_ = scale, weights_ = 0, n_samples_ = n_rows_ = 0;
  samples_.resize(n_terms() + components, std::max<Eigen::Index>(samples_.cols(), 64));
  rows_.resize(n_terms() * components + 1, std::max<Eigen::Index>(rows_.cols(), 64));
}

QuadraticFit::Terms QuadraticFit::terms(const Vec3& place, const Tensor3& moment) const {
  const Vec3 x = (place - centre_) / scale_;
  Terms phi(n_terms());
  int i = 0;
  phi[i++] = 1;
  for (int a = 0; a < dim_; ++a) phi[i++] = x[a];
  for (int a = 0; a < dim_; ++a)
    for (int b = a; b < dim_; ++b) phi[i++] = x[a] * x[b] + moment(a, b) / (scale_ * scale_);
  return phi;
}

QuadraticFit::Slopes QuadraticFit::slopes(const Vec3& place) const {
  const Vec3 x = (place - centre_) / scale_;
  Slopes slope = Slopes::Zero(n_terms(), 3);
  int i = 1;
  for (int a = 0; a < dim_; ++a) slope(i++, a) = 1;
  for (int a = 0; a < dim_; ++a)
    for (int b = a; b < dim_; ++b, ++i) slope(i, a) += x[b], slope(i, b) += x[a];
  return slope / scale_;
}

void QuadraticFit::add_sample(const Vec3& place, const Tensor3& moment, std::span<const double> values,
                              double weight) {
  if (n_samples_ == samples_.cols()) samples_.conservativeResize(Eigen::NoChange, 2 * n_samples_);
  weights_ += weight;
  const double root = std::sqrt(weight);
  auto column = samples_.col(n_samples_++);
  const Terms phi = terms(place, moment);
  for (Eigen::Index i = 0; i < phi.size(); ++i) column[i] = root * phi[i];
  for (Eigen::Index k = n_terms(); k < column.size(); ++k)
    column[k] = root * values[std::size_t(k - n_terms())];
}

void QuadraticFit::add_row(const Row& row, double value, double weight) {
  if (n_rows_ == rows_.cols()) rows_.conservativeResize(Eigen::NoChange, 2 * n_rows_);
  const double root = std::sqrt(weight);
  rows_.col(n_rows_++) << root * row.reshaped(), root * value;
}

void QuadraticFit::solve() {
  const Eigen::Index n = n_terms(), components = samples_.rows() - n;
  const auto of = samples_.topLeftCorner(n, n_samples_);
  of_samples_.setZero(n, n);
  of_samples_.selfadjointView<Eigen::Lower>().rankUpdate(of);
  for (Eigen::Index i = 0; i < n; ++i)
    of_samples_(i, i) += weights_ * (i > dim_ ? least_curvature : i > 0 ? least_slope : 0);
  coefficients_ = of * samples_.bottomLeftCorner(components, n_samples_).transpose();
  if (n_rows_ == 0) return of_samples_.llt().solveInPlace(coefficients_);
  const auto coupled = rows_.topLeftCorner(n * components, n_rows_);
  of_rows_.setZero(n * components, n * components);
  for (Eigen::Index k = 0; k < components; ++k) of_rows_.block(k * n, k * n, n, n) = of_samples_;
  of_rows_.selfadjointView<Eigen::Lower>().rankUpdate(coupled);
  Eigen::VectorXd right = coefficients_.reshaped();
  right += coupled * rows_.row(n * components).head(n_rows_).transpose();
  coefficients_ = of_rows_.llt().solve(right).reshaped(n, components);
}

namespace {

/// Weight of the mean over vertices in the volume mean: exact for simplices and boxes.
double share_of_vertices(mesh::CellType type) {
  switch (type) {
    case mesh::CellType::triangle:
      return 1. / 4;
    case mesh::CellType::tetrahedron:
      return 1. / 5;
    case mesh::CellType::prism:
    case mesh::CellType::pyramid:
      return 7. / 24;
    default:
      return 1. / 3;
  }
}

}  // namespace

Tensor3 cell_moment(const mesh::Mesh& mesh, const mesh::Geometry& geometry, Index cell) {
  Tensor3 moment = Tensor3::Zero();
  for (const Index v : mesh.cell_points[cell]) {
    const Vec3 arm = geometry.points[v] - geometry.cell_centre[cell];
    moment += arm * arm.transpose();
  }
  return moment * (share_of_vertices(mesh.cell_type[cell]) / double(mesh.cell_points[cell].size()));
}

void add_mirror(const mesh::Geometry& geometry, Index face, std::vector<MirrorPlane>& mirrors) {
  const MirrorPlane plane{geometry.face_area[face].normalized(), geometry.face_centre[face]};
  if (std::ranges::none_of(mirrors, [&](const MirrorPlane& m) { return m.normal.dot(plane.normal) > 0.99; }))
    mirrors.push_back(plane);
}

void gather_cells(const mesh::Mesh& mesh, const mesh::Csr& cells_of_point, Index cell,
                  std::vector<Index>& mark, std::vector<Index>& cells) {
  for (const Index v : mesh.cell_points[cell])
    for (const Index c : cells_of_point[v]) {
      if (mark[std::size_t(c)] == cell || mesh.material_of(c) != mesh.material_of(cell)) continue;
      mark[std::size_t(c)] = cell;
      cells.push_back(c);
    }
}

mesh::Csr boundary_faces_of_cells(const mesh::Mesh& mesh) {
  mesh::Csr owners;
  for (Index f = mesh.n_interior; f < mesh.n_faces(); ++f) owners.push_row({&mesh.owner[f], 1});
  mesh::Csr faces = mesh::transpose(owners, 0, mesh.cells.n_local());
  for (Index& f : faces.index) f += mesh.n_interior;
  return faces;
}

std::vector<double> medians(const mesh::Mesh& mesh, const std::vector<PointShare>& shares,
                            std::span<const std::uint8_t> wanted) {
  std::vector<PointShare> all = parallel::all_gather(mesh.comm, shares);
  std::ranges::sort(all, {}, [](const PointShare& s) { return std::pair(s.point, s.share); });
  std::vector<double> result(wanted.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t v = 0; v < wanted.size(); ++v) {
    if (!wanted[v]) continue;
    const auto own = std::ranges::equal_range(all, mesh.point_id[v], {}, &PointShare::point);
    if (const std::size_t n = own.size(); n > 0)
      result[v] = 0.5 * (own[(n - 1) / 2].share + own[n / 2].share);
  }
  return result;
}

}  // namespace couplet::solid
