// SPDX-License-Identifier: Apache-2.0
#include "mesh_mover/methods.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/base/error.hpp"
#include "common/elasticity/elastic_kernel.hpp"
#include "common/elasticity/node_fields.hpp"
#include "common/elasticity/solve/elastic_preconditioner.hpp"
#include "common/elasticity/symmetric/symmetric_matrix.hpp"
#include "common/linalg/krylov.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::mesh_mover {

namespace {

elastic::BoundaryRow row_of(BoundaryMotion motion) {
  switch (motion) {
    case BoundaryMotion::slip:
      return elastic::mirror_row();
    case BoundaryMotion::free:
      return elastic::free_row();
    default:
      return elastic::fixed_row();
  }
}

/// mu and lambda of E = V^-chi and nu in plane strain or three dimensions.
std::vector<elastic::LameConstants> lame_of(const mesh::Mesh& mesh, const Parameters& p,
                                            std::span<const double> volumes) {
  const double nu = p.poisson_ratio;
  std::vector<elastic::LameConstants> lame;
  for (const double e : stiffness_of(mesh, volumes, p.stiffening))
    lame.push_back({e / (2 * (1 + nu)), e * nu / ((1 + nu) * (1 - 2 * nu))});
  return lame;
}

/// Mesh motion by equilibrium of an elastic body without loads, thesis (4.10), (4.12): div sigma = 0, E =
/// V^-chi, given nu. Uses the symmetric operator of common/elasticity, whose energy has no negative modes on
/// distorted cells, and its vertex values. Sliding patches may have any plane.
class PseudoSolid final : public MotionMethod {
 public:
  /// `volumes`: V of (4.12) per local cell; empty for the mesh's. Throws Error if no patch holds the mesh.
  PseudoSolid(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const Parameters& parameters,
              std::span<const double> volumes)
      : mesh_(mesh),
        dim_(mesh.dim),
        options_{parameters.linear.relative_tolerance, parameters.linear.max_iterations, true},
        given_point_(mesh.points.n_local(), 0),
        given_face_(mesh.boundary.n_local(), 0) {
    std::vector<elastic::BoundaryRow> of_patches;
    bool held = false;
    for (const mesh::Patch& patch : mesh.patches) {
      const BoundaryMotion motion = parameters.boundaries.at(patch.name).motion;
      of_patches.push_back(row_of(motion));
      // The faces of periodic patches are interior ones.
      held = held || (motion != BoundaryMotion::periodic && of_patches.back().fixed);
      if (!is_given(motion)) continue;
      for_faces(patch, [&](Index f) { given_face_[f - mesh.n_interior] = 1; });
      for (const Index v : points_of(mesh, patch)) given_point_[v] = 1;
    }
    if (!held) throw Error("No patch holds the mesh: at least one needs type: fixed, moving or interface.");
    // On a point of several patches, holding overrides motion, so that corners stay closed.
    for (const mesh::Patch& patch : mesh.patches)
      if (parameters.boundaries.at(patch.name).motion == BoundaryMotion::fixed)
        for (const Index v : points_of(mesh, patch)) given_point_[v] = 0;
    elastic::ElasticBody body;
    body.lame = lame_of(mesh, parameters, volumes.empty() ? std::span(geometry.volume) : volumes);
    rows_ = std::make_unique<elastic::ElasticOperator>(
        mesh, geometry, elastic::boundary_of_patches(mesh, of_patches), std::move(body));
    kernel_ = std::make_unique<elastic::ElasticKernel>(mesh, *rows_, elastic::FaceGradientScheme::symmetric);
    unknowns_.assign(rows_->n_unknowns(), 0.0);
    make_solver(parameters.linear);
  }

