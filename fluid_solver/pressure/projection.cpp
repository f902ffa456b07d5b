// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/pressure/pressure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::fluid {
namespace {

// Absolute tolerance of the pressure equation relative to the fluxes. Below it there is only round-off, on
// which a relative tolerance would stall (uniform flow, fluid at rest).
constexpr double flux_floor = 3e-15;
// Largest non-orthogonality [degree] at which two passes are stable after an implicit predictor; 50 is not.
constexpr double largest_degrees = 40;

constexpr int oblique_passes = 2, most_oblique_passes = 200;
constexpr double standing = 1e-3;  // change of the pressure gradient in a pass
constexpr linalg::Acceleration gradient_acceleration{linalg::Acceleration::Type::anderson, 1, 6};
// The first pass only provides the gradient of the non-orthogonal part for the second one, which reduces its
// error by that part's share of the operator.
constexpr double first_pass_tolerance = 10, loosest_tolerance = 0.5;

template <int D>
Terms<D> make_terms(const Scene<D>& scene, const FluidStep<D>& step, const Prediction<D>& prediction) {
  Terms<D> terms;
  add_wall_terms(scene, step, prediction, terms);
  add_compressible_terms(scene, step, prediction, terms);
  add_end_terms(scene, step, prediction, terms);
  return terms;
}

}  // namespace

template <int D>
PressureProjection<D>::PressureProjection(const Scene<D>& scene, const FluidStep<D>& step,
                                          const Prediction<D>& prediction, Projected<D>& result, bool moving)
    : scene_(scene),
      mesh_(scene.mesh),
      step_(step),
      prediction_(prediction),
      out_(result),
      terms_(make_terms(scene, step, prediction)),
      equation_(scene.mesh, scene.boundary,
                !moving && scene.parameters.bodies.empty() &&
                    std::ranges::none_of(terms_, [](const auto& term) { return term->is_in_matrix(); })) {}

template <int D>
void PressureProjection<D>::prepare(const State<D>& from) {
  extrapolate_pressure();
  for (const auto& term : terms_) term->prepare(from);
  assemble();
}

template <int D>
void PressureProjection<D>::assemble() {
  const bool same =
      assembled_ && (assembled_ == step_.to || (step_.to->shape && assembled_->shape == step_.to->shape));
  std::vector<double> versions;
  for (const auto& term : terms_) versions.push_back(term->version());
  if (same && versions == versions_) return;
  if (scene_.oblique) set_obliqueness(*step_.to);
  Diagonal added;
  for (const auto& term : terms_) term->add_to_diagonal(added);
  equation_.set(scene_.around(step_),
                std::ranges::any_of(terms_, [](const auto& term) { return term->sets_level(); }), added);
  assembled_ = step_.to;
  versions_ = std::move(versions);
  for (const auto& term : terms_) term->respond(equation_);
}

template <int D>
void PressureProjection<D>::start(const Placement<D>& at) {
  set_obliqueness(at);
  equation_.set(scene_.around(step_));
  assembled_ = step_.to;
  versions_.assign(terms_.size(), 0.0);
}

template <int D>
void PressureProjection<D>::set_obliqueness(const Placement<D>& at) {
  degrees_ = std::atan(parallel::max(mesh_.comm, at.obliqueness)) * 180 / std::numbers::pi;
}

