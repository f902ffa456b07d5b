// SPDX-License-Identifier: Apache-2.0
#include "mesh_mover/methods.hpp"

#include <cmath>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::mesh_mover {
namespace {

constexpr double axis_tolerance = 1e-6, least_cosine = 0.02;

/// Axis normal to a patch. Collective.
int normal_axis(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const mesh::Patch& patch) {
  std::array<double, 3> off{};
  for (Index f = patch.first; f < patch.first + patch.count; ++f) {
    const Vec3 n = geometry.face_area[f].normalized();
    for (int c = 0; c < 3; ++c) off[c] = std::max(off[c], 1 - std::abs(n[c]));
  }
  for (int c = 0; c < mesh.dim; ++c)
    if (parallel::max(mesh.comm, off[c]) < axis_tolerance) return c;
  throw Error(
      "Patch '{}' slides (type: slip), but is not a plane normal to a coordinate axis. Use type: fixed, "
      "rotate the mesh to align the plane, or use 'method: pseudo-solid', which slides along any surface.",
      patch.name);
}

}  // namespace

/// Equation shared by components that hold the same patches.
struct Laplacian::Equation {
  std::unique_ptr<linalg::SparseMatrix> matrix;
  std::unique_ptr<linalg::LinearSolver> solver;
  std::vector<double> diagonal;
};

Laplacian::Laplacian(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const Parameters& parameters)
    : mesh_(mesh),
      geometry_(geometry),
      dim_(mesh.dim),
      periodic_(mesh, geometry),
      relative_tolerance_(parameters.linear.relative_tolerance),
      cell_displacement_(std::size_t(mesh.cells.n_local()) * mesh.dim, 0.0) {
  set_kinds(parameters);
  set_weights();
  set_coefficients(stiffness_of(mesh, geometry, parameters.stiffening));

  for (int c = 0; c < dim_; ++c) {
    for (int same = 0; same < c && !equation_[c]; ++same) {
      bool equal = true;
      for (const auto& held : held_) equal = equal && held[same] == held[c];
      if (equal) equation_[c] = equation_[same];
    }
    if (equation_[c]) continue;
    auto equation = std::make_shared<Equation>();
    equation->diagonal.assign(mesh_.cells.n_owned(), 0.0);
    std::vector<GlobalIndex> row, column;
    std::vector<double> value;
    const auto add = [&](Index i, Index j, double a) {
      if (i >= mesh_.cells.n_owned()) return;
      row.push_back(mesh_.cells.global(i));
      column.push_back(mesh_.cells.global(j));
      value.push_back(a);
      if (i == j) equation->diagonal[i] += a;
    };
    for (Index f = 0; f < mesh_.n_interior; ++f) {
      const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
      add(p, p, coefficient_[f]);
      add(p, n, -coefficient_[f]);
      add(n, n, coefficient_[f]);
      add(n, p, -coefficient_[f]);
    }
    for (Index f = mesh_.n_interior; f < mesh_.n_flux_faces(); ++f)
      if (held_[patch_of_[f - mesh_.n_interior]][c]) add(mesh_.owner[f], mesh_.owner[f], coefficient_[f]);
    equation->matrix = std::make_unique<linalg::SparseMatrix>(mesh_.comm, mesh_.cells.n_owned(), row, column);
    equation->matrix->fill(value);
    linalg::LinearOptions options = parameters.linear;
    if (dim_ == 2 && options.method == linalg::LinearMethod::direct_symmetric)
      options.method = linalg::LinearMethod::direct_planar;
    equation->solver =
        std::make_unique<linalg::LinearSolver>("the mesh displacement", *equation->matrix, options);
    equation_[c] = equation;
  }
}

void Laplacian::set_kinds(const Parameters& parameters) {
  std::array<bool, 3> anything_held{};
  patch_of_.assign(mesh_.boundary.n_local(), 0);
  kind_.assign(mesh_.points.n_local(), {PointKind::interior, PointKind::interior, PointKind::interior});
  for (std::size_t p = 0; p < mesh_.patches.size(); ++p) {
    const mesh::Patch& patch = mesh_.patches[p];
    const BoundaryMotion motion = parameters.boundaries.at(patch.name).motion;
    const int axis = motion == BoundaryMotion::slip ? normal_axis(mesh_, geometry_, patch) : -1;
    std::array<bool, 3> held{};
    if (motion == BoundaryMotion::periodic) {  // its faces are interior ones
      held_.push_back(held);
      continue;
    }
    const bool slides = motion == BoundaryMotion::slip || motion == BoundaryMotion::free;
    for (int c = 0; c < dim_; ++c) held[c] = !slides || c == axis;
    held_.push_back(held);
    for (int c = 0; c < dim_; ++c) anything_held[c] = anything_held[c] || held[c];
    for_faces(patch, [&](Index f) { patch_of_[f - mesh_.n_interior] = static_cast<int>(p); });
    // On a point of several patches, holding overrides motion, so that corners stay closed.
    for (const Index v : points_of(mesh_, patch))
      for (int c = 0; c < dim_; ++c) {
        PointKind& kind = kind_[v][c];
        if (is_given(motion) && kind == PointKind::interior) kind = PointKind::interface;
        if (!is_given(motion) && held[c]) kind = PointKind::fixed;
      }
  }
  share_kinds();
  for (int c = 0; c < dim_; ++c)
    if (!anything_held[c])
      throw Error(
          "No patch constrains the mesh in direction {}: at least one needs type: fixed, moving or interface.",
          "xyz"[c]);
  for (Index v = 0; v < mesh_.points.n_local(); ++v)
    for (int c = 0; c < dim_; ++c)
      if (kind_[v][c] == PointKind::interface) {
        interface_points_.push_back(v);
        break;
      }
  for (int c = 0; c < dim_; ++c) {
    std::vector<Index> moved;
    for (const Index v : interface_points_)
      if (kind_[v][c] == PointKind::interface) moved.push_back(v);
    fit_[c] = std::make_unique<AffineFit>(mesh_, geometry_, std::move(moved));
  }
}