  std::vector<double> solve(std::span<const double> prescribed) override {
    last_ = {};
    std::vector<double> displacement(std::size_t(mesh_.points.n_local()) * dim_, 0.0);
    const std::vector<double> g = known(prescribed);
    const bool moves = parallel::any(mesh_.comm, std::ranges::any_of(g, [](double v) { return v != 0; }));
    if (!moves) {
      std::ranges::fill(unknowns_, 0.0);
      return displacement;
    }
    std::vector<double> b(unknowns_.size(), 0.0);
    const std::vector<double> none(unknowns_.size(), 0.0);
    kernel_->apply(none, g, b);
    for (double& value : b) value = -value;
    last_ = krylov_->solve(b, unknowns_, options_);
    kernel_->point_values(unknowns_, g, displacement);
    mesh_.points.update_ghosts(displacement, dim_);
    return displacement;
  }
  linalg::SolveStatistics last() const override { return last_; }
  void visit(io::Archive& archive) override {
    elastic::NodeFields fields = elastic::fields_of_unknowns(mesh_, *rows_, unknowns_);
    archive.field(mesh::Entries::owned_cells, "pseudo-solid", fields.inner, std::size_t(dim_));
    archive.field(mesh::Entries::owned_boundary, "pseudo-solid-faces", fields.faces, std::size_t(dim_));
    if (archive.reads()) unknowns_ = elastic::unknowns_of_fields(mesh_, *rows_, fields);
  }

 private:
  void make_solver(const linalg::LinearOptions& options) {
    // The points of the operator have nodes on other ranks.
    const bool joined = parallel::any(mesh_.comm, !mesh_.neighbour_shift.empty());
    if (options.method == linalg::LinearMethod::direct_symmetric && dim_ == 2 && !joined) {
      matrix_ = std::make_unique<linalg::SparseMatrix>(elastic::symmetric_matrix(mesh_, *rows_, {}));
      linalg::LinearOptions of_factors;
      of_factors.method = linalg::LinearMethod::direct_planar;
      factors_ = std::make_unique<linalg::LinearSolver>("the mesh displacement", *matrix_, of_factors);
    } else {
      elastic::ElasticPreconditioner::Options of_multigrid;
      of_multigrid.scheme = elastic::FaceGradientScheme::symmetric;
      multigrid_ = std::make_unique<elastic::ElasticPreconditioner>(mesh_, *rows_, std::span<const double>{},
                                                                    of_multigrid);
    }
    krylov_ = std::make_unique<linalg::KrylovSolver>(
        "the mesh displacement", mesh_.comm, unknowns_.size(),
        [this](std::span<const double> x, std::span<double> y) { kernel_->apply(x, {}, y); },
        [this](std::span<const double> r, std::span<double> z) {
          if (multigrid_) return multigrid_->apply(r, z);
          factors_->solve(r, z);
        });
  }
  /// Displacement of held and moved columns; the motion is taken from `prescribed`.
  std::vector<double> known(std::span<const double> prescribed) const {
    std::vector<double> values(rows_->n_known() * dim_, 0.0);
    const std::vector<Index>& points = rows_->constraints().points();
    for (std::size_t i = 0; i < points.size(); ++i)
      if (given_point_[points[i]])
        std::copy_n(prescribed.data() + std::size_t(points[i]) * dim_, dim_, values.data() + i * dim_);
    for (const Index f : rows_->known_faces()) {
      if (!given_face_[f - mesh_.n_interior]) continue;
      double* value = values.data() + std::size_t(rows_->known_of_face(f)) * dim_;
      const auto corners = mesh_.face_points[f];
      for (const Index v : corners)
        for (int c = 0; c < dim_ && given_point_[v]; ++c)
          value[c] += prescribed[std::size_t(v) * dim_ + c] / static_cast<double>(corners.size());
    }
    return values;
  }

  const mesh::Mesh& mesh_;
  int dim_;
  linalg::KrylovOptions options_;
  std::vector<char> given_point_, given_face_;  // per local point, boundary face: it moves as prescribed
  std::unique_ptr<elastic::ElasticOperator> rows_;
  std::unique_ptr<elastic::ElasticKernel> kernel_;
  std::unique_ptr<linalg::SparseMatrix> matrix_;  // with factors_
  std::unique_ptr<linalg::LinearSolver> factors_;
  std::unique_ptr<elastic::ElasticPreconditioner> multigrid_;  // or this
  std::unique_ptr<linalg::KrylovSolver> krylov_;
  std::vector<double> unknowns_;  // also the next initial guess
  linalg::SolveStatistics last_;
};

constexpr double turn = 2 * std::numbers::pi;
// Ratio r2/r1 below which there is no room to rotate.
constexpr double least_room = 1.05;

/// Vector of the rotation nearest to M; of all equivalent ones (plus whole turns) the nearest to `before`.
Vec3 rotation_vector(const Tensor3& m, const Vec3& before) {
  const Eigen::JacobiSVD<Tensor3> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Tensor3 sign = Tensor3::Identity();
  if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0) sign(2, 2) = -1;
  const Tensor3 r = svd.matrixU() * sign * svd.matrixV().transpose();
  const Eigen::AngleAxisd of(r);
  const double whole = std::round((before.dot(of.axis()) - of.angle()) / turn);
  return (of.angle() + whole * turn) * of.axis();
}

