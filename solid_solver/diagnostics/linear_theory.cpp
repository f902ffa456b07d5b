// SPDX-License-Identifier: Apache-2.0

#include "solid_solver/diagnostics/linear_theory.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/elasticity/finite/finite_kernel.hpp"
#include "common/io/checkpoint.hpp"
#include "common/linalg/krylov.hpp"
#include "common/log/log.hpp"
#include "common/modes/pencil.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/boundary/checks.hpp"
#include "solid_solver/diagnostics/neglected.hpp"
#include "solid_solver/diagnostics/view.hpp"
#include "solid_solver/laws/laws.hpp"
#include "solid_solver/method/newton_krylov.hpp"

namespace couplet::solid {
namespace {

/// Reports what small strain neglects: by the largest gradient, by the distance from buckling, and where it may matter by an
/// expansion beyond the linear solution.
class LinearTheory final : public diagnostics::Diagnostic {
 public:
  explicit LinearTheory(const SolidView& view) : view_(view) {}

  void observe(diagnostics::Report& report) override {
    expand();
    if (!view_.body.is_dynamic()) see_buckling(report);
  }

  void look(diagnostics::Report& report) override {
    Deformation now = view_.fields.deformation(view_.fields.point_displacement());
    largest_gradient_ = now.gradient = std::max(largest_gradient_, now.gradient);
    const bool is_low = buckling_factor_ < BucklingEstimate::low;
    add(report, neglected_geometry(view_.body.parameters(), now, large_strain_, is_bounded_,
                                   is_low ? buckling_factor_ : std::numeric_limits<double>::quiet_NaN()));
    add(report, unknown_yielding(view_.body.parameters(), now.strain));
  }

  void conclude(diagnostics::Report& report) override {
    if (view_.body.is_dynamic()) see_buckling(report);
    const auto factor = view_.output.buckling_factor();
    if (factor && !view_.body.parameters().seeks_buckling)
      add(report, buckling_finding({.factor = *factor}, ""));
  }

  void visit(io::Archive& archive) override {
    archive.common("linear", largest_gradient_, large_strain_, is_bounded_, gradient_seen_, buckling_factor_,
                   compression_seen_);
  }

 private:
  /// The largest change of the run. Heat, a seat, rigid patches, rings and orthotropic bodies are outside the expansion.
  void expand() {
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
      if (found && (!large_strain_ || !found->is_known() || found->change > large_strain_->change))
        large_strain_ = found;
    } catch (const SolveFailure& failure) {
      is_bounded_ = false;
      log::warn("The estimate of large strain failed: {}", failure.what());
    }
  }

  void see_buckling(diagnostics::Report& report) {
    const SolidBody& body = view_.body;
    SolutionMethod* method = view_.stepper.method();
    if (!method || !body.kernel().is_symmetric() || is_axisymmetric(body.elastic()) ||
        body.parameters().output.buckling > 0 || body.parameters().output.modes > 0)
      return;
    for (const FreeMotion& free : free_motions(body.mesh(), body.elastic()))
      if (!free.modes.empty())
        return report.sentences.push_back(
            fmt::format("nothing holds the solid: {}; a body that can move freely has no buckling load.",
                        base::join(free.modes)));
    const BucklingEstimate found =
        estimate_buckling(body, view_.fields, view_.stepper, *method, compression_seen_);
    if (!found.matters()) return;
    buckling_factor_ = std::min(buckling_factor_, found.factor);
    add(report, body.is_dynamic() ? dynamic_buckling_finding(found) : buckling_finding(found, "at most "));
  }

  SolidView view_;
  double largest_gradient_ = 0;
  std::optional<LargeStrainEstimate> large_strain_;  // empty if it cannot matter
  bool is_bounded_ = false;                          // its first terms are known
  double gradient_seen_ = 0;                         // at the last look at large strain
  double buckling_factor_ = BucklingEstimate::low;   // lowest of the run
  double compression_seen_ = 0;                      // at the last look at buckling [Pa]
};

}  // namespace

diagnostics::Made linear_theory(const SolidView& view) {
  if (has_finite_strain(view.body.parameters())) return nullptr;
  return std::make_shared<LinearTheory>(view);
}

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