/// p~ at t^{n+1/2}, the guess of the pressure equation, extrapolated from the available levels (three only if
/// solver noise is small), and the first non-orthogonal gradient, extrapolated linearly from two. With its
/// share q < 1 of the operator, two passes give z^2 = q^2 (2 z - 1), |z| = q, so nothing is amplified. A
/// parabola would require q < 0.7, a single pass q < 1/3.
template <int D>
void PressureProjection<D>::extrapolate_pressure() {
  const std::size_t order = scene_.parameters.pressure_tolerance >= 1e-3 ? 2 : 3;
  const double t = step_.middle();
  std::vector<const PressureLevel<D>*> levels;
  for (std::size_t k = 0; k < order && step_.by.pressure[k]; ++k)
    levels.push_back(step_.by.pressure[k].get());
  std::array<double, 3> weight{1, 1, 1};
  for (std::size_t k = 0; k < levels.size(); ++k)
    for (std::size_t j = 0; j < levels.size(); ++j)
      if (j != k) weight[k] *= (t - levels[j]->time) / (levels[k]->time - levels[j]->time);
  if (levels.size() == 3) {
    out_.p.resize(mesh_.cells.n_local());
    for (std::size_t c = 0; c < out_.p.size(); ++c)
      out_.p[c] = weight[0] * levels[0]->p[c] + weight[1] * levels[1]->p[c] + weight[2] * levels[2]->p[c];
  } else {
    out_.p.assign(mesh_.cells.n_local(), 0.0);
    for (std::size_t k = 0; k < levels.size(); ++k)
      for (std::size_t c = 0; c < out_.p.size(); ++c) out_.p[c] += weight[k] * levels[k]->p[c];
  }
  side_.ends.clear();
  for (std::size_t k = 0; k < levels.size(); ++k) {
    side_.ends.resize(levels[k]->ends.size(), 0.0);
    for (std::size_t i = 0; i < side_.ends.size(); ++i) side_.ends[i] += weight[k] * levels[k]->ends[i];
  }
  gradient_start_.clear();
  if (!scene_.oblique || levels.empty()) return;
  gradient_start_ = levels[0]->gradient;
  if (levels.size() < 2 || levels[1]->gradient.empty()) return;
  const double ahead = (t - levels[0]->time) / (levels[0]->time - levels[1]->time);
  for (std::size_t c = 0; c < gradient_start_.size(); ++c)
    gradient_start_[c] += ahead * (levels[0]->gradient[c] - levels[1]->gradient[c]);
}

template <int D>
void PressureProjection<D>::start_from(const PressureLevel<D>* level) {
  if (!level) return extrapolate_pressure();
  out_.p = level->p;
  side_.ends = level->ends;
  if (scene_.oblique) gradient_start_ = level->gradient;
}

/// phi^p without and with -(dt/rho) grad p~ . k.
template <int D>
void PressureProjection<D>::add_oblique_pressure(const std::vector<double>& phi) {
  const Placement<D>& now = *step_.to;
  const double factor = step_.dt / scene_.fluid.rho;
  const Placement<D>& around = scene_.around(step_);
  out_.phi = phi;
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const double w = now.weight[f];
    out_.phi[f] -= factor * (w * out_.gradient[mesh_.owner[f]] + (1 - w) * out_.gradient[mesh_.neighbour[f]])
                                .dot(around.oblique_of(f));
  }
  for (const Index b : scene_.boundary.rows().of_pressure) {
    const Index f = mesh_.n_interior + b;
    out_.phi[f] -= factor * out_.gradient[mesh_.owner[f]].dot(around.oblique_of(f));
  }
}

/// Non-orthogonal meshes use passes: the first with the extrapolated gradient, later ones with that of the
/// previous pass. Two suffice without an old pressure in the prediction (|z| = q, see extrapolate_pressure()),
/// or for small q. An implicit predictor and a flux with the smooth excess return the old pressure without smoothing,
/// and above about 45 degrees the rest of two passes grows; then passes continue until the gradient converges.
template <int D>
void PressureProjection<D>::project(const State<D>& from, const Vectors<D>& w, const std::vector<double>& phi,
                                    double answer) {
  out_.w = prediction_.w;
  out_.gradient = gradient_start_;
  const bool to_the_end =
      scene_.oblique && degrees_ > largest_degrees && (step_.by.implicit || scene_.has_smooth_excess());
  const int passes = to_the_end ? most_oblique_passes : scene_.oblique ? oblique_passes : 1;
  for (int pass = 1; pass <= passes; ++pass) {
    if (out_.gradient.empty())
      out_.phi = phi;
    else
      add_oblique_pressure(phi);
    const double tolerance =
        (pass < passes ? first_pass_tolerance : 1) * scene_.parameters.pressure_tolerance;
    solve_pressure(from, w, std::min(tolerance, loosest_tolerance), answer);
    if (pass == passes && to_the_end && step_.by.implicit)
      throw SolveFailure(
          "The non-orthogonal correction of the pressure equation did not converge in {} iterations at t = {:.6g} s: the mesh "
          "is too skewed, {:.0f} degrees between a face normal and the line of its cell centers.",
          passes, step_.end(), degrees_);
    if (pass == passes) break;
    if (to_the_end) gradient_before_ = out_.gradient;
    pressure_gradient(*step_.to, out_.p, out_.boundary, nullptr, out_.gradient);
    for (Index c = 0; c < mesh_.cells.n_owned(); ++c) out_.gradient[c] /= step_.to->volume[c];
    const bool stands = to_the_end && mix_gradients(pass);
    mesh_.cells.update_ghosts(flat<D>(out_.gradient), D);
    if (stands && pass >= oblique_passes) break;
  }
  set_rotational();
}

