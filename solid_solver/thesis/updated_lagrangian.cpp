// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/thesis/updated_lagrangian.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <utility>

#include "common/base/error.hpp"
#include "common/elasticity/finite/finite_strain.hpp"
#include "common/elasticity/symmetric/symmetric_faces.hpp"
#include "common/elasticity/vector_at.hpp"
#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/laws/laws.hpp"
#include "solid_solver/method/solution_method.hpp"
#include "solid_solver/thesis/segregated.hpp"

namespace couplet::solid {

namespace {

// Tolerance of a first guess.
constexpr double loose = 1e-3;

}  // namespace

UpdatedFrame::UpdatedFrame(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows,
                           std::vector<Vec3> points)
    : mesh_(mesh),
      geometry_(mesh::compute_geometry(mesh, std::move(points))),
      rows_(mesh, geometry_, rows.boundary(), elastic::ElasticBody{{rows.lame(0)}, {}}),
      kernel_(mesh, rows_, elastic::FaceGradientScheme::thesis) {}

ScalarSystems& UpdatedFrame::systems(double mass_factor, std::span<const double> inertia) {
  if (!systems_ || mass_factor != mass_factor_)
    systems_ = std::make_unique<ScalarSystems>(mesh_, rows_, inertia);
  mass_factor_ = mass_factor;
  return *systems_;
}

std::vector<double> UpdatedFrame::linear_answer(std::span<const double> change, MethodParameters method) {
  method.relative_tolerance = loose;
  std::vector<double> still(rows_.n_unknowns(), 0), b(still), u(still);
  kernel_.apply(still, change, b);
  for (double& x : b) x = -x;
  Segregated({mesh_, rows_, {}, kernel_}, method).solve(b, u);
  return u;
}

// Evaluates four places at a time; the last group is padded.
void first_piola(const elastic::FiniteLaw& law, std::span<const Tensor3> deformation,
                 std::span<Tensor3> stress, std::span<double> energy) {
  using namespace elastic::finite;
  const std::size_t n = deformation.size();
  for (std::size_t first = 0; first < n; first += 4) {
    const auto at = [&](int k) { return std::min(first + std::size_t(k), n - 1); };
    elastic::finite::StrainState s;
    for (int k = 0; k < 4; ++k)
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) s.f[i][j][k] = deformation[at(k)](i, j);
    const elastic::Invariants place[1] = {elastic::finite::invariants(s.f)};
    elastic::Energy e[1];
    law.evaluate(place, true, e);
    elastic::finite::keep(e[0], s);
    elastic::finite::Tensor4 p;
    elastic::finite::stress<true>(s, p);
    for (int k = 0; k < 4; ++k) {
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) stress[at(k)](i, j) = p[i][j][k];
      energy[at(k)] = e[0].w[k];
    }
  }
}

Tensor3 cofactors_of(const Tensor3& f) {
  Tensor3 h;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      h(i, j) = f((i + 1) % 3, (j + 1) % 3) * f((i + 2) % 3, (j + 2) % 3) -
                f((i + 1) % 3, (j + 2) % 3) * f((i + 2) % 3, (j + 1) % 3);
  return h;
}

namespace {

constexpr std::array unknown_conditions{"a support or springs", "'zero-normal-gradient'",
                                        "an interface between two materials"};

/// Index of an unsupported condition of a row; -1 if there is none.
int unknown_condition_of(const elastic::BoundaryRow& row) {
  if (row.fixed || row.mirrored || row.is_free()) return -1;
  return row.has_value() ? 0 : row.level ? 1 : 2;
}

}  // namespace