namespace {

// Compressive strain times (L/t)^2. A clamped column buckles at 0.2; slenderness() uses half its thickness
// for a square column, hence a fourth, with a margin. Plates and arches are far above.
constexpr double least_strain = 0.9 * 0.2 / 4 / BucklingEstimate::low;
// Tolerance of the solution in which a negative curvature of K + low K_sigma would appear.
constexpr double shown_at = 1e-3;
constexpr int most_searches = 2000, most_refinements = 40, refinements_compared = 6;
// Factor over `low` of a load that needs no search, and changes in the refinements that show it: part of what is missing to
// such a load, and of the value.
constexpr double far_load = 4, part_of_missing = 0.1, roughly_settled = 0.5;
// Increase of compression since the last search that justifies another one.
constexpr double more_compression = 1.1;
// Largest relative change in the last refinements for a factor to be reported.
constexpr double settled_part = 0.01;

bool has_settled(const std::vector<double>& rho, double part) {
  return rho.size() > refinements_compared &&
         rho[rho.size() - 1 - refinements_compared] - rho.back() < part * std::abs(rho.back());
}

double limit_of(const BucklingEstimate& found) {
  return found.factor < BucklingEstimate::imperfect ? BucklingEstimate::imperfect : BucklingEstimate::low;
}

std::string neglected(const BucklingEstimate& found) {
  return "linear theory neglects the softening by these loads" +
         (found.growth > BucklingEstimate::most_growth
              ? fmt::format(", which adds {:.2g} of the displacement", found.growth)
              : std::string());
}

/// Components below this part of the displacement are not judged by themselves.
constexpr double least_part = 0.1;

/// |a x| / |u| / (factor - 1), RMS over cells, of the component where it is largest: a frame under its load moves sideways less
/// than it shortens. The part a of u along x is by the K-orthogonality of modes.
double growth_of(const SolidBody& body, const std::vector<double>& u, const std::vector<double>& x,
                 double factor) {
  const mesh::Mesh& mesh = body.mesh();
  if (!(factor > 1)) return std::numeric_limits<double>::infinity();
  std::vector<double> force(x.size());
  body.kernel().apply(x, {}, force);
  std::array<double, 8> sums{};  // u.Kx, x.Kx, then u^2 and x^2 of each component
  for (std::size_t i = 0; i < x.size(); ++i) sums[0] += u[i] * force[i], sums[1] += x[i] * force[i];
  const std::size_t dim = mesh.dim;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c)
    for (std::size_t a = 0; a < dim; ++a) {
      const std::size_t i = std::size_t(c) * dim + a;
      sums[2 + a] += body.geometry().volume[c] * u[i] * u[i];
      sums[5 + a] += body.geometry().volume[c] * x[i] * x[i];
    }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), int(sums.size()), MPI_DOUBLE, MPI_SUM, mesh.comm);
  if (!(sums[1] > 0)) return 0;
  double largest = 0;
  for (std::size_t a = 0; a < dim; ++a)
    if (sums[2 + a] > least_part * least_part * (sums[2] + sums[3] + sums[4]))
      largest = std::max(largest, std::sqrt(sums[5 + a] / sums[2 + a]));
  return std::abs(sums[0] / sums[1]) * largest / (factor - 1);
}

}  // namespace

std::optional<diagnostics::Finding> dynamic_buckling_finding(const BucklingEstimate& found) {
  if (!found.matters()) return {};
  return diagnostics::Finding{
      .id = "buckling",
      .number = found.factor,
      .limit = limit_of(found),
      .sentence = fmt::format("buckling: load factor at most {:.3g} (limit {:g}) of the last state: {}",
                              found.factor, limit_of(found),
                              found.factor < 1
                                  ? "if these loads last, the body buckles; linear theory does not show it"
                                  : neglected(found)),
      .advice = "use 'kinematics: finite-strain'"};
}

