// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/output/displacement_error.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/elasticity/symmetric/symmetric_space.hpp"
#include "common/elasticity/vector_at.hpp"
#include "common/linalg/krylov.hpp"
#include "common/mesh/topology.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/body/quadratic_fit.hpp"
#include "solid_solver/body/stress.hpp"

namespace couplet::solid {
namespace {

constexpr int curvatures = 6;  // second derivatives of a component
constexpr double near_weight = 0.05, not_spanned = 1e-20, least_pivot = 1e-9;  // as in fv::NearQuadratic

/// Second derivatives of the three components, each as xx, yy, zz, xy, yz, xz.
using Curvature = std::array<Tensor3, 3>;

/// Cubic about a cell's center.
struct Cubic {
  Vec3 value = Vec3::Zero();
  Tensor3 slope = Tensor3::Zero();  // entry (i, j) = d u_j / d x_i
  Curvature curvature{Tensor3::Zero(), Tensor3::Zero(), Tensor3::Zero()};
  std::array<Curvature, 3> change{curvature, curvature, curvature};  // of the curvature along each axis

  Tensor3 third(int j, const Vec3& x) const {
    return x[0] * change[0][j] + x[1] * change[1][j] + x[2] * change[2][j];
  }
  Vec3 cubic_part(const Vec3& x) const {
    return {x.dot(third(0, x) * x) / 6, x.dot(third(1, x) * x) / 6, x.dot(third(2, x) * x) / 6};
  }
  Vec3 at(const Vec3& x) const {
    Vec3 u = value + slope.transpose() * x + cubic_part(x);
    for (int j = 0; j < 3; ++j) u[j] += 0.5 * x.dot(curvature[j] * x);
    return u;
  }
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
        cells_of_point_(mesh::transpose(mesh_.cell_points, 0, mesh_.points.n_local())),
        boundary_faces_(boundary_faces_of_cells(mesh_)),
        mark_(std::size_t(mesh_.cells.n_local()), -1),
        curvature_(std::size_t(mesh_.cells.n_local()) * 3 * curvatures, 0.0),
        curvature_place_(std::size_t(mesh_.cells.n_local()) * 3, 0.0) {
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
    for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
      gather(c);
      keep(c, fit(samples_).curvature);
    }
    mesh_.cells.update_ghosts(curvature_, 3 * curvatures);
    mesh_.cells.update_ghosts(curvature_place_, 3);
    std::ranges::fill(mark_, -1);
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
      gather(c);
      const Cubic cubic = fitted(change_of_curvature(c));
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

  void keep(Index cell, const Curvature& curvature) {
    double* to = curvature_.data() + std::size_t(cell) * 3 * curvatures;
    for (const Tensor3& h : curvature) {
      const PackedTensor packed = pack(h);
      to = std::copy(packed.begin(), packed.end(), to);
    }
    Vec3 middle = Vec3::Zero();
    for (const Sample& s : samples_) middle += s.x / double(samples_.size());
    const Vec3 place = geometry_.cell_centre[cell] + middle;
    std::copy_n(place.data(), 3, curvature_place_.data() + std::size_t(cell) * 3);
  }

  struct Sample {
    Vec3 x, u;  // x from the cell's center
  };