/// Holds points on both sides of periodic patches if one side is held.
void Laplacian::share_kinds() {
  if (periodic_.empty()) return;
  std::vector<double> fixed(kind_.size() * 3, 0.0);
  for (const Index v : periodic_.points())
    for (int c = 0; c < dim_; ++c) fixed[std::size_t(v) * 3 + c] = kind_[v][c] == PointKind::fixed ? 1 : 0;
  periodic_.add_up(fixed, 3);
  for (const Index v : periodic_.points())
    for (int c = 0; c < dim_; ++c)
      if (fixed[std::size_t(v) * 3 + c] > 0) kind_[v][c] = PointKind::fixed;
}

// Thesis (2.49): inverse-distance weights, which are all positive.
void Laplacian::set_weights() {
  std::vector<std::vector<Index>> cells(mesh_.points.n_local());
  for (Index c = 0; c < mesh_.cells.n_local(); ++c)
    for (const Index v : mesh_.cell_points[c]) cells[v].push_back(c);
  std::vector<double> totals(cells.size(), 0.0);
  for (Index v = 0; v < mesh_.points.n_local(); ++v) {
    for (const Index c : cells[v]) {
      weight_.push_back(1 / (geometry_.points[v] - geometry_.cell_centre[c]).norm());
      totals[v] += weight_.back();
    }
    around_.push_row(cells[v]);
  }
  // The cells around a point are those around all its copies.
  if (!periodic_.empty()) periodic_.add_up(totals, 1);
  for (Index v = 0; v < mesh_.points.n_local(); ++v)
    for (Index i = around_.offset[v]; i < around_.offset[v + 1]; ++i) weight_[i] /= totals[v];
}

std::vector<double> stiffness_of(const mesh::Mesh& mesh, const mesh::Geometry& geometry, double stiffening) {
  const std::vector<double>& volumes = geometry.volume;
  double volume = 0;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) volume += volumes[c];
  const double mean = parallel::sum(mesh.comm, volume) / static_cast<double>(mesh.cells.n_global());
  std::vector<double> stiffness;
  for (Index c = 0; c < mesh.cells.n_local(); ++c)
    stiffness.push_back(std::pow(volumes[c] / mean, -stiffening));
  return stiffness;
}

void Laplacian::set_coefficients(const std::vector<double>& stiffness) {
  const mesh::Geometry& g = geometry_;
  coefficient_.resize(mesh_.n_flux_faces());
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
    const bool interior = f < mesh_.n_interior;
    const Index p = mesh_.owner[f];
    const Vec3 to = interior ? Vec3(g.cell_centre[mesh_.neighbour[f]] + mesh_.shift(f)) : g.face_centre[f];
    const Vec3 d = to - g.cell_centre[p];
    const double e = interior ? (stiffness[p] + stiffness[mesh_.neighbour[f]]) / 2 : stiffness[p];
    // Inclined faces: avoids negative coefficients.
    const double area = g.face_area[f].norm();
    coefficient_[f] = e * area * area / std::max(g.face_area[f].dot(d), least_cosine * area * d.norm());
  }
}

double Laplacian::boundary_value(Index face, int component, std::span<const double> prescribed) const {
  double total = 0;
  const auto points = mesh_.face_points[face];
  for (const Index v : points)
    if (kind_[v][component] == PointKind::interface) total += prescribed[std::size_t(v) * dim_ + component];
  return total / static_cast<double>(points.size());
}