/// Gradient for the next pass, by Anderson acceleration. A mode of a few cells that decreases by 0.97 per
/// pass at a face of 87 degrees then takes a dozen passes instead of two hundred. Returns true if the
/// gradient has converged, or is made of rounding. Collective.
template <int D>
bool PressureProjection<D>::mix_gradients(int pass) {
  const std::size_t owned = static_cast<std::size_t>(mesh_.cells.n_owned()) * D;
  if (!accelerator_)
    accelerator_ = std::make_unique<linalg::VectorAccelerator>(mesh_.comm, owned, gradient_acceleration);
  if (pass == 1) accelerator_->restart();
  gradient_before_.resize(out_.gradient.size(), Vec<D>::Zero());
  double sums[2] = {0, 0};
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    sums[1] += out_.gradient[c].squaredNorm();
    out_.gradient[c] -= gradient_before_[c];
    sums[0] += out_.gradient[c].squaredNorm();
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, mesh_.comm);
  accelerator_->advance(flat<D>(gradient_before_).first(owned), flat<D>(out_.gradient).first(owned));
  out_.gradient.swap(gradient_before_);
  return sums[0] <= standing * standing * sums[1] || (pass > oblique_passes && sums[0] <= rounding());
}

/// Square of the gradient that rounding leaves in a fluid at rest: of the pressure, and of the potential that it balances.
template <int D>
double PressureProjection<D>::rounding() const {
  const auto psi = scene_.potential(step_.end());
  Vec3 x = Vec3::Zero();
  double square = 0;
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    x.template head<D>() = step_.to->centre[c];
    const double size = std::abs(out_.p[c]) + (psi ? scene_.fluid.rho * std::abs(psi(x)) : 0);
    const double noise = 64 * std::numeric_limits<double>::epsilon() * size;
    square += noise * noise * std::pow(step_.to->volume[c], -2. / D);
  }
  return parallel::sum(mesh_.comm, square);
}

template <int D>
void PressureProjection<D>::set_boundary_flux(const Vectors<D>& w) {
  const BoundaryRows& rows = scene_.boundary.rows();
  for (const Index b : rows.of_velocity) out_.w[b] = w[b];
  for (const Index b : rows.of_flux) {
    const Index f = mesh_.n_interior + b;
    out_.phi[f] = out_.w[b].dot(step_.to->area[f]);
  }
  scene_.obstacles->block(step_, rows.of_flux, out_.phi);
  for (const auto& term : terms_) term->balance(equation_, out_);
}

