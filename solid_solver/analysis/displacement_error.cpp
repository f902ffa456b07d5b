// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/analysis/displacement_error.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/processor_clones.hpp"
#include "common/elasticity/lanes.hpp"
#include "common/elasticity/symmetric/symmetric_space.hpp"
#include "common/elasticity/vector_at.hpp"
#include "common/linalg/krylov.hpp"
#include "common/mesh/topology.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/analysis/reconstruction.hpp"
#include "solid_solver/body/stress.hpp"

namespace couplet::solid {
namespace {

using elastic::Four;
using FourVectors = std::array<Four, 3>;

Vec3 at(const FourVectors& v, std::size_t lane) { return {v[0][lane], v[1][lane], v[2][lane]}; }

/// Simplices of a cell's center, a center of a face and an edge of it, in lanes; at most four.
struct Parts {
  std::array<FourVectors, 4> x{};         // corners, from the cell's center
  std::array<FourVectors, 4> area{};      // volume times the gradient of a corner's test function
  FourVectors sum{};                      // of the corners
  std::array<FourVectors, 3> gradient{};  // mean of the displacement's; vector j is that of component j
  Four volume{};

  void place(std::size_t corner, std::size_t lane, const Vec3& from) {
    for (std::size_t k = 0; k < 3; ++k) x[corner][k][lane] = from[Eigen::Index(k)];
  }
};

/// Volumes and mean gradients. The gradient is quadratic, so with one corner at the origin its mean follows from its values
/// at the others and at their sum.
COUPLET_PROCESSOR_CLONES void measure(Parts& parts, const Cubic& w, int dim) {
  const FourVectors &a = parts.x[1], &b = parts.x[2], &c = parts.x[3];
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    parts.area[1][k] = (b[i] * c[j] - b[j] * c[i]) / 6;
    parts.area[2][k] = (c[i] * a[j] - c[j] * a[i]) / 6;
    parts.area[3][k] = (a[i] * b[j] - a[j] * b[i]) / 6;
    parts.sum[k] = a[k] + b[k] + c[k];
  }
  if (dim == 2) {
    parts.area[1] = {0.5 * b[1], -0.5 * b[0], Four{}};
    parts.area[2] = {-0.5 * a[1], 0.5 * a[0], Four{}};
    parts.area[3] = {};
  }
  parts.volume = parts.area[1][0] * a[0] + parts.area[1][1] * a[1] + parts.area[1][2] * a[2];
  const Four sign = parts.volume < 0 ? Four{-1, -1, -1, -1} : Four{1, 1, 1, 1};
  parts.volume *= sign;
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t i = 1; i < 4; ++i) parts.area[i][k] *= sign;
    parts.area[0][k] = -(parts.area[1][k] + parts.area[2][k] + parts.area[3][k]);
  }
  const double first = 1. / (dim + 1), second = first / (dim + 2);
  const FourVectors& s = parts.sum;
  std::array<FourVectors, 3> squares;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      squares[i][j] = second * (s[i] * s[j] + a[i] * a[j] + b[i] * b[j] + c[i] * c[j]);
  for (std::size_t j = 0; j < std::size_t(dim); ++j) {
    const Tensor3& h = w.curvature[j];
    parts.gradient[j] = w.slope_of_cubes(j, squares);
    for (int i = 0; i < 3; ++i)
      parts.gradient[j][std::size_t(i)] +=
          w.slope(i, Eigen::Index(j)) + first * (h(i, 0) * s[0] + h(i, 1) * s[1] + h(i, 2) * s[2]);
  }
}

/// Thermal pressure of a cell, and its slope by Gauss's theorem.
struct Pressure {
  double value = 0, mean = 0;  // mean: lambda times the volume strain, where cells have one
  Vec3 slope = Vec3::Zero(), mean_slope = Vec3::Zero();
};