std::optional<diagnostics::Finding> buckling_finding(const BucklingEstimate& found, const char* how) {
  if (!found.matters()) return {};
  const bool holds = found.factor >= 1;
  const double limit = holds ? limit_of(found) : 1;
  return diagnostics::Finding{
      .id = "buckling",
      .severity = holds ? base::Severity::warning : base::Severity::wrong,
      .number = found.factor,
      .limit = limit,
      .sentence = fmt::format("buckling: load factor {}{:.3g} (limit {:g}): {}", how, found.factor, limit,
                              holds ? neglected(found) : "the computed equilibrium is unstable"),
      .advice =
          holds ? "use 'kinematics: finite-strain'; 'analysis: buckling' gives factors and shapes"
                : "reduce the loads, stiffen the body or add supports; 'analysis: buckling' gives factors "
                  "and shapes, 'kinematics: finite-strain' with a small lateral load the post-buckling "
                  "state"};
}

BucklingEstimate estimate_buckling(const SolidBody& body, const SolidFields& fields,
                                   const SolidStepper& stepper, SolutionMethod& method,
                                   double& compression_seen) {
  const mesh::Geometry& geometry = body.geometry();
  const mesh::Mesh& mesh = body.mesh();
  const SolidState& state = stepper.state();
  elastic::Prestress prestress = prestress_of(body, fields, state.time, stepper.last_solve().interface);
  double softest = 1e300;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    const elastic::LameConstants lame = body.elastic().lame(c);
    softest = std::min(softest, lame.mu * (3 * lame.lambda + 2 * lame.mu) / (lame.lambda + lame.mu));
  }
  const double here = compression(mesh, prestress), ratio = slenderness(mesh, geometry);
  if (!(here > more_compression * compression_seen)) return {};
  if (!(here / parallel::min(mesh.comm, softest) * ratio * ratio >= least_strain)) return {};
  // Given as forces, to excite soft motions: errors in stiff ones would stop the iteration earlier.
  const std::vector<double> force = body.any_start();
  std::vector<double> of_stress(force.size());
  if (!method.approximate_inverse(force, of_stress)) return {};
  compression_seen = here;
  elastic::StressStiffness stress(mesh, body.elastic(), std::move(prestress));
  const modes::Pencil of{
      .comm = mesh.comm,
      .n = force.size(),
      .k = [&](std::span<const double> x, std::span<double> y) { stress.apply(x, y); },
      .m = [&](std::span<const double> x, std::span<double> y) { body.kernel().apply(x, {}, y); },
      .solve = [&](std::span<const double> r, std::span<double> z) { method.approximate_inverse(r, z); }};
  const auto look = [&](double load) {
    const linalg::LinearMap loaded = [&, load](std::span<const double> x, std::span<double> y) {
      of.m(x, y);
      of.k(x, of_stress);
      for (std::size_t i = 0; i < y.size(); ++i) y[i] += load * of_stress[i];
    };
    return modes::look_for_negative_curvature(mesh.comm, loaded, of.solve, force, shown_at, most_searches);
  };
  // Only a solve shows that no motion at all is soft, but refinements that settle tell that none is anywhere near.
  const double near = -1 / (far_load * BucklingEstimate::low);
  const auto told = [&](const std::vector<double>& rho) {
    if (rho.back() < near) return has_settled(rho, settled_part);
    const double missing = part_of_missing * (rho.back() - near) / std::abs(rho.back());
    return has_settled(rho, std::min(missing, roughly_settled));
  };
  // -1 / lambda
  modes::LowestQuotient least = modes::lowest_quotient(of, of_stress, most_refinements, told);
  if (least.value > near && least.iterations < most_refinements)
    return {.factor = 0, .iterations = least.iterations};
  if (least.value > -1 / BucklingEstimate::low || least.iterations == most_refinements) {
    modes::Curvature found = look(BucklingEstimate::low);
    if (!found.is_negative) return {.factor = 0, .iterations = found.iterations};
    // Fewer motions are soft under less load, so this one is closer to the softest.
    if (modes::Curvature closer = look(BucklingEstimate::imperfect); closer.is_negative) {
      closer.iterations += found.iterations;
      found = std::move(closer);
    }
    least = modes::lowest_quotient(of, found.x, most_refinements, told);
    least.iterations += found.iterations;
  }
  const double factor = -1 / least.value;
  return {.factor = factor,
          .growth = growth_of(body, body.unknowns_of(state.cell_u, state.face_u), least.x, factor),
          .iterations = least.iterations};
}

}  // namespace couplet::solid