template <int D>
void PressureProjection<D>::solve_pressure(const State<D>& from, const Vectors<D>& w, double tolerance,
                                           double answer) {
  const Placement<D>&now = *step_.to, &around = scene_.around(step_);
  const double factor = scene_.fluid.rho / step_.dt;
  set_boundary_flux(w);
  out_.boundary.assign(w.size(), 0.0);
  scene_.boundary.pressure_at(step_.middle(), now.boundary_centre, out_.boundary);
  if (const auto potential = scene_.potential(step_.middle()))
    for (const Index b : scene_.boundary.rows().of_pressure)
      out_.boundary[b] -= scene_.fluid.rho * potential(now.boundary_centre[b]);
  for (const auto& term : terms_) term->foresee(from, out_);
  side_.floor = 0;
  side_.known.clear();
  side_.b.assign(mesh_.cells.n_local(), 0.0);
  double size = subtract_outflow(mesh_, factor, out_.phi, side_.b);
  for (std::size_t b = 0; b < w.size(); ++b) {
    const Index f = mesh_.n_interior + static_cast<Index>(b);
    side_.b[mesh_.owner[f]] -= factor * out_.phi[f];
    size += out_.phi[f] * out_.phi[f];
    side_.b[mesh_.owner[f]] += scene_.boundary.rows().pressure[b] * around.conductance[f] * out_.boundary[b];
  }
  scene_.obstacles->before(side_.b, out_.p);
  side_.b.resize(mesh_.cells.n_owned());
  side_.size = has_level_ ? equation_.size_without_level(around, side_.b, out_.boundary, tolerance) : -1;
  for (const auto& term : terms_) term->before(out_, side_);
  const double floor =
      std::max(side_.floor, flux_floor * factor * std::sqrt(parallel::sum(mesh_.comm, size)));
  const linalg::SolveStatistics solved =
      equation_.solve(now, side_.b, out_.p, tolerance, std::max(floor, std::numeric_limits<double>::min()),
                      answer, side_.size);
  iterations_ += solved.iterations;
  for (std::size_t c = 0; c < side_.known.size(); ++c) out_.p[c] += side_.known[c];
  scene_.obstacles->after(now, out_.p);
  for (const auto& term : terms_) term->after(out_);
  set_boundary_pressure(from);
}

/// Wall: grad p . S = -(rho/dt)(w^{n+1} - w^n).S, the added-mass pressure, exact for a rigidly moving box.
/// Then p_b = p_P + (grad p . S - grad p~ . k)/g.
template <int D>
void PressureProjection<D>::set_boundary_pressure(const State<D>& from) {
  const Placement<D>& now = *step_.to;
  for (const Index b : scene_.boundary.rows().of_flux) {
    const Index f = mesh_.n_interior + b, p = mesh_.owner[f];
    const Vec<D> acceleration = (out_.w[b] - from.w[b]) / step_.dt;
    double normal = -scene_.fluid.rho * acceleration.dot(now.area[f]);
    if (!prediction_.force.empty()) normal += scene_.fluid.rho * prediction_.force[p].dot(now.area[f]);
    if (!prediction_.beside_walls.empty())
      normal += scene_.fluid.rho * prediction_.beside_walls[b].dot(now.area[f]);
    if (!out_.gradient.empty()) normal -= out_.gradient[p].dot(now.oblique_of(f));
    out_.boundary[b] = out_.p[p] + normal / now.conductance[f];
  }
}

/// sum p_f S per local cell, p_f linear between the cells; on skewed meshes corrected to the face center by
/// the gradient, exact for linear p.
template <int D>
void PressureProjection<D>::pressure_gradient(const Placement<D>& at, const std::vector<double>& p,
                                              const std::vector<double>& boundary,
                                              const FluxCorrection* correction, Vectors<D>& sum) const {
  sum.assign(mesh_.cells.n_local(), Vec<D>::Zero());
  add_pressure(mesh_, at, p, correction, sum);
  for (std::size_t b = 0; b < boundary.size(); ++b) {
    const Index f = mesh_.n_interior + static_cast<Index>(b);
    sum[mesh_.owner[f]] += boundary[b] * at.area[f];
  }
  const Obstacles<D>& obstacles = *scene_.obstacles;
  obstacles.part(at, p, nullptr, at.area, sum);
  if (!at.skewed()) return;
  const bool clears = !obstacles.has_pressure();  // deeper cells have no pressure
  if (clears) obstacles.clear(sum);
  Vectors<D> gradient(sum.size());
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
    gradient[c] = at.gradient_cure[c].transpose() * sum[c] / at.volume[c];
  mesh_.cells.update_ghosts(flat<D>(gradient), D);
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Vec<D> part = skew_part<D>(mesh_, at, gradient, f) * at.area[f];
    sum[mesh_.owner[f]] += part;
    sum[mesh_.neighbour[f]] -= part;
  }
  if (clears) obstacles.clear(sum);
}

template <int D>
void PressureProjection<D>::set_gradient(const Placement<D>& at, PressureLevel<D>& level,
                                         const FluxCorrection* correction) const {
  pressure_gradient(at, level.p, level.boundary, correction, level.gradient);
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) level.gradient[c] /= at.volume[c];
  mesh_.cells.update_ghosts(flat<D>(level.gradient), D);
  if (scene_.fourth) scene_.fourth->sharpen(at, level.gradient);
}