class Defect {
 public:
  Defect(const SolidBody& body, const SolidState& state)
      : body_(body),
        mesh_(body.mesh()),
        geometry_(body.geometry()),
        rows_(body.elastic()),
        state_(state),
        space_(mesh_, rows_),
        reconstruction_(mesh_, rows_, state) {
    mesh::Csr cells;
    for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
      const std::array<Index, 2> sides{mesh_.owner[f], f < mesh_.n_interior ? mesh_.neighbour[f] : -1};
      cells.push_row({sides.data(), std::size_t(f < mesh_.n_interior ? 2 : 1)});
    }
    faces_of_cell_ = mesh::transpose(cells, 0, mesh_.cells.n_local());
  }

  std::vector<double> rows(const elastic::ElasticLoads& loads) {
    space_.fill(body_.unknowns_of(state_.cell_u, state_.face_u), state_.known);
    space_.clear_forces();
    space_.add_springs(state_.known);
    space_.negate_forces();
    if (rows_.volume_by_cells()) find_volume_strains();
    if (!loads.cells.empty()) {
      body_force_ = loads.cells;
      for (std::size_t i = 0; i < body_force_.size(); ++i)
        body_force_[i] /= geometry_.volume[i / std::size_t(mesh_.dim)];
      body_force_.resize(std::size_t(mesh_.cells.n_local() * mesh_.dim));
      mesh_.cells.update_ghosts(body_force_, mesh_.dim);
      for (std::size_t i = std::size_t(mesh_.dim); i < body_force_.size(); ++i)
        force_is_uniform_ =
            force_is_uniform_ && std::abs(body_force_[i] - body_force_[i - std::size_t(mesh_.dim)]) <=
                                     1e-12 * std::abs(body_force_[i]);
    }
    for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
      const Cubic cubic = reconstruction_.fitted(c);
      add_cell(c, cubic, force_near(c), pressure_near(c, loads.pressure));
      compare_points(c, cubic);
    }
    between_ = std::sqrt(parallel::sum(mesh_.comm, between_) / parallel::sum(mesh_.comm, volume_));
    std::vector<double> result(rows_.n_unknowns(), 0);
    space_.add_collected(result);
    if (!volume_strain_.empty()) body_.kernel().add_pressure(missed_pressure(), result);
    if (!loads.faces.empty()) body_.kernel().add_face_forces(loads.faces, result);
    return result;
  }
  double between() const { return between_; }

 private:
  /// Mean volume strains of the cells, in which the operator has the bulk modulus.
  void find_volume_strains() {
    volume_strain_.assign(std::size_t(mesh_.cells.n_local()), 0);
    missed_volume_ = volume_strain_;
    const std::vector<double> volume = elastic::pyramid_volumes(mesh_, geometry_);
    body_.kernel().face_gradients(
        body_.unknowns_of(state_.cell_u, state_.face_u), state_.known,
        [&](Index f, const Tensor3& g) {
          elastic::visit_sides(mesh_, geometry_, f, [&](Index c, double v) {
            volume_strain_[std::size_t(c)] += v / volume[std::size_t(c)] * g.trace();
          });
        },
        0, mesh_.n_flux_faces());
    mesh_.cells.update_ghosts(volume_strain_);
  }

  /// lambda times the volume strain that the cells have beyond that of the reconstruction, as a pressure of the faces. Only the
  /// operator's own mean strains balance it: near incompressibility any other test function would lock.
  std::vector<double> missed_pressure() {
    mesh_.cells.update_ghosts(missed_volume_);
    std::vector<double> pressure(std::size_t(mesh_.n_faces()), 0);
    const auto of = [&](Index c) { return rows_.lame(c).lambda * missed_volume_[std::size_t(c)]; };
    for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
      const auto [here, there] = elastic::pyramids(mesh_, geometry_, f);
      pressure[std::size_t(f)] = here * of(mesh_.owner[f]);
      if (f < mesh_.n_interior) pressure[std::size_t(f)] += there * of(mesh_.neighbour[f]);
      pressure[std::size_t(f)] /= here + there;
    }
    return pressure;
  }

  Cubic force_near(Index cell) {
    if (body_force_.empty()) return {};
    Cubic uniform;
    uniform.value = elastic::vector_at(body_force_, cell, mesh_.dim);
    if (force_is_uniform_) return uniform;
    std::vector<Sample> samples;
    for (const Index c : reconstruction_.patch())
      samples.push_back({geometry_.cell_centre[c] - geometry_.cell_centre[cell],
                         elastic::vector_at(body_force_, c, mesh_.dim)});
    return reconstruction_.fit(samples);
  }

  Pressure pressure_near(Index cell, const std::vector<double>& of_faces) {
    Pressure p;
    if (!volume_strain_.empty()) {
      std::vector<Sample> samples;
      for (const Index c : reconstruction_.patch())
        samples.push_back({geometry_.cell_centre[c] - geometry_.cell_centre[cell],
                           Vec3(rows_.lame(c).lambda * volume_strain_[std::size_t(c)], 0, 0)});
      const Cubic mean = reconstruction_.fit(samples);
      p.mean = mean.value[0], p.mean_slope = mean.slope.col(0);
    }
    if (of_faces.empty()) return p;
    const Vec3 centre = geometry_.cell_centre[cell];
    Vec3 middle = Vec3::Zero();
    double volume = 0;
    for (const Index f : faces_of_cell_[cell]) {
      const bool is_owner = mesh_.owner[f] == cell;
      const auto [here, there] = elastic::pyramids(mesh_, geometry_, f);
      const double v = is_owner ? here : there;
      p.slope += (is_owner ? 1 : -1) * of_faces[f] * geometry_.face_area[f];
      p.value += v * of_faces[f], volume += v;
      middle += v * (geometry_.face_centre[f] - centre);
    }
    p.slope /= geometry_.volume[cell];
    p.value = (p.value - p.slope.dot(middle)) / volume;
    return p;
  }

  void compare_points(Index c, const Cubic& w) {
    const auto points = mesh_.cell_points[c];
    volume_ += geometry_.volume[c];
    for (const Index v : points)
      between_ +=
          geometry_.volume[c] / double(points.size()) *
          (w.at(geometry_.points[v] - geometry_.cell_centre[c]) - space_.value(space_.place_of_point(v)))
              .squaredNorm();
  }

  void add_cell(Index c, const Cubic& w, const Cubic& body, const Pressure& heat) {
    const Vec3 centre = geometry_.cell_centre[c];
    const bool is_ring = is_axisymmetric(rows_);
    Vec3 of_cell = Vec3::Zero();
    for (const Index f : faces_of_cell_[c]) {
      const bool second = f < mesh_.n_interior && mesh_.neighbour[f] == c && mesh_.owner[f] != c;
      const Vec3 from = centre + (second ? mesh_.shift(f) : Vec3(Vec3::Zero()));
      const auto points = mesh_.face_points[f];
      const std::size_t n = points.size();
      Vec3 of_middle = Vec3::Zero();
      std::array<Vec3, 5> of_point;
      of_point.fill(Vec3::Zero());
      Parts parts;
      for (std::size_t i = 0; i < n; ++i) {
        parts.place(1, i, geometry_.face_centre[f] - from);
        parts.place(2, i, geometry_.points[points[i]] - from);
        if (mesh_.dim == 3) parts.place(3, i, geometry_.points[points[(i + 1) % n]] - from);
      }
      measure(parts, w, mesh_.dim);
      for (std::size_t i = 0; i < n; ++i) {
        if (!(parts.volume[i] > 0)) continue;
        const auto force =
            is_ring ? of_ring_part(c, w, body, heat, parts, i) : of_part(c, body, heat, parts, i);
        of_cell += force[0], of_middle += force[1], of_point[i] += force[2];
        of_point[(i + 1) % n] += force[3];
      }
      const bool has_node = f >= mesh_.n_interior && !rows_.mirrored(f);
      const auto shares = elastic::point_shares(mesh_, geometry_, f);
      if (has_node) space_.force(space_.node_of_face(f)) += of_middle;
      for (std::size_t i = 0; i < n; ++i)
        space_.force(space_.place_of_point(points[i])) +=
            of_point[i] + (has_node ? Vec3(Vec3::Zero()) : Vec3(shares[i] * of_middle));
    }
    space_.force(c) += of_cell;
  }

  using Forces = std::array<Vec3, 4>;

  /// Forces on the corners of a simplex.
  Forces of_part(Index c, const Cubic& body, const Pressure& heat, const Parts& parts, std::size_t i) {
    const int dim = mesh_.dim;
    const double first = 1. / (dim + 1), volume = parts.volume[i];
    const Vec3 sum = at(parts.sum, i);
    Tensor3 gradient;
    for (int j = 0; j < 3; ++j) gradient.col(j) = at(parts.gradient[std::size_t(j)], i);
    const Tensor3 stress = stress_of(c, gradient, heat, first * sum, volume);
    Vec3 push = body.value;
    if (!force_is_uniform_) push = body.at(first * sum) - first * (body.slope.transpose() * sum);
    Forces force;
    for (std::size_t k = 0; k <= std::size_t(dim); ++k) {
      force[k] = first * volume * push - stress * at(parts.area[k], i);
      if (!force_is_uniform_)
        force[k] += first / (dim + 2) * volume * (body.slope.transpose() * (sum + at(parts.x[k], i)));
    }
    if (dim == 2) {
      for (Vec3& each : force) each[2] = 0;
      force[3].setZero();
    }
    return force;
  }

  Tensor3 stress_of(Index c, const Tensor3& gradient, const Pressure& heat, const Vec3& x, double volume) {
    double pressure = heat.value + heat.slope.dot(x);
    if (!volume_strain_.empty()) {
      missed_volume_[std::size_t(c)] +=
          (volume_strain_[std::size_t(c)] - gradient.trace()) * volume / geometry_.volume[c];
      pressure += rows_.lame(c).lambda * gradient.trace() - heat.mean - heat.mean_slope.dot(x);
    }
    return rows_.stress(c, gradient) - pressure * Tensor3::Identity();
  }

  /// Integrates around the axis, with three points.
  Forces of_ring_part(Index c, const Cubic& w, const Cubic& body, const Pressure& heat, const Parts& parts,
                      std::size_t part) {
    Forces force;
    force.fill(Vec3::Zero());
    const double volume = parts.volume[part];
    for (std::size_t q = 0; q < 3; ++q) {
      Vec3 x = Vec3::Zero();
      std::array<double, 3> share{1. / 6, 1. / 6, 1. / 6};
      share[q] = 2. / 3;
      for (std::size_t i = 0; i < 3; ++i) x += share[i] * at(parts.x[i], part);
      const double radius = geometry_.cell_centre[c][0] + x[0], around = elastic::circumference(radius) / 3;
      Tensor3 gradient = w.slope;
      std::array<std::array<double, 3>, 3> squares;
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) squares[i][j] = x[Eigen::Index(i)] * x[Eigen::Index(j)];
      for (int j = 0; j < 2; ++j)
        gradient.col(j) +=
            w.curvature[std::size_t(j)] * x + Vec3(w.slope_of_cubes(std::size_t(j), squares).data());
      gradient(2, 2) = w.at(x)[0] / radius;
      const Tensor3 stress = stress_of(c, gradient, heat, x,
                                       around * volume / elastic::circumference(geometry_.cell_centre[c][0]));
      for (std::size_t i = 0; i < 3; ++i) {
        force[i] += around * (volume * share[i] * body.at(x) - stress * at(parts.area[i], part));
        force[i][0] -= around * volume * stress(2, 2) * share[i] / radius;
        force[i][2] = 0;
      }
    }
    return force;
  }

  const SolidBody& body_;
  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const elastic::ElasticOperator& rows_;
  const SolidState& state_;
  elastic::SymmetricSpace space_;
  Reconstruction reconstruction_;
  mesh::Csr faces_of_cell_;
  std::vector<double> body_force_;                     // per local cell
  std::vector<double> volume_strain_, missed_volume_;  // likewise; empty unless cells have one volume strain
  bool force_is_uniform_ = true;                       // on this rank
  double between_ = 0, volume_ = 0;
};

}  // namespace