void Laplacian::solve_cells(int c, std::span<const double> prescribed, std::vector<double>& cells) {
  const Index n = mesh_.cells.n_owned();
  std::vector<double> b(n, 0.0), x(n);
  for (Index f = mesh_.n_interior; f < mesh_.n_flux_faces(); ++f)
    if (held_[patch_of_[f - mesh_.n_interior]][c])
      b[mesh_.owner[f]] += coefficient_[f] * boundary_value(f, c, prescribed);
  for (Index i = 0; i < n; ++i) x[i] = cells[std::size_t(i) * dim_ + c];
  // If a wall passes its rest position, b is at round-off, and the residual cannot fall below that of A x0.
  double scale[2] = {0, 0};
  for (Index i = 0; i < n; ++i) {
    scale[0] += std::pow(equation_[c]->diagonal[i] * x[i], 2);
    scale[1] += std::abs(b[i]);
  }
  MPI_Allreduce(MPI_IN_PLACE, scale, 2, MPI_DOUBLE, MPI_SUM, mesh_.comm);
  if (scale[1] == 0) {  // nothing moves this way
    std::fill(x.begin(), x.end(), 0.0);
  } else {
    const double floor = 1e-15 * std::sqrt(scale[0]) + 1e-300;
    const linalg::SolveStatistics s = equation_[c]->solver->solve(b, x, relative_tolerance_, floor);
    last_.iterations += s.iterations;
    last_.seconds += s.seconds;
  }
  for (Index i = 0; i < n; ++i) cells[std::size_t(i) * dim_ + c] = x[i];
}

void Laplacian::interpolate(int c, std::span<const double> prescribed, const std::vector<double>& cells,
                            std::vector<double>& points) const {
  for (Index v = 0; v < mesh_.points.n_local(); ++v) {
    double& d = points[std::size_t(v) * dim_ + c];
    d = kind_[v][c] == PointKind::interface ? prescribed[std::size_t(v) * dim_ + c] : 0.0;
    if (kind_[v][c] != PointKind::interior) continue;
    for (Index i = around_.offset[v]; i < around_.offset[v + 1]; ++i)
      d += weight_[i] * cells[std::size_t(around_.index[i]) * dim_ + c];
  }
  if (periodic_.empty()) return;
  std::vector<double> sums(points.size() / dim_);  // what the cells around each copy give
  for (const Index v : periodic_.points()) sums[v] = points[std::size_t(v) * dim_ + c];
  periodic_.add_up(sums, 1);
  for (const Index v : periodic_.points())
    if (kind_[v][c] == PointKind::interior) points[std::size_t(v) * dim_ + c] = sums[v];
}

void Laplacian::make_shapes(int c) {
  for (int k = 0; k < fit_[c]->count(); ++k) {
    std::vector<double> prescribed(std::size_t(mesh_.points.n_local()) * dim_, 0.0), points(prescribed),
        cells(cell_displacement_.size(), 0.0);
    for (Index v = 0; v < mesh_.points.n_local(); ++v)
      prescribed[std::size_t(v) * dim_ + c] = fit_[c]->shape(k, geometry_.points[v]);
    solve_cells(c, prescribed, cells);
    mesh_.cells.update_ghosts(cells, dim_);
    interpolate(c, prescribed, cells, points);
    mesh_.points.update_ghosts(points, dim_);
    MotionShape& shape = shapes_[c].emplace_back();
    for (std::size_t i = c; i < cells.size(); i += dim_) shape.cells.push_back(cells[i]);
    for (std::size_t i = c; i < points.size(); i += dim_) shape.points.push_back(points[i]);
  }
}

void Laplacian::combine(int c, const AffineFit::Coefficients& coefficients, std::vector<double>& points) {
  for (std::size_t i = c; i < cell_displacement_.size(); i += dim_) cell_displacement_[i] = 0;
  if (coefficients == AffineFit::Coefficients{}) return;  // nothing moves this way
  if (shapes_[c].empty()) make_shapes(c);
  const auto add = [&](double factor, const std::vector<double>& shape, std::vector<double>& sum) {
    for (std::size_t i = 0; i < shape.size(); ++i) sum[i * dim_ + c] += factor * shape[i];
  };
  for (std::size_t k = 0; k < shapes_[c].size(); ++k) {
    if (coefficients[k] == 0) continue;
    add(coefficients[k], shapes_[c][k].points, points);
    add(coefficients[k], shapes_[c][k].cells, cell_displacement_);
  }
}

std::vector<double> Laplacian::solve(std::span<const double> prescribed) {
  last_ = {};
  std::vector<double> displacement(std::size_t(mesh_.points.n_local()) * dim_, 0.0);
  std::array<std::optional<AffineFit::Coefficients>, 3> affine;
  for (int c = 0; c < dim_; ++c) {
    affine[c] = (*fit_[c])(prescribed, c);
    if (!affine[c])
      solve_cells(c, prescribed, cell_displacement_);
    else
      combine(c, *affine[c], displacement);
  }
  mesh_.cells.update_ghosts(cell_displacement_, dim_);
  for (int c = 0; c < dim_; ++c)
    if (!affine[c]) interpolate(c, prescribed, cell_displacement_, displacement);
  for (const Index v : interface_points_)
    for (int c = 0; c < dim_; ++c)
      if (kind_[v][c] == PointKind::interface)
        displacement[std::size_t(v) * dim_ + c] = prescribed[std::size_t(v) * dim_ + c];
  mesh_.points.update_ghosts(displacement, dim_);
  return displacement;
}

}  // namespace couplet::mesh_mover