UpdatedLagrangian::UpdatedLagrangian(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows,
                                     const SolidParameters& parameters)
    : LargeStrain(mesh, rows),
      method_(parameters.method),
      accelerator_(mesh.comm, rows.n_unknowns(), acceleration_of(parameters.method)) {
  const mesh::Geometry& geometry = rows.geometry();
  int unknown_condition = -1;
  for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f)
    unknown_condition = std::max(unknown_condition, unknown_condition_of(rows.at(f)));
  unknown_condition = parallel::max(mesh.comm, unknown_condition);
  if (unknown_condition >= 0)
    throw Error(
        "solution-method.type: segregated: at finite strain it supports 'fixed-displacement' of all "
        "components, 'symmetry', 'traction', 'pressure', 'free' and 'interface', not {}; use 'type: "
        "newton-krylov' (or 'auto').",
        unknown_conditions[std::size_t(unknown_condition)]);
  const SolidMaterial material = materials_of(parameters).front();
  law_ = laws::of(material.law)->make(lame_constants(parameters, material), material.law_coefficients);
  noise_ = rounding_of_forces(mesh, rows);
  now_.points = geometry.points;
  now_.gradient.assign(mesh.n_flux_faces(), Tensor3::Identity());
  now_.u.assign(rows.n_unknowns(), 0);
  now_.known.assign(rows.n_known() * mesh.dim, 0);
}

UpdatedLagrangian::~UpdatedLagrangian() = default;

std::string UpdatedLagrangian::name() const {
  return segregated_name(method_) + " at large strain, updated Lagrangian, least-squares face gradient";
}

UpdatedFrame& UpdatedLagrangian::frame() {
  if (!frame_) frame_ = std::make_unique<UpdatedFrame>(mesh_, rows_, now_.points);
  return *frame_;
}

/// `known`: empty for zeros.
UpdatedLagrangian::Change UpdatedLagrangian::since_start(std::span<const double> unknowns,
                                                         std::span<const double> known) const {
  Change change{{unknowns.begin(), unknowns.end()}, std::vector<double>(now_.known.size(), 0)};
  std::ranges::copy(known, change.known.begin());
  for (std::size_t i = 0; i < change.u.size(); ++i) change.u[i] -= now_.u[i];
  for (std::size_t i = 0; i < change.known.size(); ++i) change.known[i] -= now_.known[i];
  return change;
}

/// f at the faces for the displacement since the start of the step; without motion no frame is required.
void UpdatedLagrangian::find_change(std::span<const double> unknowns, std::span<const double> known) {
  const auto [u, g] = since_start(unknowns, known);
  change_.assign(mesh_.n_flux_faces(), Tensor3::Identity());
  const auto is_zero = [](double x) { return x == 0; };
  if (!parallel::any(mesh_.comm, !std::ranges::all_of(u, is_zero) || !std::ranges::all_of(g, is_zero)))
    return;
  frame().kernel().face_gradients(
      u, g, [this](Index f, const Tensor3& gradient) { change_[f] += gradient.transpose(); }, 0,
      mesh_.n_flux_faces());
}

/// Computes F = f F_u, W and P at the faces; false if some face is inverted.
bool UpdatedLagrangian::find_stress() {
  const Index n = mesh_.n_flux_faces();
  deformation_.resize(n);
  least_ = 1;
  worst_ = -1;
  for (Index f = 0; f < n; ++f) {
    deformation_[f] = change_[f] * now_.gradient[f];
    const double ratio = std::min(change_[f].determinant(), deformation_[f].determinant());
    if (ratio < least_ || !std::isfinite(ratio)) least_ = std::isfinite(ratio) ? ratio : -1, worst_ = f;
  }
  if (!(parallel::min(mesh_.comm, least_) > 0)) return false;
  stress_.resize(n);
  energy_.resize(n);
  first_piola(law_, deformation_, stress_, energy_);
  return true;
}

/// sigma . (j f^-T S_u), (2.39) [N]
Vec3 UpdatedLagrangian::force_through(Index f) {
  const Tensor3& F = deformation_[f];
  return stress_[f] * (F.transpose() * present_area(f)) / F.determinant();
}

/// Rows of ElasticOperator: minus the outgoing force of cells, plus the incoming one of traction faces.
void UpdatedLagrangian::add_forces(std::span<double> result) {
  const Index n = mesh_.cells.n_owned();
  const std::size_t dim = mesh_.dim;
  const auto add = [&](std::size_t node, const Vec3& force) {
    for (std::size_t a = 0; a < dim; ++a) result[node * dim + a] += force[Index(a)];
  };
  pressure_force_ = Vec3::Zero();
  std::size_t open = n;
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
    const Index here = mesh_.owner[f];
    const Vec3 force = force_through(f);
    if (f < mesh_.n_interior) {
      if (here < n) add(here, -force);
      if (mesh_.neighbour[f] < n) add(mesh_.neighbour[f], force);
    } else if (rows_.at(f).is_free()) {
      Vec3 push = Vec3::Zero();
      if (!pressure_.empty()) push = -pressure_[f - mesh_.n_interior] * present_area(f);
      pressure_force_ += push;
      add(here, -push);
      add(open++, force - push);
    } else if (rows_.mirrored(f)) {
      const Vec3& S = frame().area()[f];
      add(here, -S.dot(force) / S.squaredNorm() * S);
    } else {
      add(here, -force);
    }
  }
}