template <int D>
void PressureProjection<D>::start(const Placement<D>& at, PressureLevel<D>& level) const {
  set_gradient(at, level, nullptr);
  for (const auto& term : terms_) term->start(at, level);
}

template <int D>
std::shared_ptr<PressureLevel<D>> PressureProjection<D>::pressure_level(
    const FluxCorrection* correction) const {
  auto level = std::make_shared<PressureLevel<D>>();
  level->time = step_.middle();
  level->p = out_.p;
  level->boundary = out_.boundary;
  set_gradient(*step_.to, *level, correction);
  for (const auto& term : terms_) term->complete(*level);
  return level;
}

template <int D>
void PressureProjection<D>::solve_initial(const Placement<D>& at) {
  side_.b.assign(mesh_.cells.n_local(), 0.0);
  double size = subtract_outflow(mesh_, 1, out_.phi, side_.b);
  for (Index f = mesh_.n_interior; f < mesh_.n_flux_faces(); ++f) {
    side_.b[mesh_.owner[f]] -= out_.phi[f];
    size += out_.phi[f] * out_.phi[f];
  }
  scene_.obstacles->before(side_.b, out_.p);
  side_.b.resize(mesh_.cells.n_owned());
  const double floor = 1e-14 * std::sqrt(parallel::sum(mesh_.comm, size));
  equation_.solve(at, side_.b, out_.p, std::min(1e-8, scene_.parameters.pressure_tolerance),
                  std::max(floor, std::numeric_limits<double>::min()));
  scene_.obstacles->after(at, out_.p);
}

/// With A = 1 - W - V^-1 G (L + O)^-1 D M of a step, where W is the part of the wall pressure and O the oblique part of L:
///   A* u = u - W u - V^-1 M^T D^T (L + O^T)^-1 G^T u
template <int D>
Vectors<D> PressureProjection<D>::adjoint(const Placement<D>& at, const Vectors<D>& u,
                                          const Vectors<D>& u_boundary) {
  const BoundaryRows& rows = scene_.boundary.rows();
  std::vector<double> flux(mesh_.n_flux_faces(), 0.0), jump = flux, psi(mesh_.cells.n_local(), 0.0);
  Vectors<D> known = u;
  for (int pass = 1;; ++pass) {
    transposed_flux(at, known, u_boundary, flux);
    std::vector<double> side(mesh_.cells.n_local(), 0.0);
    subtract_outflow(mesh_, 1, flux, side);
    for (Index f = mesh_.n_interior; f < mesh_.n_flux_faces(); ++f) side[mesh_.owner[f]] -= flux[f];
    side.resize(mesh_.cells.n_owned());
    iterations_ +=
        equation_
            .solve(at, side, psi, scene_.parameters.pressure_tolerance, std::numeric_limits<double>::min())
            .iterations;
    for (Index f = 0; f < mesh_.n_interior; ++f) jump[f] = psi[mesh_.neighbour[f]] - psi[mesh_.owner[f]];
    for (const Index b : rows.of_pressure)
      jump[mesh_.n_interior + b] = -psi[mesh_.owner[mesh_.n_interior + b]];
    if (!scene_.oblique || pass > oblique_passes) break;
    known = u;
    for (Index f = 0; f < mesh_.n_interior; ++f) {
      const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
      const Vec<D> part = jump[f] * at.oblique_of(f);
      known[p] -= at.weight[f] / at.volume[p] * part;
      known[n] -= (1 - at.weight[f]) / at.volume[n] * part;
    }
    mesh_.cells.update_ghosts(flat<D>(known), D);
  }
  Vectors<D> less = transposed_mean(at, jump), result = u;
  for (const Index b : rows.of_flux) {
    const Index f = mesh_.n_interior + b, p = mesh_.owner[f];
    less[p] += at.area[f].dot(u[p] - u_boundary[b]) / at.conductance[f] * at.area[f];
  }
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) result[c] -= less[c] / at.volume[c];
  return result;
}

