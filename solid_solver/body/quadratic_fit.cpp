// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/body/quadratic_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "common/base/processor_clones.hpp"
#include "common/elasticity/lanes.hpp"
#include "common/mesh/topology.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::solid {

namespace {

// Relative to the sum of the weights; in units of the scale, a good sample contributes about 0.1.
constexpr double least_curvature = 1e-4, least_slope = 1e-12;
constexpr double near_weight = 0.05;  // added to the squared relative distance
constexpr double least_pivot = 1e-9;  // ratio of the pivots of undetermined and determined terms
// Relative square of a term in the samples, below which they do not span its direction.
constexpr double not_spanned = 1e-20;

using elastic::Four;

[[gnu::always_inline]] inline Four load(const double* from) { return elastic::lanes::load<3>(from); }

/// Adds a_i a_j of four rows `a`, in blocks of four from the diagonal on.
[[gnu::always_inline]] inline void add_rows(const double* a, int n, int width, double* products) {
  const double *b = a + width, *c = b + width, *d = c + width;
  for (int i = 0; i < n; ++i)
    for (int j = i / 4 * 4; j < width; j += 4) {
      double* to = products + i * width + j;
      elastic::lanes::store<3>(
          to, load(to) + a[i] * load(a + j) + b[i] * load(b + j) + c[i] * load(c + j) + d[i] * load(d + j));
    }
}

/// Cholesky's method on the upper triangle. The columns from n on are right-hand sides and become the solutions.
[[gnu::always_inline]] inline void eliminate(double* rows, int n, int width) {
  for (int k = 0; k < n; ++k) {
    double* pivot = rows + k * width;
    const double inverse = 1 / std::sqrt(pivot[k]);
    for (int j = k / 4 * 4; j < width; j += 4) elastic::lanes::store<3>(pivot + j, inverse * load(pivot + j));
    for (int i = k + 1; i < n; ++i)
      for (int j = i / 4 * 4; j < width; j += 4) {
        double* to = rows + i * width + j;
        elastic::lanes::store<3>(to, load(to) - pivot[i] * load(pivot + j));
      }
  }
  for (int i = n; i-- > 0;)
    for (int j = width - 4; j >= n / 4 * 4; j -= 4) {  // the block with terms is overwritten last
      const double* row = rows + i * width;
      Four value = load(row + j);
      for (int k = i + 1; k < n; ++k) value -= row[k] * load(rows + k * width + j);
      elastic::lanes::store<3>(rows + i * width + j, value / row[i]);
    }
}

// The loops over the terms of a quadratic in 3-D have constant lengths.
constexpr int terms_in_space = 10, width_in_space = 16;

COUPLET_PROCESSOR_CLONES void add_products(const double* a, int n, int width, double* products) {
  if (n == terms_in_space && width == width_in_space)
    add_rows(a, terms_in_space, width_in_space, products);
  else
    add_rows(a, n, width, products);
}

COUPLET_PROCESSOR_CLONES void solve_rows(double* rows, int n, int width) {
  if (n == terms_in_space && width == width_in_space)
    eliminate(rows, terms_in_space, width_in_space);
  else
    eliminate(rows, n, width);
}

}  // namespace

void NormalEquations::start(int terms, int values) {
  terms_ = terms, width_ = (terms + values + 3) / 4 * 4, waiting_ = 0;
  batch_.assign(std::size_t(4 * width_), 0);
  products_.assign(std::size_t(terms * width_), 0);
}

void NormalEquations::flush() {
  std::fill(batch_.begin() + waiting_ * width_, batch_.end(), 0);
  add_products(batch_.data(), terms_, width_, products_.data());
  waiting_ = 0;
}

void NormalEquations::solve() { solve_rows(products_.data(), terms_, width_); }

void QuadraticFit::start(int dim, int components, const Vec3& centre, double scale) {
  dim_ = dim, components_ = components, centre_ = centre, scale_ = scale, weights_ = 0, has_rows_ = false;
  samples_.start(n_terms(), components);
}