bool UpdatedLagrangian::look(std::span<const double> unknowns, std::span<const double> known) {
  find_change(unknowns, known);
  return find_stress();
}

/// r = b - M m u - A(u) and its norm; infinite if a face is inverted.
double UpdatedLagrangian::residual(const EquilibriumLoad& load, std::span<const double> u,
                                   std::span<double> r) {
  if (!look(u, load.known)) return std::numeric_limits<double>::infinity();
  std::ranges::fill(r, 0.0);
  add_forces(r);
  const std::size_t dim = mesh_.dim;
  for (std::size_t c = 0; c < load.inertia.size(); ++c)
    for (std::size_t a = 0; a < dim; ++a) r[c * dim + a] += load.inertia[c] * u[c * dim + a];
  for (std::size_t i = 0; i < r.size(); ++i) r[i] = load.rows[i] - r[i];
  return norm(mesh_.comm, r);
}

std::string UpdatedLagrangian::where_worst() const { return worst_cell(mesh_, geometry_, least_, worst_); }

/// Moves the body with its known columns as a linear one, because the first guess would make a jump in adjacent cells.
void UpdatedLagrangian::follow_known(const EquilibriumLoad& load, std::span<double> u) {
  std::vector<double> change(load.known.begin(), load.known.end());
  for (std::size_t i = 0; i < change.size(); ++i) change[i] -= load.before[i];
  if (!parallel::any(mesh_.comm, std::ranges::any_of(change, [](double x) { return x != 0; }))) return;
  const std::vector<double> du = frame().linear_answer(change, method_);
  for (std::size_t i = 0; i < u.size(); ++i) u[i] += du[i];
}

linalg::SolveStatistics UpdatedLagrangian::find(const EquilibriumLoad& load, SolidSystem&,
                                                std::span<double> u) {
  const auto start = std::chrono::steady_clock::now();
  ScalarSystems& systems = frame().systems(load.mass_factor, load.inertia);
  linalg::SolveStatistics statistics;
  std::vector<double> r(u.size()), step(u.size());
  if (parallel::any(mesh_.comm, !load.before.empty())) follow_known(load, u);
  accelerator_.restart();
  double size = residual(load, u, r);
  if (!std::isfinite(size))
    throw SolveFailure("The initial guess of the step inverts a cell. {}", where_worst());
  // In motion b contains the inertia of the position itself, which far exceeds the accelerating force.
  std::vector<double> inner(u.size(), 0);
  if (load.mass_factor > 0) add_forces(inner);
  const std::span<const double> loads = load.mass_factor > 0 ? std::span<const double>(inner) : load.rows;
  const double scale = std::max(norm(mesh_.comm, loads), size);
  while (size > std::max(method_.relative_tolerance * scale, noise_)) {
    if (statistics.iterations == method_.max_iterations)
      throw SolveFailure(
          "The segregated method did not converge: {} outer iterations ('solution-method.max-iterations'), "
          "residual {:.2g} of the load (tolerance {:.0e}). {} Use shorter load steps, or 'type: "
          "newton-krylov', which needs far fewer.",
          statistics.iterations, size / scale, method_.relative_tolerance, where_worst());
    ++statistics.iterations;
    statistics.inner_iterations += systems.find_step(r, step);
    accelerator_.advance(u, step);
    size = residual(load, u, r);
    if (!std::isfinite(size))
      throw SolveFailure("The segregated method inverted a cell in iteration {}. {}", statistics.iterations,
                         where_worst());
  }
  statistics.residual = scale > 0 ? size / scale : 0;
  statistics.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return statistics;
}

