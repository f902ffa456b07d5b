// SPDX-License-Identifier: Apache-2.0

#include "solid_solver/diagnostics/large_strain.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "common/base/error.hpp"
#include "common/elasticity/finite/finite_kernel.hpp"
#include "common/io/checkpoint.hpp"
#include "common/linalg/krylov.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/laws/laws.hpp"
#include "solid_solver/method/solution_method.hpp"

namespace couplet::solid {
namespace {

using Values = std::vector<double>;

/// Size of displacement gradients for differences. The forces of Saint Venant-Kirchhoff are cubic, so
/// differences are exact; for other laws they have relative errors of this size.
constexpr double probe_gradient = 0.01;
/// Gradient over the last one judged from which another look is worth it.
constexpr double steeper = 1.1;
/// Change of the displacement below which small strain is not in question.
constexpr double harmless = 0.02;
/// Relative residual of the solutions of an estimate.
constexpr double solved_to = 1e-3;
/// Part of the work from which loads along a component count, and part of the displacement from which the component does.
constexpr double least_work = 1e-9, least_component = 0.1;

struct Displacement {
  Values unknowns, known;
};

Displacement combined(double a, const Displacement& u, double b, const Displacement& v) {
  Displacement w = u;
  for (std::size_t i = 0; i < w.unknowns.size(); ++i) w.unknowns[i] = a * u.unknowns[i] + b * v.unknowns[i];
  for (std::size_t i = 0; i < w.known.size(); ++i) w.known[i] = a * u.known[i] + b * v.known[i];
  return w;
}

/// Internal forces F of the body at large strain.
class Forces {
 public:
  explicit Forces(const SolidBody& body) : n_(body.elastic().n_unknowns()) {
    const char* name =
        body.elastic().volume_by_cells() ? "nearly-incompressible-neo-hookean" : "saint-venant-kirchhoff";
    std::vector<elastic::FiniteLaw> all;
    for (const SolidMaterial& material : materials_of(body.parameters()))
      all.push_back(laws::of(name)->make(lame_constants(body.parameters(), material), {}));
    kernel_ = std::make_unique<elastic::FiniteKernel>(body.mesh(), body.elastic(), std::move(all));
  }
  struct Parts {
    Values even, odd;
  };
  /// [F(s u) +- F(-s u)] / 2.
  Parts parts(double s, const Displacement& u) {
    const Values plus = at(combined(s, u, 0, u)), minus = at(combined(-s, u, 0, u));
    Parts result{Values(n_), Values(n_)};
    for (std::size_t i = 0; i < n_; ++i) {
      result.even[i] = 0.5 * (plus[i] + minus[i]);
      result.odd[i] = 0.5 * (plus[i] - minus[i]);
    }
    return result;
  }

 private:
  Values at(const Displacement& u) {
    Values force(n_);
    kernel_->linearise(u.unknowns, u.known, 0, force);
    return force;
  }