  /// Quadratic by least squares, near samples first. Terms that the samples do not determine are small.
  template <int D>
  Cubic fit_in(const std::vector<Sample>& samples) const {
    constexpr int n = 1 + D + D * (D + 1) / 2;
    using Terms = Eigen::Matrix<double, n, 1>;
    Cubic cubic;
    double reach = 0;
    for (const Sample& s : samples) reach = std::max(reach, s.x.squaredNorm());
    cubic.value = samples.front().u;
    if (!(reach > 0)) return cubic;
    const double inverse = 1 / std::sqrt(reach);
    Eigen::Matrix<double, n, n> of = Eigen::Matrix<double, n, n>::Zero();
    Eigen::Matrix<double, n, 3> right = Eigen::Matrix<double, n, 3>::Zero();
    for (const Sample& s : samples) {
      const Vec3 x = inverse * s.x;
      Terms phi;
      phi[0] = 1;
      for (int a = 0, i = 1 + D; a < D; ++a) {
        phi[1 + a] = x[a];
        for (int b = a; b < D; ++b) phi[i++] = x[a] * x[b];
      }
      const Terms weighted = phi / (near_weight + x.squaredNorm());
      of.noalias() += weighted * phi.transpose();
      right.noalias() += weighted * s.u.transpose();
    }
    const double least = not_spanned * of(0, 0);
    const Terms scale = of.diagonal().unaryExpr([&](double v) { return v > least ? 1 / std::sqrt(v) : 0; });
    of = (scale.asDiagonal() * of * scale.asDiagonal()).eval();
    of.diagonal().array() += least_pivot;
    const Eigen::Matrix<double, n, 3> c = scale.asDiagonal() * of.llt().solve(scale.asDiagonal() * right);
    cubic.value = c.row(0);
    for (int j = 0; j < D; ++j)
      for (int a = 0, i = 1 + D; a < D; ++a) {
        cubic.slope(a, j) = inverse * c(1 + a, j);
        for (int b = a; b < D; ++b, ++i) {
          Tensor3& h = cubic.curvature[std::size_t(j)];
          h(a, b) = h(b, a) = (a == b ? 2 : 1) * inverse * inverse * c(i, j);
        }
      }
    return cubic;
  }
  Cubic fit(const std::vector<Sample>& samples) const {
    return mesh_.dim == 2 ? fit_in<2>(samples) : fit_in<3>(samples);
  }

  /// Fit to the samples of the cell without their known cubic part.
  Cubic fitted(const std::array<Curvature, 3>& change) {
    Cubic known;
    known.change = change;
    for (Sample& s : samples_) s.u -= known.cubic_part(s.x);
    Cubic cubic = fit(samples_);
    cubic.change = change;
    return cubic;
  }

  Cubic force_near(Index cell) const {
    if (body_force_.empty()) return {};
    Cubic uniform;
    uniform.value = elastic::vector_at(body_force_, cell, mesh_.dim);
    if (force_is_uniform_) return uniform;
    std::vector<Sample> samples;
    for (const Index c : patch_)
      samples.push_back({geometry_.cell_centre[c] - geometry_.cell_centre[cell],
                         elastic::vector_at(body_force_, c, mesh_.dim)});
    return fit(samples);
  }

