// SPDX-License-Identifier: Apache-2.0
#include "mesh_mover/barrier.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::mesh_mover {
namespace {

// Share of its volume that a simplex keeps in each step.
constexpr double least_kept = 0.1;
// Limits of -g . d of a Newton step over the energy and the weights, about the squared mean change of the
// deformation gradient. Below the first the mesh is at rest; the second applies to slow convergence, as for
// cells near buckling; below the third the boundary advances.
constexpr double at_rest = 1e-5, slowly_at_rest = 1e-4, nearly_at_rest = 1e-2, slow = 0.1;
// Factor by which energy plus weights may grow as the boundary moves.
constexpr double most_growth = 2, linear_tolerance = 3e-3;
constexpr int most_steps = 200;
// Energy over the weights above which no valid mesh is expected: cells at a thousandth of their width.
constexpr double most_energy = 1e6;
// Share of its way below which a boundary cannot arrive: onto a wall that holds it, each is a tenth of the last.
constexpr double least_share = 1e-3;
// Constants of the Armijo rule.
constexpr double least_decrease = 1e-4, shortest_step = 1e-8;

linalg::LinearOptions options_of(const mesh::Mesh& mesh, const linalg::LinearOptions& wanted) {
  linalg::LinearOptions options;
  options.method = wanted.method == linalg::LinearMethod::direct_symmetric && mesh.dim == 2
                       ? linalg::LinearMethod::cg_direct
                       : linalg::LinearMethod::cg_multigrid;
  options.relative_tolerance = linear_tolerance;
  options.max_iterations = std::max(wanted.max_iterations, 500);
  return options;
}

/// Mesh motion that cannot fold. Points minimize the distortion of cells relative to their reference shapes,
///   sum_s V_s (V/mean V)^-chi (|F|^2 + |F^-1|^2 - 2 D),
/// over their simplices s, which is infinite for a flat one. Newton's method with the positive part of the
/// Hessian [teran2005, smith2019] starts from the last mesh. Each step is limited so that no simplex loses
/// nine tenths of its volume, and includes the rest of the boundary's displacement as far as adjacent cells
/// allow. Once the boundary has arrived, the energy decreases monotonically.
class BarrierMotion final : public MotionMethod {
 public:
  /// Throws Error if no patch holds the mesh.
  BarrierMotion(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const Parameters& parameters)
      : mesh_(mesh),
        dim_(mesh.dim),
        simplices_(make_simplices(mesh, geometry, parameters.stiffening)),
        held_(find_held_points(mesh, geometry, parameters)),
        system_(mesh, geometry, simplices_, held_),
        displacement_(std::size_t(mesh.points.n_local()) * mesh.dim, 0.0) {
    solver_ = std::make_unique<linalg::LinearSolver>("the mesh displacement", system_.matrix(),
                                                     options_of(mesh, parameters.linear));
  }

  std::vector<double> solve(std::span<const double> prescribed) override {
    last_ = {};
    std::vector<double> u = displacement_, way(u.size(), 0.0);
    const std::vector<double> none(u.size(), 0.0);
    direction_.assign(u.size(), 0.0);
    trial_.assign(u.size(), 0.0);
    energy_ = system_.energy(u);
    bool arrived = remaining(prescribed, u, way) == 0, relaxed = true;
    double before = std::numeric_limits<double>::infinity();
    for (int step = 0; step < most_steps; ++step) {
      if (!arrived && relaxed) {
        const double share = advance(u, way, true);
        if (share < least_share) break;
        relaxed = arrived = share == 1;
        if (arrived)
          arrive(prescribed, u);
        else
          remaining(prescribed, u, way);
        // What a whole step leaves over is far smaller than the step.
        if (arrived && change() < at_rest) return displacement_ = u;
        continue;
      }
      const bool whole = advance(u, none, false) == 1;
      const double now = change();
      relaxed = now < nearly_at_rest;
      // Steps so short that rounding of the energy shortens them further do not count as refused.
      if (arrived && (now < at_rest || (whole && now < slowly_at_rest && now > slow * before)))
        return displacement_ = u;
      before = now;
      if (energy_ > most_energy * simplices_.total) break;
    }
    const Vec3 x = system_.worst_place(u);
    throw SolveFailure(
        "method: barrier: no valid mesh was found; the cells near ({:.6g}, {:.6g}, {:.6g}) m leave "
        "no room for the motion. Let the walls there slide (type: slip).",
        x.x(), x.y(), x.z());
  }
  linalg::SolveStatistics last() const override { return last_; }
  void visit(io::Archive& archive) override {
    linalg::PreconditionerMemory memory = solver_->memory();
    memory.is_due = memory.is_due || factored_at_.empty();
    archive.field(mesh::Entries::points, "barrier", displacement_, std::size_t(dim_));
    archive.field(mesh::Entries::points, "barrier-factors", factored_at_, std::size_t(dim_));
    archive.common("barrier-memory", factored_, memory.is_due, memory.most_iterations);
    if (!archive.reads()) return;
    if (!memory.is_due)
      system_.assemble(factored_at_, std::vector<double>(displacement_.size(), 0.0), residual_, factored_);
    solver_->restore(memory);
  }