  std::size_t n_;
  std::unique_ptr<elastic::FiniteKernel> kernel_;
};

/// Root of x - a x^3 = 1 on the branch from zero load; NaN if the load has a maximum before.
double amplitude(double a) {
  if (a > 4. / 27) return std::numeric_limits<double>::quiet_NaN();
  double x = a > 0 ? 1 : 1 / (1 - a);  // below the root, where Newton's method closes in from one side
  for (int k = 0; k < 60; ++k) x -= (x - a * x * x * x - 1) / (1 - 3 * a * x * x);
  return x;
}

/// See LargeStrainEstimate.
LargeStrainEstimate summed(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const Values& u1,
                           const Values& u2, const Values& u3) {
  const std::size_t n = std::size_t(mesh.cells.n_owned()) * mesh.dim;
  const auto dot = [&](const auto& a, const auto& b) {
    double local = 0;
    for (std::size_t i = 0; i < n; ++i) local += geometry.volume[i / std::size_t(mesh.dim)] * a(i) * b(i);
    return parallel::sum(mesh.comm, local);
  };
  const auto first = [&](std::size_t i) { return u1[i]; };
  const auto second = [&](std::size_t i) { return u2[i]; };
  const auto third = [&](std::size_t i) { return u3[i]; };
  LargeStrainEstimate e;
  const double size = dot(first, first), size2 = dot(second, second);
  e.ratio = size2 > 0 ? dot(third, second) / size2 : 0;
  const auto rest = [&](std::size_t i) { return u3[i] - e.ratio * u2[i]; };
  e.cubic = dot(rest, first) / size;
  const double x = e.ratio < 1 ? amplitude(e.cubic) : std::numeric_limits<double>::quiet_NaN();
  const auto change = [&](std::size_t i) {
    return (x - 1) * u1[i] + x * x / (1 - e.ratio) * u2[i] + x * x * x * (rest(i) - e.cubic * u1[i]);
  };
  e.change = std::sqrt(dot(change, change) / size);
  for (int a = 0; a < mesh.dim; ++a) {
    const auto along = [&](const auto& values) {
      return [&, a](std::size_t i) { return i % std::size_t(mesh.dim) == std::size_t(a) ? values(i) : 0; };
    };
    const double part = dot(along(first), along(first)), moved = dot(along(change), along(change));
    if (!(part > least_component * least_component * size)) continue;
    if (const double of = std::sqrt(moved / part); !(of <= e.change)) e.change = of, e.component = a;
  }
  return e;
}

}  // namespace

std::string LargeStrainEstimate::text() const {
  if (!is_known())
    return "large strain: the expansion about the linear solution has no equilibrium under the full load; "
           "the body would snap or buckle, or the load is far too large for linear theory";
  return fmt::format("large strain would change the displacement{} by about {:.3g} %",
                     component < 0 ? "" : fmt::format(" along {}", "xyz"[std::size_t(component)]),
                     100 * change);
}

std::optional<LargeStrainEstimate> estimate_large_strain(const SolidBody& body, SolutionMethod& method,
                                                         std::span<const double> unknowns,
                                                         std::span<const double> known,
                                                         double& gradient_seen) {
  const mesh::Mesh& mesh = body.mesh();
  double steepest = 0;
  body.kernel().face_gradients(
      unknowns, known, [&](Index, const Tensor3& g) { steepest = std::max(steepest, g.norm()); }, 0,
      mesh.n_flux_faces());
  steepest = parallel::max(mesh.comm, steepest);
  if (!(steepest > steeper * gradient_seen)) return {};
  gradient_seen = steepest;
  const Displacement u1{{unknowns.begin(), unknowns.end()}, {known.begin(), known.end()}};
  const double s = probe_gradient / steepest;
  Forces forces(body);
  const std::size_t n = u1.unknowns.size();
  const auto dot = [&](const Values& a, const Values& b) {
    double local = 0;
    for (std::size_t i = 0; i < n; ++i) local += a[i] * b[i];
    return parallel::sum(mesh.comm, local);
  };
  const auto [even, odd] = forces.parts(s, u1);
  const Values odd2 = forces.parts(2 * s, u1).odd;
  Values q(n), c(n);
  for (std::size_t i = 0; i < n; ++i) {
    q[i] = -even[i] / (s * s);
    c[i] = (odd2[i] - 2 * odd[i]) / (6 * s * s * s);
  }
  const elastic::ElasticField field{unknowns, known};
  const double work =
      parallel::sum(mesh.comm, body.kernel().product(elastic::ElasticPart::stiffness, field, field));
  // The parts of u1 in Q and C over its work: of the whole displacement, and of each component that loads move, since a strip
  // that is pulled hard is stiffer across though its work along hides it.
  const auto dim = std::size_t(mesh.dim);
  double share = 0;
  for (std::size_t a = 0; a <= dim; ++a) {
    std::array<double, 3> sums{};
    for (std::size_t i = 0; i < n; ++i) {
      if (a < dim && i % dim != a) continue;
      sums[0] += (8 * odd[i] - odd2[i]) / (6 * s) * u1.unknowns[i];
      sums[1] += q[i] * u1.unknowns[i];
      sums[2] += c[i] * u1.unknowns[i];
    }
    MPI_Allreduce(MPI_IN_PLACE, sums.data(), int(sums.size()), MPI_DOUBLE, MPI_SUM, mesh.comm);
    const double of = a == dim ? work : std::abs(sums[0]);
    if (of > least_work * work) share = std::max(share, (std::abs(sums[1]) + std::abs(sums[2])) / of);
  }
  if (steepest + share < harmless) return {};
  const auto apply = [&](std::span<const double> x, std::span<double> y) { body.kernel().apply(x, {}, y); };
  const auto precondition = [&](std::span<const double> x, std::span<double> y) {
    method.approximate_inverse(x, y);
  };
  linalg::KrylovSolver loosely("displacement by large strain", mesh.comm, n, apply, precondition);
  const linalg::KrylovOptions options{.relative_tolerance = solved_to,
                                      .max_iterations = body.parameters().method.max_iterations,
                                      .is_symmetric = true};
  const auto solve = [&](const Values& b) {
    Values u(n, 0);
    method.approximate_inverse(b, u) ? void(loosely.solve(b, u, options)) : void(method.solve(b, u));
    return u;
  };
  const Displacement u2{solve(q), Values(known.size(), 0)};
  // Scales u2 to the size of u1, so that differences resolve both.
  const double size2 = std::sqrt(dot(u2.unknowns, u2.unknowns));
  const double t = size2 > 0 ? std::sqrt(dot(u1.unknowns, u1.unknowns)) / size2 : 1;
  const Values with = forces.parts(s, combined(1, u1, t, u2)).even,
               without = forces.parts(s, combined(1, u1, -t, u2)).even;
  Values r(n);
  for (std::size_t i = 0; i < n; ++i) r[i] = -(with[i] - without[i]) / (2 * s * s * t) - c[i];
  return summed(mesh, body.geometry(), u1.unknowns, u2.unknowns, solve(r));
}

// Heat, a seat, rigid patches, rings and orthotropic bodies are outside the expansion.
void LargeStrainChange::observe(diagnostics::Report&) {
  const SolidBody& body = view_.body;
  const SolidParameters& p = body.parameters();
  SolutionMethod* method = view_.stepper.method();
  if (body.is_dynamic() || !method || !body.kernel().is_symmetric() || is_axisymmetric(body.elastic()) ||
      has_orthotropic(p) || p.expansion || p.contact || !body.rigid().empty() || p.seeks_buckling)
    return;
  try {
    const auto found = estimate_large_strain(body, *method, view_.stepper.last_solve().unknowns,
                                             view_.now().known, gradient_seen_);
    is_bounded_ = true;
    if (found && (!estimate_ || !found->is_known() || found->change > estimate_->change)) estimate_ = found;
  } catch (const SolveFailure& failure) {
    is_bounded_ = false;
    log::warn("The estimate of large strain failed: {}", failure.what());
  }
}

void LargeStrainChange::visit(io::Archive& archive) {
  archive.common("large-strain", estimate_, is_bounded_, gradient_seen_);
}

}  // namespace couplet::solid
