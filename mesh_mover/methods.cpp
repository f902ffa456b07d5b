// SPDX-License-Identifier: Apache-2.0
#include "mesh_mover/methods.hpp"

#include <algorithm>

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
std::vector<elastic::LameConstants> lame_of(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                            const Parameters& p) {
  const double nu = p.poisson_ratio;
  std::vector<elastic::LameConstants> lame;
  for (const double e : stiffness_of(mesh, geometry, p.stiffening))
    lame.push_back({e / (2 * (1 + nu)), e * nu / ((1 + nu) * (1 - 2 * nu))});
  return lame;
}

/// Mesh motion by equilibrium of an elastic body without loads, thesis (4.10), (4.12): div sigma = 0, E =
/// V^-chi, given nu. Uses the symmetric operator of common/elasticity, whose energy has no negative modes on
/// distorted cells, and its vertex values. Sliding patches may have any plane.
class PseudoSolid final : public MotionMethod {
 public:
  /// Throws Error if no patch holds the mesh.
  PseudoSolid(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const Parameters& parameters)
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
    if (!held)
      throw Error("No patch constrains the mesh: at least one needs type: fixed, moving or interface.");
    // On a point of several patches, holding overrides motion, so that corners stay closed.
    for (const mesh::Patch& patch : mesh.patches)
      if (parameters.boundaries.at(patch.name).motion == BoundaryMotion::fixed)
        for (const Index v : points_of(mesh, patch)) given_point_[v] = 0;
    elastic::ElasticBody body;
    body.lame = lame_of(mesh, geometry, parameters);
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
      multigrid_ = std::make_unique<elastic::ElasticPreconditioner>(
          mesh_, *rows_, elastic::ElasticPreconditioner::Options{});
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

}  // namespace

std::unique_ptr<MotionMethod> make_pseudo_solid(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                                const Parameters& parameters) {
  return std::make_unique<PseudoSolid>(mesh, geometry, parameters);
}

}  // namespace couplet::mesh_mover