/// Mesh motion that rotates the surroundings of a body with it. Each moving patch is a body with the center c
/// (mean of its points) and the best-fit rotation R(theta) [kabsch1976]. Around it
///   x' = c + R(s theta) (x - c) + d(x),   s = 1 for r <= r1,  ln(r2/r) / ln(r2/r1),  0 for r >= r2
/// with r = |x - c|, r1 the radius of the body and r2 that of the nearest fixed or other point. A rotation by
/// s(r) preserves volume for any angle and shears the cells between the radii evenly. The Laplacian of thesis
/// (4.11), (4.12) adds d for the rest: translation and deformation.
///
/// Angles beyond half a turn continue from the previous solve.
class Rotations final : public MotionMethod {
 public:
  /// Throws Error if a body has no room to rotate.
  Rotations(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const Parameters& parameters,
            std::span<const double> volumes)
      : mesh_(mesh), geometry_(geometry), dim_(mesh.dim), rest_(mesh, geometry, parameters, volumes) {
    find_bodies(parameters);
    find_room(parameters);
  }

  std::vector<double> solve(std::span<const double> prescribed) override {
    for (Body& body : bodies_) body.theta = best_rotation(body, prescribed);
    std::vector<double> displacement = turned(), rest(displacement.size(), 0.0);
    for (const Index v : rest_.interface_points())
      for (int c = 0; c < dim_; ++c) {
        const std::size_t i = std::size_t(v) * dim_ + c;
        rest[i] = prescribed[i] - displacement[i];
      }
    const std::vector<double> d = rest_.solve(rest);
    for (std::size_t i = 0; i < d.size(); ++i) displacement[i] += d[i];
    return displacement;
  }
  linalg::SolveStatistics last() const override { return rest_.last(); }
  void visit(io::Archive& archive) override {
    rest_.visit(archive);
    for (Body& body : bodies_)
      archive.common("rotation-" + body.name, body.theta.x(), body.theta.y(), body.theta.z());
  }