  /// Thermal pressure of a cell, and its slope by Gauss's theorem.
  struct Pressure {
    double value = 0, mean = 0;  // mean: lambda times the volume strain, where cells have one
    Vec3 slope = Vec3::Zero(), mean_slope = Vec3::Zero();
  };
  Pressure pressure_near(Index cell, const std::vector<double>& of_faces) const {
    Pressure p;
    if (!volume_strain_.empty()) {
      std::vector<Sample> samples;
      for (const Index c : patch_)
        samples.push_back({geometry_.cell_centre[c] - geometry_.cell_centre[cell],
                           Vec3(rows_.lame(c).lambda * volume_strain_[std::size_t(c)], 0, 0)});
      const Cubic mean = fit(samples);
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

  void gather(Index cell) {
    patch_.clear();
    gather_cells(mesh_, cells_of_point_, cell, mark_, patch_);
    samples_.clear();
    const Vec3 centre = geometry_.cell_centre[cell];
    std::vector<MirrorPlane> mirrors;
    for (const Index f : boundary_faces_[cell])
      if (rows_.mirrored(f)) add_mirror(geometry_, f, mirrors);
    const auto add = [&](const Vec3& x, const Vec3& u) {
      samples_.push_back({x - centre, u});
      for (const MirrorPlane& m : mirrors) samples_.push_back({m.image(x) - centre, m.reflect(u)});
    };
    for (const Index c : patch_) {
      add(geometry_.cell_centre[c], elastic::vector_at(state_.cell_u, c, mesh_.dim));
      for (const Index f : boundary_faces_[c])
        if (!rows_.mirrored(f))
          add(geometry_.face_centre[f], elastic::vector_at(state_.face_u, f - mesh_.n_interior, mesh_.dim));
    }
  }

  /// Slopes of the neighbors' second derivatives, which are those at the middle of their samples.
  std::array<Curvature, 3> change_of_curvature(Index cell) const {
    Eigen::Matrix3d of = Eigen::Matrix3d::Zero();
    Eigen::Matrix<double, 3, 3 * curvatures> right;
    right.setZero();
    using Row = Eigen::Matrix<double, 1, 3 * curvatures>;
    const auto at = [&](Index c) {
      return Eigen::Map<const Row>(curvature_.data() + std::size_t(c) * 3 * curvatures);
    };
    for (const Index c : patch_) {
      const Vec3 x =
          elastic::vector_at(curvature_place_, c, 3) - elastic::vector_at(curvature_place_, cell, 3);
      const Vec3 between_centres = geometry_.cell_centre[c] - geometry_.cell_centre[cell];
      if (c == cell || !(between_centres.norm() > 0)) continue;
      const double weight =
          1 / between_centres.squaredNorm();  // the places of two cells across a body coincide
      of += weight * x * x.transpose();
      right += weight * x * (at(c) - at(cell));
    }
    of.diagonal().array() += 1e-6 * of.trace() + 1e-300;
    const Eigen::Matrix<double, 3, 3 * curvatures> slope = of.llt().solve(right);
    std::array<Curvature, 3> change;
    for (int k = 0; k < 3; ++k)
      for (int j = 0; j < 3; ++j) {
        PackedTensor packed;
        for (std::size_t i = 0; i < packed.size(); ++i) packed[i] = slope(k, j * curvatures + int(i));
        change[std::size_t(k)][std::size_t(j)] = unpack(packed);
      }
    return change;
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

  /// Corner of a part of a cell, and the force on it.
  struct Corner {
    Vec3 x;  // from the cell's center
    Vec3 force = Vec3::Zero();
  };

  void add_cell(Index c, const Cubic& w, const Cubic& body, const Pressure& heat) {
    const Vec3 centre = geometry_.cell_centre[c];
    Vec3 of_cell = Vec3::Zero();
    for (const Index f : faces_of_cell_[c]) {
      const bool second = f < mesh_.n_interior && mesh_.neighbour[f] == c && mesh_.owner[f] != c;
      const Vec3 from = centre + (second ? mesh_.shift(f) : Vec3(Vec3::Zero()));
      const auto points = mesh_.face_points[f];
      Vec3 of_middle = Vec3::Zero();
      std::array<Vec3, 4> of_point{Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
      const std::size_t n = points.size();
      for (std::size_t i = 0; i < n; ++i) {
        std::array<Corner, 4> part{Corner{Vec3::Zero()}, Corner{geometry_.face_centre[f] - from},
                                   Corner{geometry_.points[points[i]] - from},
                                   Corner{geometry_.points[points[(i + 1) % n]] - from}};
        add_part(c, w, body, heat, part);
        of_cell += part[0].force, of_middle += part[1].force, of_point[i] += part[2].force;
        if (mesh_.dim == 3) of_point[(i + 1) % n] += part[3].force;
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

  /// Adds the forces on the corners of a simplex. The gradient is quadratic, so with one corner at the origin its mean follows
  /// from its values at the others and at their sum.
  void add_part(Index c, const Cubic& w, const Cubic& body, const Pressure& heat,
                std::array<Corner, 4>& part) {
    const int dim = mesh_.dim;
    Vec3 sum = Vec3::Zero();
    for (int i = 1; i <= dim; ++i) sum += part[std::size_t(i)].x;
    std::array<Vec3, 4> area;  // volume times the gradient of a corner's test function
    if (dim == 3) {
      area[1] = part[2].x.cross(part[3].x) / 6, area[2] = part[3].x.cross(part[1].x) / 6;
      area[3] = part[1].x.cross(part[2].x) / 6;
    } else {
      area[1] = 0.5 * Vec3(part[2].x[1], -part[2].x[0], 0),
      area[2] = 0.5 * Vec3(-part[1].x[1], part[1].x[0], 0);
      area[3].setZero();
    }
    double volume = area[1].dot(part[1].x);
    if (volume < 0) {
      for (int i = 1; i <= 3; ++i) area[std::size_t(i)] *= -1;
      volume = -volume;
    }
    area[0] = -(area[1] + area[2] + area[3]);
    if (!(volume > 0)) return;
    if (is_axisymmetric(rows_)) return add_ring_part(c, w, body, heat, part, area, volume);
    const double first = 1. / (dim + 1), second = first / (dim + 2);
    Tensor3 gradient = w.slope;
    Tensor3 squares = sum * sum.transpose();
    for (int i = 1; i <= dim; ++i) squares += part[std::size_t(i)].x * part[std::size_t(i)].x.transpose();
    squares *= 0.5 * second;
    for (int j = 0; j < dim; ++j) {
      gradient.col(j) += first * (w.curvature[std::size_t(j)] * sum);
      for (int k = 0; k < dim; ++k)
        gradient.col(j) += w.change[std::size_t(k)][std::size_t(j)] * squares.col(k);
    }
    const Tensor3 stress = stress_of(c, gradient, heat, first * sum, volume);
    const Vec3 push = first * volume * (body.at(first * sum) - first * (body.slope.transpose() * sum));
    for (int i = 0; i <= dim; ++i) {
      Vec3& force = part[std::size_t(i)].force;
      force += push - stress * area[std::size_t(i)];
      if (!force_is_uniform_)
        force += second * volume * (body.slope.transpose() * (sum + part[std::size_t(i)].x));
    }
    if (dim == 2)
      for (Corner& k : part) k.force[2] = 0;
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
  void add_ring_part(Index c, const Cubic& w, const Cubic& body, const Pressure& heat,
                     std::array<Corner, 4>& part, const std::array<Vec3, 4>& area, double volume) {
    for (std::size_t q = 0; q < 3; ++q) {
      Vec3 x = Vec3::Zero();
      std::array<double, 3> share{1. / 6, 1. / 6, 1. / 6};
      share[q] = 2. / 3;
      for (std::size_t i = 0; i < 3; ++i) x += share[i] * part[i].x;
      const double radius = geometry_.cell_centre[c][0] + x[0], around = elastic::circumference(radius) / 3;
      Tensor3 gradient = w.slope;
      for (int j = 0; j < 2; ++j) gradient.col(j) += (w.curvature[std::size_t(j)] + 0.5 * w.third(j, x)) * x;
      gradient(2, 2) = w.at(x)[0] / radius;
      const Tensor3 stress = stress_of(c, gradient, heat, x,
                                       around * volume / elastic::circumference(geometry_.cell_centre[c][0]));
      for (std::size_t i = 0; i < 3; ++i) {
        part[i].force += around * (volume * share[i] * body.at(x) - stress * area[i]);
        part[i].force[0] -= around * volume * stress(2, 2) * share[i] / radius;
        part[i].force[2] = 0;
      }
    }
  }

  const SolidBody& body_;
  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const elastic::ElasticOperator& rows_;
  const SolidState& state_;
  elastic::SymmetricSpace space_;
  mesh::Csr cells_of_point_, boundary_faces_, faces_of_cell_;
  std::vector<Index> mark_, patch_;
  std::vector<Sample> samples_;
  std::vector<double> curvature_, curvature_place_, body_force_;  // per local cell
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
    krylov.solve(r, e, {.relative_tolerance = 1e-2, .max_iterations = 200, .is_symmetric = true});
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