// Results of a state of the updated-Lagrangian method: energies, forces, and the start of the next step.

std::vector<double> UpdatedLagrangian::forces(std::span<const double> unknowns,
                                              std::span<const double> known) {
  std::vector<double> result(unknowns.size(), 0);
  look(unknowns, known);
  add_forces(result);
  return result;
}

/// Sum of W per face times the pyramids of owned cells over it.
double UpdatedLagrangian::energy(std::span<const double> unknowns, std::span<const double> known) {
  look(unknowns, known);
  double here = 0;
  elastic::visit_pyramids(mesh_, geometry_,
                          [&](Index, Index f, double pyramid) { here += pyramid * energy_[f]; });
  return parallel::sum(mesh_.comm, here);
}

/// Each face once over all ranks, on the rank of its owner cell.
void UpdatedLagrangian::visit(std::span<const double> unknowns, std::span<const double> known,
                              const Take& take) {
  look(unknowns, known);
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f)
    if (mesh_.owner[f] < mesh_.cells.n_owned()) take(f, deformation_[f], stress_[f]);
}

/// Loads need no subtraction, because held faces have none.
std::vector<elastic::Wrench> UpdatedLagrangian::holding_forces(std::span<const double> unknowns,
                                                               std::span<const double> known,
                                                               const elastic::ElasticLoads&) {
  look(unknowns, known);
  std::vector<elastic::Wrench> forces;
  for (const mesh::Patch& patch : mesh_.patches) {
    elastic::Wrench force;
    for (Index f = patch.first; f < patch.first + patch.count; ++f) {
      const Vec3& S = frame().area()[f];
      Vec3 centre = Vec3::Zero();
      for (const Index v : mesh_.face_points[f])
        centre += now_.points[v] / double(mesh_.face_points[f].size());
      if (rows_.at(f).fixed) force.add(force_through(f), centre);
      if (rows_.mirrored(f)) force.add(S.dot(force_through(f)) / S.squaredNorm() * S, centre);
    }
    forces.push_back(force);
  }
  return forces;
}

void UpdatedLagrangian::end_step(std::span<const double> unknowns, std::span<const double> known) {
  if (!look(unknowns, known)) throw SolveFailure("The end of the step inverts a cell. {}", where_worst());
  const std::size_t dim = mesh_.dim;
  const auto [u, g] = since_start(unknowns, known);
  std::vector<double> moved(std::size_t(mesh_.points.n_local()) * dim, 0);
  frame().kernel().point_values(u, g, moved);
  mesh_.points.update_ghosts(moved, mesh_.dim);
  next_.points = now_.points;
  for (Index v = 0; v < mesh_.points.n_local(); ++v)
    next_.points[v] += elastic::vector_at(moved, v, mesh_.dim);
  next_.gradient = deformation_;
  next_.u.assign(unknowns.begin(), unknowns.end());
  next_.known.assign(g.size(), 0);
  std::ranges::copy(known, next_.known.begin());
}

void UpdatedLagrangian::accept() {
  std::swap(now_, next_);
  frame_.reset();
}

namespace {

/// Saves or loads vectors or tensors by their numbers.
template <class T>
void visit_field(io::Archive& archive, mesh::Entries entries, const char* name, std::vector<T>& values) {
  constexpr std::size_t width = T::SizeAtCompileTime;
  std::vector<double> numbers(width * values.size());
  for (std::size_t i = 0; i < values.size(); ++i) std::copy_n(values[i].data(), width, &numbers[width * i]);
  archive.field(entries, name, numbers, width);
  for (std::size_t i = 0; i < values.size(); ++i) std::copy_n(&numbers[width * i], width, values[i].data());
}

}  // namespace

void UpdatedLagrangian::visit(io::Archive& archive, std::span<const double> unknowns,
                              std::span<const double> known) {
  visit_field(archive, mesh::Entries::points, "updated-points", now_.points);
  visit_field(archive, mesh::Entries::flux_faces, "updated-deformation", now_.gradient);
  now_.u.assign(unknowns.begin(), unknowns.end());
  std::ranges::copy(known, now_.known.begin());
  if (archive.reads()) frame_.reset();
}

}  // namespace couplet::solid