/// Flux of a velocity with G^T u as its outflow: pressure_gradient() transposed, with the given flux through walls.
template <int D>
void PressureProjection<D>::transposed_flux(const Placement<D>& at, const Vectors<D>& u,
                                            const Vectors<D>& u_boundary, std::vector<double>& flux) const {
  Vectors<D> v = u;
  if (at.skewed()) {
    Vectors<D> moved(u.size(), Vec<D>::Zero());
    for (Index f = 0; f < mesh_.n_interior; ++f) {
      const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
      const Vec<D> part = at.area[f].dot(u[p] - u[n]) * at.skew[f];
      moved[p] += at.weight[f] * part;
      moved[n] += (1 - at.weight[f]) * part;
    }
    for (Index c = 0; c < mesh_.cells.n_owned(); ++c) v[c] += at.gradient_cure[c] * moved[c] / at.volume[c];
    mesh_.cells.update_ghosts(flat<D>(v), D);
  }
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const double w = at.weight[f];
    flux[f] = ((1 - w) * v[mesh_.owner[f]] + w * v[mesh_.neighbour[f]]).dot(at.area[f]);
  }
  const BoundaryRows& rows = scene_.boundary.rows();
  for (std::size_t b = 0; b < u_boundary.size(); ++b) {
    const Index f = mesh_.n_interior + static_cast<Index>(b);
    flux[f] = (rows.pressure[b] > 0 ? v[mesh_.owner[f]] : u_boundary[b]).dot(at.area[f]);
  }
}

/// mean_flux() transposed: per cell, from a value per flux face.
template <int D>
Vectors<D> PressureProjection<D>::transposed_mean(const Placement<D>& at,
                                                  const std::vector<double>& value) const {
  Vectors<D> sum(mesh_.cells.n_local(), Vec<D>::Zero());
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const double w = at.flux_weight(f);
    const Vec<D> part = value[f] * at.area[f];
    sum[mesh_.owner[f]] += w * part;
    sum[mesh_.neighbour[f]] += (1 - w) * part;
  }
  const BoundaryRows& rows = scene_.boundary.rows();
  for (const Index b : rows.of_pressure) {
    const Index f = mesh_.n_interior + b;
    sum[mesh_.owner[f]] += value[f] * at.area[f];
  }
  if (!at.skewed()) return sum;
  std::vector<Tensor<D>> of_gradient(sum.size(), Tensor<D>::Zero());
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Tensor<D> half = 0.5 * value[f] * at.area[f] * at.offset(f).transpose();
    of_gradient[mesh_.owner[f]] += half;
    of_gradient[mesh_.neighbour[f]] += half;
  }
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
    of_gradient[c] = (of_gradient[c] * at.gradient_cure[c].transpose() / at.volume[c]).eval();
  mesh_.cells.update_ghosts(
      {of_gradient.empty() ? nullptr : of_gradient.front().data(), of_gradient.size() * D * D}, D * D);
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
    const Vec<D> part = (of_gradient[p] - of_gradient[n]) * at.area[f];
    sum[p] += at.weight[f] * part;
    sum[n] += (1 - at.weight[f]) * part;
  }
  for (Index f = mesh_.n_interior; f < mesh_.n_flux_faces(); ++f) {
    const Index b = f - mesh_.n_interior, p = mesh_.owner[f];
    const Vec<D> part = of_gradient[p] * at.area[f], n = at.area[f].normalized();
    const double t = rows.friction[b];
    sum[p] += (1 - t) * part - (1 - rows.pressure[b] - t) * part.dot(n) * n;
  }
  return sum;
}

template <int D>
void PressureProjection<D>::accept() {
  equation_.accept();
  for (const auto& term : terms_) term->accept();
}

template <int D>
void PressureProjection<D>::save(io::CheckpointWriter& file) const {
  equation_.save(file);
  io::Archive archive(file);
  for (const auto& term : terms_) term->visit(archive);
}

template <int D>
void PressureProjection<D>::load(io::CheckpointReader& file) {
  equation_.load(file);
  io::Archive archive(file);
  for (const auto& term : terms_) term->visit(archive);
  forget_matrix();
}

template class PressureProjection<2>;
template class PressureProjection<3>;

}  // namespace couplet::fluid