namespace {

/// Writes `factor` times the terms at x.
void write_terms(int dim, const Vec3& x, double factor, double* to) {
  const double a = factor * x[0], b = factor * x[1], c = factor * x[2];
  if (dim == 2) {
    const std::array<double, 6> terms{factor, a, b, a * x[0], a * x[1], b * x[1]};
    std::ranges::copy(terms, to);
  } else {
    const std::array<double, 10> terms{factor,   a,        b,        c,        a * x[0],
                                       a * x[1], a * x[2], b * x[1], b * x[2], c * x[2]};
    std::ranges::copy(terms, to);
  }
}

}  // namespace

QuadraticFit::Terms QuadraticFit::terms(const Vec3& place) const {
  Terms phi(n_terms());
  write_terms(dim_, (place - centre_) / scale_, 1, phi.data());
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
  add_values(place, values, weight);
  double* squares = samples_.last_row() + 1 + dim_;
  const double factor = std::sqrt(weight) / (scale_ * scale_);
  for (int a = 0; a < dim_; ++a)
    for (int b = a; b < dim_; ++b) *squares++ += factor * moment(a, b);
}

void QuadraticFit::add_values(const Vec3& place, std::span<const double> values, double weight) {
  const double inverse = 1 / scale_, root = std::sqrt(weight);
  weights_ += weight;
  double* row = samples_.next_row();
  write_terms(dim_, inverse * (place - centre_), root, row);
  row += n_terms();
  for (int k = 0; k < components_; ++k) row[k] = root * values[std::size_t(k)];
}

void QuadraticFit::add_near(const Vec3& place, std::span<const double> values) {
  const double far = (place - centre_).squaredNorm() / (scale_ * scale_);
  add_values(place, values, 1 / (near_weight + far));
}

void QuadraticFit::add_row(const Row& row, double value, double weight) {
  const int n = n_terms() * components_;
  if (!has_rows_) coupled_.start(n, 1);
  has_rows_ = true;
  const double root = std::sqrt(weight);
  double* to = coupled_.next_row();
  for (int i = 0; i < n; ++i) to[i] = root * row.data()[i];
  to[n] = root * value;
}

void QuadraticFit::solve() {
  const int n = n_terms();
  samples_.flush();
  for (int i = 0; i < n; ++i)
    samples_.at(i, i) += weights_ * (i > dim_ ? least_curvature : i > 0 ? least_slope : 0);
  coefficients_.resize(n, components_);
  if (!has_rows_) {
    samples_.solve();
    for (int k = 0; k < components_; ++k)
      for (int i = 0; i < n; ++i) coefficients_(i, k) = samples_.at(i, n + k);
    return;
  }
  coupled_.flush();
  const int all = n * components_;
  for (int k = 0; k < components_; ++k)
    for (int i = 0; i < n; ++i) {
      for (int j = i; j < n; ++j) coupled_.at(k * n + i, k * n + j) += samples_.at(i, j);
      coupled_.at(k * n + i, all) += samples_.at(i, n + k);
    }
  coupled_.solve();
  for (int i = 0; i < all; ++i) coefficients_.data()[i] = coupled_.at(i, all);
}

void QuadraticFit::solve_near() {
  samples_.flush();
  // Thin cells give terms of very different magnitude.
  const int n = n_terms();
  std::array<double, most_terms> scale{};
  for (int i = 0; i < n; ++i)
    if (samples_.at(i, i) > not_spanned * samples_.at(0, 0))
      scale[std::size_t(i)] = 1 / std::sqrt(samples_.at(i, i));
  for (int i = 0; i < n; ++i) {
    for (int j = i; j < n + components_; ++j)
      samples_.at(i, j) *= scale[std::size_t(i)] * (j < n ? scale[std::size_t(j)] : 1);
    samples_.at(i, i) += least_pivot;
  }
  samples_.solve();
  coefficients_.resize(n, components_);
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < components_; ++k) coefficients_(i, k) = scale[std::size_t(i)] * samples_.at(i, n + k);
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