double displacement_error(const SolidBody& body, const SolidState& state, const elastic::ElasticLoads& loads,
                          SolutionMethod& method) {
  Defect defect(body, state);
  const std::vector<double> r = defect.rows(loads);
  std::vector<double> e(r.size(), 0);
  if (!method.approximate_inverse(r, e)) {
    method.solve(r, e);
  } else {
    linalg::KrylovSolver krylov(
        "error of the displacement", body.mesh().comm, r.size(),
        [&](std::span<const double> x, std::span<double> y) { body.kernel().apply(x, {}, y); },
        [&](std::span<const double> x, std::span<double> z) { method.approximate_inverse(x, z); });
    std::ranges::fill(e, 0.0);
    krylov.solve(r, e, {.relative_tolerance = 1e-3, .max_iterations = 200, .is_symmetric = true});
  }
  const int dim = body.mesh().dim;
  std::array<double, 3> sums{};  // volume, squares of the error and of the displacement
  for (Index c = 0; c < body.mesh().cells.n_owned(); ++c) {
    const double volume = body.geometry().volume[c];
    sums[0] += volume, sums[1] += volume * elastic::vector_at(e, c, dim).squaredNorm();
    sums[2] += volume * elastic::vector_at(state.cell_u, c, dim).squaredNorm();
  }
  for (double& sum : sums) sum = parallel::sum(body.mesh().comm, sum);
  return std::sqrt((0.25 * sums[1] + sums[0] * defect.between() * defect.between()) / sums[2]);
}

}  // namespace couplet::solid