 private:
  struct Body {
    std::string name;
    std::vector<Index> points;    // local
    Vec3 centre = Vec3::Zero();   // [m]
    double inner = 0, outer = 0;  // r1, r2 [m]
    Vec3 theta = Vec3::Zero();    // of the last solve [rad]
  };
  void find_bodies(const Parameters& parameters) {
    for (const mesh::Patch& patch : mesh_.patches) {
      if (!is_given(parameters.boundaries.at(patch.name).motion)) continue;
      Body body;
      body.name = patch.name;
      body.points = points_of(mesh_, patch);
      body.centre = mean(body, [&](Index v) { return geometry_.points[v]; });
      for (const Index v : body.points)
        body.inner = std::max(body.inner, (geometry_.points[v] - body.centre).norm());
      body.inner = parallel::max(mesh_.comm, body.inner);
      bodies_.push_back(std::move(body));
    }
  }
  void find_room(const Parameters& parameters) {
    const mesh::PeriodicPoints periodic(mesh_, geometry_);  // nothing turns across them
    for (Body& body : bodies_) {
      double nearest = std::numeric_limits<double>::max();
      for (const mesh::Patch& patch : mesh_.patches)
        if (patch.name != body.name && parameters.boundaries.at(patch.name).motion != BoundaryMotion::free)
          for (const Index v : points_of(mesh_, patch))
            nearest = std::min(nearest, (geometry_.points[v] - body.centre).norm());
      for (const Index v : periodic.points())
        nearest = std::min(nearest, (geometry_.points[v] - body.centre).norm());
      body.outer = parallel::min(mesh_.comm, nearest);
      if (!(body.outer > least_room * body.inner))
        throw Error(
            "method: rotations: patch '{}' extends {:.3g} m from its center ({:.4g}, {:.4g}, {:.4g}) m, but "
            "another patch is as close as {:.3g} m: there is no space to rotate. Use 'method: pseudo-solid'.",
            body.name, body.inner, body.centre.x(), body.centre.y(), body.centre.z(), body.outer);
      body.outer = std::min(body.outer, 10 * body.inner);
    }
    for (const Body& a : bodies_)  // what turns with one body must not turn with another
      for (const Body& b : bodies_)
        if (a.name < b.name && (a.centre - b.centre).norm() < a.outer + b.outer)
          throw Error(
              "method: rotations: the surroundings of patches '{}' and '{}' overlap; use 'method: "
              "pseudo-solid', or one name for both if they move as one body.",
              a.name, b.name);
  }
  /// Mean of value(v) over the points of a body. Collective.
  template <class Value>
  Vec3 mean(const Body& body, const Value& value) const {
    double sums[4] = {};
    for (const Index v : body.points)
      if (v < mesh_.points.n_owned()) {
        const Vec3 here = value(v);
        for (int c = 0; c < 3; ++c) sums[c] += here[c];
        sums[3] += 1;
      }
    MPI_Allreduce(MPI_IN_PLACE, sums, 4, MPI_DOUBLE, MPI_SUM, mesh_.comm);
    return Vec3(sums[0], sums[1], sums[2]) / std::max(sums[3], 1.0);
  }
  Vec3 best_rotation(const Body& body, std::span<const double> prescribed) const {
    const auto given = [&](Index v) {
      Vec3 d = Vec3::Zero();
      for (int c = 0; c < dim_; ++c) d[c] = prescribed[std::size_t(v) * dim_ + c];
      return d;
    };
    const Vec3 shift = mean(body, given);
    Tensor3 m = Tensor3::Zero();
    for (const Index v : body.points)
      if (v < mesh_.points.n_owned()) {
        const Vec3 r = geometry_.points[v] - body.centre;
        m += (r + given(v) - shift) * r.transpose();
      }
    MPI_Allreduce(MPI_IN_PLACE, m.data(), 9, MPI_DOUBLE, MPI_SUM, mesh_.comm);
    if (dim_ == 3) return rotation_vector(m, body.theta);
    const double angle = std::atan2(m(1, 0) - m(0, 1), m(0, 0) + m(1, 1));
    return {0, 0, angle + turn * std::round((body.theta.z() - angle) / turn)};
  }
  /// Displacement by the rotations only, dim values per local point.
  std::vector<double> turned() const {
    std::vector<double> displacement(std::size_t(mesh_.points.n_local()) * dim_, 0.0);
    for (const Body& body : bodies_) {
      const double angle = body.theta.norm();
      if (angle == 0) continue;
      const Vec3 axis = body.theta / angle;
      for (Index v = 0; v < mesh_.points.n_local(); ++v) {
        const Vec3 r = geometry_.points[v] - body.centre;
        const double distance = r.norm();
        if (distance >= body.outer) continue;
        const double share =
            distance <= body.inner ? 1 : std::log(body.outer / distance) / std::log(body.outer / body.inner);
        const Vec3 d = Eigen::AngleAxisd(share * angle, axis) * r - r;
        for (int c = 0; c < dim_; ++c) displacement[std::size_t(v) * dim_ + c] = d[c];
      }
    }
    return displacement;
  }

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  int dim_;
  Laplacian rest_;
  std::vector<Body> bodies_;
};

}  // namespace

std::unique_ptr<MotionMethod> make_pseudo_solid(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                                const Parameters& parameters,
                                                std::span<const double> volumes) {
  return std::make_unique<PseudoSolid>(mesh, geometry, parameters, volumes);
}

std::unique_ptr<MotionMethod> make_rotations(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                             const Parameters& parameters, std::span<const double> volumes) {
  return std::make_unique<Rotations>(mesh, geometry, parameters, volumes);
}

}  // namespace couplet::mesh_mover