 private:
  /// Remaining displacement of held directions. Returns its largest component over all ranks. Collective.
  double remaining(std::span<const double> prescribed, std::span<const double> u,
                   std::vector<double>& way) const {
    double most = 0;
    for (Index v = 0; v < mesh_.points.n_local(); ++v) {
      if (held_.moved[v].isZero(0)) continue;
      Vec3 left = Vec3::Zero();
      for (int c = 0; c < dim_; ++c)
        left[c] = prescribed[std::size_t(v) * dim_ + c] - u[std::size_t(v) * dim_ + c];
      left = held_.moved[v] * left;
      for (int c = 0; c < dim_; ++c) way[std::size_t(v) * dim_ + c] = left[c];
      most = std::max(most, left.cwiseAbs().maxCoeff());
    }
    return parallel::max(mesh_.comm, most);
  }
  double change() const { return -slope_ / (simplices_.total + energy_); }
  /// One Newton step of `u`, with or without the boundary motion. Returns the share that was taken.
  double advance(std::vector<double>& u, const std::vector<double>& way, bool moves) {
    const bool exact = find_direction(u, way, BarrierSystem::Hessian::exact);
    if (!exact) find_direction(u, way, BarrierSystem::Hessian::projected);
    for (std::size_t i = 0; i < residual_.size(); ++i) direction_[i] += way[i];
    mesh_.points.update_ghosts(direction_, dim_);
    const double limit = system_.largest_step(u, direction_, least_kept);
    return moves ? line_search(u, limit, most_growth * energy_ + simplices_.total, 0)
                 : line_search(u, limit, energy_ + 1e-13 * simplices_.total, least_decrease * slope_);
  }
  /// Sets direction_ and slope_ at `u`; false if this Hessian gives no descent direction.
  bool find_direction(const std::vector<double>& u, const std::vector<double>& way,
                      BarrierSystem::Hessian hessian) {
    const std::size_t owned = std::size_t(mesh_.points.n_owned()) * dim_;
    system_.assemble(u, way, residual_, hessian);
    std::ranges::fill(direction_, 0.0);
    try {
      const linalg::SolveStatistics s = solver_->solve(residual_, {direction_.data(), owned});
      last_.iterations += s.iterations;
      last_.seconds += s.seconds;
      if (solver_->preconditioners_built() > built_) {
        built_ = solver_->preconditioners_built();
        factored_at_ = u;
        factored_ = hessian;
      }
    } catch (const SolveFailure&) {
      if (hessian == BarrierSystem::Hessian::projected) throw;
      solver_->refresh();
      return false;  // not positive definite
    }
    slope_ = 0;
    for (std::size_t i = 0; i < owned; ++i) slope_ -= residual_[i] * direction_[i];
    slope_ = parallel::sum(mesh_.comm, slope_);
    return slope_ <= 0;
  }
  /// Largest of 1, 1/2, 1/4, ... times `limit` with an energy of at most `most` + `slope` times it.
  double line_search(std::vector<double>& u, double limit, double most, double slope) {
    for (double share = limit; share > shortest_step; share /= 2) {
      for (std::size_t i = 0; i < u.size(); ++i) trial_[i] = u[i] + share * direction_[i];
      const double energy = system_.energy(trial_);
      if (energy <= most + slope * share) {
        energy_ = energy;
        u = trial_;
        return share;
      }
    }
    throw SolveFailure(
        "method: barrier: Newton's line search failed: no step along its direction lowers the distortion.");
  }
  /// Sets the boundary exactly.
  void arrive(std::span<const double> prescribed, std::vector<double>& u) const {
    for (Index v = 0; v < mesh_.points.n_local(); ++v)
      if (held_.moved[v].topLeftCorner(dim_, dim_).isIdentity(0))
        for (int c = 0; c < dim_; ++c) u[std::size_t(v) * dim_ + c] = prescribed[std::size_t(v) * dim_ + c];
  }

  const mesh::Mesh& mesh_;
  int dim_;
  Simplices simplices_;
  HeldPoints held_;
  BarrierSystem system_;
  std::unique_ptr<linalg::LinearSolver> solver_;
  std::vector<double> displacement_;  // dim per local point: of the last solve, which the next starts from
  std::vector<double> residual_, direction_, trial_;
  double slope_ = 0, energy_ = 0;
  int built_ = 0;                    // preconditioners so far
  std::vector<double> factored_at_;  // displacement whose Hessian the preconditioner is of
  BarrierSystem::Hessian factored_ = BarrierSystem::Hessian::exact;
  linalg::SolveStatistics last_;
};

}  // namespace

std::unique_ptr<MotionMethod> make_barrier(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                           const Parameters& parameters) {
  return std::make_unique<BarrierMotion>(mesh, geometry, parameters);
}

}  // namespace couplet::mesh_mover
