// SPDX-License-Identifier: Apache-2.0

#include "solid_solver/thermal/heat.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/error.hpp"
#include "common/io/checkpoint.hpp"
#include "common/log/progress.hpp"
#include "common/parallel/collective.hpp"
#include "common/time/steadiness.hpp"

namespace couplet::solid {
namespace {

// Size up to which LU is faster and has enough memory.
constexpr GlobalIndex direct_heat_up_to = 60000;

// The three-point scheme is stable for step ratios up to 1 + sqrt 2; beyond, it restarts with Euler.
constexpr double largest_growth = 2.4;

linalg::LinearOptions options_of(const HeatParameters& p, GlobalIndex n_unknowns) {
  linalg::LinearOptions options;
  options.relative_tolerance = HeatParameters::linear_tolerance;
  options.max_iterations = 2000;
  options.method = n_unknowns <= direct_heat_up_to                  ? linalg::LinearMethod::direct
                   : p.analysis == HeatParameters::Analysis::steady ? linalg::LinearMethod::gmres_multigrid
                                                                    : linalg::LinearMethod::bicgstab_ilu;
  return options;
}

}  // namespace

/// Weights of the time levels n+1, n, n-1 over dt, and theta.
struct Heat::Coefficients {
  double next = 0, now = 0, before = 0, theta = 1;
};

Heat::Heat(const mesh::Mesh& mesh, const mesh::Geometry& geometry, std::vector<HeatProperties> materials,
           const HeatParameters& parameters, const std::vector<std::string>& symmetry_patches)
    : mesh_(&mesh),
      geometry_(&geometry),
      materials_(std::move(materials)),
      parameters_(parameters),
      boundaries_(mesh, geometry, parameters_, symmetry_patches),
      conduction_(mesh, geometry, boundaries_.conditions()),
      source_(parameters_.source, "heat.source"),
      matrix_(conduction_.make_matrix()) {
  require_level(!boundaries_.gives_temperature() && !boundaries_.any_transfer());
  properties_vary_ =
      std::ranges::any_of(materials_, [](const HeatProperties& m) { return !m.is_constant(); });
  solver_ = std::make_unique<linalg::LinearSolver>(
      "temperature", matrix_,
      options_of(parameters_, parallel::sum(mesh.comm, static_cast<GlobalIndex>(conduction_.n_unknowns()))));
  start();
}

Heat::~Heat() = default;

void Heat::require_level(bool is_missing) const {
  if (is_steady() && is_missing)
    throw Error(
        "heat.boundaries: a steady temperature is undetermined without a level; set at least one patch to "
        "'type: temperature' or to 'type: convection' with a coefficient above 0; an interface sets none, so that a solid whose level "
        "the fluid sets needs 'analysis: transient'.");
}

void Heat::start() {
  const fv::Expression initial(parameters_.initial_temperature, "heat.initial-temperature");
  const Index n_owned = mesh_->cells.n_owned();
  state_.cells.resize(mesh_->cells.n_local());
  state_.boundary.resize(mesh_->boundary.n_local());
  initial.evaluate(geometry_->cell_centre, 0, state_.cells);
  initial.evaluate({geometry_->face_centre.data() + mesh_->n_interior, state_.boundary.size()}, 0,
                   state_.boundary);
  state_.known.resize(conduction_.n_known());
  boundaries_.known(conduction_, 0, state_.known);
  const auto& faces = conduction_.known_faces();
  for (std::size_t i = 0; i < faces.size(); ++i)
    state_.boundary[faces[i] - mesh_->n_interior] = state_.known[conduction_.known_points().size() + i];
  mesh_->boundary.update_ghosts(state_.boundary);
  conduction_.join_twins(state_.boundary);
  state_.enthalpy.resize(n_owned);
  for (Index c = 0; c < n_owned; ++c)
    state_.enthalpy[c] = materials_[mesh_->cell_zone[c]].specific_heat.antiderivative(state_.cells[c]);
  state_.enthalpy_before = state_.enthalpy;
  state_.inflow.assign(n_owned, 0);

  conductivity_.resize(mesh_->n_faces());
  face_heat_.resize(conduction_.flux_faces().size());
  if (boundaries_.any_transfer()) transfer_.resize(face_heat_.size());
  if (!is_steady()) capacity_.resize(n_owned);
  rhs_.resize(conduction_.n_unknowns());
  unknowns_.resize(conduction_.n_unknowns());
  set_conductivity(state_, conductivity_);
  trial_ = state_;
  boundaries_.fluxes(0, face_heat_, transfer_);
  set_inflow(sources(0, {}));
  state_.inflow = trial_.inflow;
}

Heat::Coefficients Heat::coefficients(double dt) const {
  using Scheme = HeatParameters::Scheme;
  if (is_steady()) return {};
  if (parameters_.scheme == Scheme::trapezoidal) return {1 / dt, -1 / dt, 0, 0.5};
  if (parameters_.scheme == Scheme::euler || state_.steps == 0) return {1 / dt, -1 / dt, 0, 1};
  const double r = dt / state_.dt;  // (2.46)-(2.47) for variable steps
  if (r > largest_growth) return {1 / dt, -1 / dt, 0, 1};
  return {(1 + 2 * r) / (1 + r) / dt, -(1 + r) / dt, r * r / (1 + r) / dt, 1};
}

// Between different unbonded materials the conductance is that of two layers in series, exact for layers
// parallel to the face: k = d . n/(d_P/k_P + d_N/k_N).
void Heat::set_conductivity(const HeatState& state, std::span<double> conductivity) const {
  const std::vector<double> at_faces = face_temperature(state);
  const mesh::Geometry& g = *geometry_;
  const fv::FaceGradient& faces = conduction_.faces();
  for (Index f = 0; f < mesh_->n_flux_faces(); ++f) {
    const Index owner = mesh_->owner[f];
    const int zone = mesh_->cell_zone[owner];
    const double here = materials_[zone].conductivity(at_faces[f]);
    conductivity[f] = here;
    if (f >= mesh_->n_interior) continue;
    const int other = mesh_->cell_zone[mesh_->neighbour[f]];
    if (other == zone) continue;
    const double there = materials_[other].conductivity(at_faces[f]);
    const double part = (g.face_centre[f] - g.cell_centre[owner]).dot(faces.normal[f]) * faces.inverse_dn[f];
    conductivity[f] = 1 / (part / here + (1 - part) / there);
  }
  if (!mesh_->twin.empty()) mesh_->boundary.update_ghosts(conductivity.subspan(mesh_->n_interior));
}

std::vector<double> Heat::sources(double t, std::span<const double> further) const {
  std::vector<double> source;
  if (source_.is_zero() && further.empty()) return source;
  const std::size_t n_owned = mesh_->cells.n_owned();
  source.assign(n_owned, 0);
  if (!source_.is_zero()) source_.evaluate({geometry_->cell_centre.data(), n_owned}, t, source);
  for (std::size_t c = 0; c < further.size(); ++c) source[c] += further[c];
  for (std::size_t c = 0; c < n_owned; ++c) source[c] *= geometry_->volume[c];
  return source;
}

void Heat::solve(const coupling::Step& step, std::span<const double> source) {
  const log::ScopedTimer timer(log::timers(), "solid: heat");
  if (step.scheme == coupling::Scheme::standalone && !boundaries_.interface_patches().empty())
    throw Error(
        "heat.boundaries.{}: another participant gives the heat at a thermal interface, but this program runs alone: give the "
        "patch a temperature, a flux or convection instead.",
        boundaries_.interface_patches().front());
  const Coefficients c = coefficients(step.dt);
  const double end = step.time + step.dt;
  trial_.time = end;
  trial_.dt = step.dt;
  trial_.steps = state_.steps + 1;
  trial_.cells = state_.cells;
  trial_.boundary = state_.boundary;
  boundaries_.known(conduction_, end, trial_.known);
  boundaries_.fluxes(end, face_heat_, transfer_);
  add_taken(c);
  if (is_steady() && !boundaries_.gives_temperature())
    require_level(parallel::max(mesh_->comm, transfer_.empty() ? 0 : std::ranges::max(transfer_)) == 0);
  const std::vector<double> in_cells = sources(end, source);
  // The matrix of the last step is reused if none of its data have changed.
  const bool kept = !properties_vary_ && !boundaries_.transfer_uses_time() &&
                    std::abs(filled_for_ - c.next) <= 1e-12 * c.next;
  if (!kept) filled_for_ = -1;
  for (int iteration = 1;; ++iteration) {
    assemble(c, in_cells);
    solver_->solve(rhs_, unknowns_);
    const double change = take_solution();
    if (!properties_vary_ || change <= parameters_.tolerance) break;
    if (iteration == parameters_.max_iterations)
      throw SolveFailure(
          "The temperature at t = {:g} s still changes by {:.1e} of its range after {} iterations over the "
          "temperature-dependent properties (tolerance {:.0e}).",
          end, change, iteration, parameters_.tolerance);
    filled_for_ = -1;
  }
  trial_.enthalpy_before = state_.enthalpy;
  for (Index i = 0; i < mesh_->cells.n_owned(); ++i)
    trial_.enthalpy[i] = materials_[mesh_->cell_zone[i]].specific_heat.antiderivative(trial_.cells[i]);
  set_inflow(in_cells);
  if (!kept) find_response(c);
}

void Heat::set_interface(const std::vector<Index>& faces) {
  std::vector<std::size_t> entry_of(mesh_->n_faces());
  for (std::size_t i = 0; i < conduction_.flux_faces().size(); ++i) entry_of[conduction_.flux_faces()[i]] = i;
  for (const Index face : faces) interface_.entries.push_back(entry_of[face]);
  state_.taken.assign(faces.size(), 0.0);
  trial_.taken = state_.taken;
}

/// The heat Q of a step enters as the enthalpy does that it becomes: with a step of three levels, a Q^{n+1} - b Q^n. That is the
/// heat at t^{n+1} to second order, and the solid stores all of what is given.
void Heat::add_taken(const Coefficients& c) {
  const double now = is_steady() ? 1 : c.next * trial_.dt, before = c.before * state_.dt;
  interface_.enters.resize(interface_.entries.size());
  for (std::size_t i = 0; i < interface_.enters.size(); ++i) {
    interface_.enters[i] = now * trial_.taken[i] - before * state_.taken[i];
    face_heat_[interface_.entries[i]] += interface_.enters[i];
  }
}

/// Solves once for 1 W/m^2 at all interface faces and nothing else. Properties that vary do so little within a step.
void Heat::find_response(const Coefficients& c) {
  const bool meets = parallel::any(mesh_->comm, !interface_.entries.empty());
  if (!meets || (interface_.time == state_.time && interface_.weight == c.next)) return;
  interface_.time = state_.time;
  interface_.weight = c.next;
  std::vector<double> heat(conduction_.n_unknowns(), 0.0), change = heat;
  const std::size_t n_owned = std::size_t(mesh_->cells.n_owned());
  for (const std::size_t entry : interface_.entries) {
    const Index face = conduction_.flux_faces()[entry];
    const double area = geometry_->face_area[face].norm();
    heat[std::size_t(mesh_->owner[face])] += c.theta * area;
    heat[n_owned + entry] = area;
  }
  solver_->solve(heat, change);
  interface_.response.clear();
  for (const std::size_t entry : interface_.entries) {
    const Index face = conduction_.flux_faces()[entry];
    const double half_cell = 1 / (conduction_.faces().inverse_dn[face] * conductivity_[face]);
    interface_.response.push_back(std::max(change[n_owned + entry], half_cell));
  }
}

InterfaceFilm Heat::film() const {
  InterfaceFilm film;
  for (std::size_t i = 0; i < interface_.entries.size(); ++i) {
    const Index face = conduction_.flux_faces()[interface_.entries[i]];
    const double flux = interface_.enters[i] / geometry_->face_area[face].norm();
    film.coefficient.push_back(1 / interface_.response[i]);
    film.ambient.push_back(trial_.boundary[face - mesh_->n_interior] - flux * interface_.response[i]);
  }
  return film;
}

void Heat::assemble(const Coefficients& c, std::span<const double> source) {
  const Index n_owned = mesh_->cells.n_owned();
  if (filled_for_ < 0) {
    if (properties_vary_) set_conductivity(trial_, conductivity_);
    for (Index i = 0; i < std::ssize(capacity_); ++i) {
      const HeatProperties& m = materials_[mesh_->cell_zone[i]];
      capacity_[i] = c.next * m.density * geometry_->volume[i] * m.specific_heat(trial_.cells[i]);
    }
  }
  const fv::ConductionOperator::RowFactors weights{conductivity_, transfer_, capacity_, c.theta};
  if (filled_for_ < 0) {
    conduction_.fill(weights, matrix_);
    solver_->matrix_changed();
    filled_for_ = c.next;
  }
  std::ranges::fill(rhs_, 0.0);
  // Newton's method for the stored heat: h(T) = h(T^k) + c(T^k)(T - T^k).
  for (Index i = 0; i < std::ssize(capacity_); ++i) {
    const HeatProperties& m = materials_[mesh_->cell_zone[i]];
    const double mass = m.density * geometry_->volume[i];
    const double level = state_.enthalpy[i], now = m.specific_heat.antiderivative(trial_.cells[i]) - level;
    const double before = state_.enthalpy_before[i] - level;  // sum of the weights is zero
    rhs_[i] = capacity_[i] * trial_.cells[i] - mass * (c.next * now + c.before * before);
    rhs_[i] += (1 - c.theta) * state_.inflow[i];
  }
  for (std::size_t i = 0; i < source.size(); ++i) rhs_[i] += c.theta * source[i];
  const auto& faces = conduction_.flux_faces();
  for (std::size_t i = 0; i < faces.size(); ++i) {
    rhs_[mesh_->owner[faces[i]]] += c.theta * face_heat_[i];
    rhs_[n_owned + i] = face_heat_[i];
  }
  conduction_.subtract_known(weights, trial_.known, rhs_);
  std::copy_n(trial_.cells.begin(), n_owned, unknowns_.begin());
  for (std::size_t i = 0; i < faces.size(); ++i)
    unknowns_[n_owned + i] = trial_.boundary[faces[i] - mesh_->n_interior];
}

/// Largest change of a cell relative to the range of all temperatures (at least a thousandth of their level).
double Heat::take_solution() {
  const Index n_owned = mesh_->cells.n_owned();
  double change = 0, lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (Index c = 0; c < n_owned; ++c) {
    change = std::max(change, std::abs(unknowns_[c] - trial_.cells[c]));
    for (const double t : {state_.cells[c], unknowns_[c]}) {
      lowest = std::min(lowest, t);
      highest = std::max(highest, t);
    }
  }
  take(unknowns_, trial_);
  const double level = parallel::max(mesh_->comm, highest),
               range = level - parallel::min(mesh_->comm, lowest);
  return parallel::max(mesh_->comm, change) / std::max({range, 1e-3 * std::abs(level), 1e-300});
}

/// Sets cells and faces from the unknowns and from the known values of the state.
void Heat::take(std::span<const double> unknowns, HeatState& state) const {
  const Index n_owned = mesh_->cells.n_owned();
  std::copy_n(unknowns.begin(), n_owned, state.cells.begin());
  const auto &faces = conduction_.flux_faces(), &known = conduction_.known_faces();
  for (std::size_t i = 0; i < faces.size(); ++i)
    state.boundary[faces[i] - mesh_->n_interior] = unknowns[n_owned + i];
  for (std::size_t i = 0; i < known.size(); ++i)
    state.boundary[known[i] - mesh_->n_interior] = state.known[conduction_.known_points().size() + i];
  mesh_->cells.update_ghosts(state.cells);
  mesh_->boundary.update_ghosts(state.boundary);
  conduction_.join_twins(state.boundary);
}

/// R(T^{n+1}), required by the next step of the trapezoidal rule.
void Heat::set_inflow(std::span<const double> source) {
  if (is_steady() || parameters_.scheme != HeatParameters::Scheme::trapezoidal) return;
  if (properties_vary_) set_conductivity(trial_, conductivity_);
  const Index n_owned = mesh_->cells.n_owned();
  const std::vector<double> points = point_temperature(trial_);
  std::vector<double> heat(mesh_->n_flux_faces());
  conduction_.face_heat(conductivity_, trial_.cells, trial_.boundary, points, heat);
  // Known data of a flux face enter as in the cell's row.
  const auto& faces = conduction_.flux_faces();
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (conduction_.condition(faces[i]) == fv::HeatCondition::bonded) continue;
    const double h = transfer_.empty() ? 0 : transfer_[i];
    heat[faces[i]] = face_heat_[i] - h * geometry_->face_area[faces[i]].norm() *
                                         trial_.boundary[faces[i] - mesh_->n_interior];
  }
  std::ranges::fill(trial_.inflow, 0.0);
  for (std::size_t i = 0; i < source.size(); ++i) trial_.inflow[i] = source[i];
  for (Index f = 0; f < mesh_->n_flux_faces(); ++f) {
    if (mesh_->owner[f] < n_owned) trial_.inflow[mesh_->owner[f]] += heat[f];
    if (f < mesh_->n_interior && mesh_->neighbour[f] < n_owned) trial_.inflow[mesh_->neighbour[f]] -= heat[f];
  }
}

void Heat::accept_step() { std::swap(state_, trial_); }

double Heat::change() const {
  return time::change_over_range(
      mesh_->comm, std::span(state_.cells).first(std::size_t(mesh_->cells.n_owned())), trial_.cells);
}

void Heat::visit(io::Archive& archive) {
  archive.field(mesh::Entries::cells, "cell-temperature", state_.cells, 1);
  archive.field(mesh::Entries::boundary, "face-temperature", state_.boundary, 1);
  std::vector<double> points(mesh_->points.n_local(), 0), faces(mesh_->boundary.n_owned(), 0);
  const auto each = [&](const auto& pass) {
    std::size_t i = 0;
    for (const Index v : conduction_.known_points()) pass(points[v], state_.known[i++]);
    for (const Index f : conduction_.known_faces()) pass(faces[f - mesh_->n_interior], state_.known[i++]);
  };
  each([](double& field, double value) { field = value; });
  archive.field(mesh::Entries::points, "known-temperature", points, 1);
  archive.field(mesh::Entries::owned_boundary, "known-face-temperature", faces, 1);
  each([](double field, double& value) { value = field; });
  archive.field(mesh::Entries::owned_cells, "enthalpy", state_.enthalpy, 1);
  archive.field(mesh::Entries::owned_cells, "enthalpy-before", state_.enthalpy_before, 1);
  archive.field(mesh::Entries::owned_cells, "heat-inflow", state_.inflow, 1);
  if (!boundaries_.interface_patches().empty()) {
    std::vector<double> taken(mesh_->boundary.n_owned(), 0);
    for (std::size_t i = 0; i < interface_.entries.size(); ++i)
      taken[conduction_.flux_faces()[interface_.entries[i]] - mesh_->n_interior] = state_.taken[i];
    archive.field(mesh::Entries::owned_boundary, "interface-heat", taken, 1);
    for (std::size_t i = 0; i < interface_.entries.size(); ++i)
      state_.taken[i] = taken[conduction_.flux_faces()[interface_.entries[i]] - mesh_->n_interior];
    trial_.taken = state_.taken;
  }
  archive.common("heat-state", state_.time, state_.dt, state_.steps);
}

// Results from the temperature: values at points and faces, heat through patches, neglected effects.

std::vector<double> Heat::point_temperature(const HeatState& state) const {
  std::vector<double> points(mesh_->points.n_local());
  conduction_.point_values(state.cells, state.boundary, state.known, points);
  return points;
}

std::vector<double> Heat::face_temperature(const HeatState& state) const {
  const std::vector<double> points = point_temperature(state);
  std::vector<double> values(mesh_->n_flux_faces());
  for (Index f = 0; f < mesh_->n_flux_faces(); ++f)
    values[f] = conduction_.face_value(f, state.cells, state.boundary, points);
  return values;
}

std::vector<double> Heat::face_heat() const {
  std::vector<double> conductivity(mesh_->n_faces()), heat(mesh_->n_flux_faces());
  set_conductivity(state_, conductivity);
  conduction_.face_heat(conductivity, state_.cells, state_.boundary, point_temperature(state_), heat);
  return heat;
}

std::vector<double> Heat::boundary_inflow() const {
  const std::vector<double> heat = face_heat();
  std::vector<double> inflow(mesh_->boundary.n_owned(), 0);
  for (std::size_t b = 0; b < inflow.size(); ++b) {
    const Index f = mesh_->n_interior + Index(b);
    if (conduction_.condition(f) != fv::HeatCondition::symmetry)
      inflow[b] = heat[f] / geometry_->face_area[f].norm();
  }
  return inflow;
}

std::vector<PatchHeat> Heat::patch_heat() const {
  const std::vector<double> heat = face_heat();
  std::vector<PatchHeat> result;
  for (const mesh::Patch& patch : mesh_->patches) {
    if (patch.bonded) continue;
    double through = 0;
    for (Index f = patch.first; f < patch.first + patch.count; ++f)
      if (conduction_.condition(f) != fv::HeatCondition::symmetry) through += heat[f];
    result.push_back({patch.name, parallel::sum(mesh_->comm, through)});
  }
  return result;
}

double Heat::stored_heat() const {
  double heat = 0;
  for (Index c = 0; c < mesh_->cells.n_owned(); ++c)
    heat += materials_[mesh_->cell_zone[c]].density * geometry_->volume[c] * state_.enthalpy[c];
  return parallel::sum(mesh_->comm, heat);
}

HeatState Heat::answer(std::vector<double> sources, std::vector<double> known) const {
  if (!is_steady() || properties_vary_ || state_.steps == 0)
    throw Error("Only a steady temperature that was computed with constant conductivity has a dual problem.");
  HeatState answer;
  answer.known = std::move(known);
  conduction_.subtract_known({conductivity_, transfer_, capacity_, 1}, answer.known, sources);
  std::vector<double> unknowns(sources.size(), 0);
  solver_->solve(sources, unknowns);
  answer.cells.assign(std::size_t(mesh_->cells.n_local()), 0);
  answer.boundary.assign(std::size_t(mesh_->boundary.n_local()), 0);
  take(unknowns, answer);
  return answer;
}

// (C/dt + theta K) x = C/dt change; the next change is x by Euler, and 2 x - change by the trapezoidal rule.
std::vector<double> Heat::next_change(std::span<const double> change) const {
  std::vector<double> rhs(conduction_.n_unknowns(), 0), next(conduction_.n_unknowns(), 0);
  for (std::size_t i = 0; i < capacity_.size(); ++i) rhs[i] = capacity_[i] * change[i];
  solver_->solve(rhs, next);
  next.resize(capacity_.size());
  if (parameters_.scheme == HeatParameters::Scheme::trapezoidal)
    for (std::size_t i = 0; i < next.size(); ++i) next[i] = 2 * next[i] - change[i];
  return next;
}

std::vector<double> Heat::transfer() const {
  std::vector<double> all = transfer_;
  for (std::size_t i = 0; i < all.size(); ++i)
    all[i] *= geometry_->face_area[conduction_.flux_faces()[i]].norm();
  return all;
}

// The pyramid-weighted mean of the face values differs from the center value 3/dim times as much as the mean
// of a quadratic source in a regular cell.
std::vector<double> Heat::source_missed() const {
  std::vector<double> missed;
  if (source_.is_zero()) return missed;
  missed.assign(std::size_t(mesh_->cells.n_owned()), 0);
  const mesh::Geometry& g = *geometry_;
  const auto add = [&](Index c, Index f, const Vec3& shift) {
    if (c >= mesh_->cells.n_owned()) return;
    const Vec3 at = g.face_centre[f] - shift;
    const double pyramid = std::abs(g.face_area[f].dot(at - g.cell_centre[c])) / mesh_->dim;
    missed[std::size_t(c)] +=
        mesh_->dim / 3. * pyramid * (source_(at, state_.time) - source_(g.cell_centre[c], state_.time));
  };
  for (Index f = 0; f < mesh_->n_flux_faces(); ++f) {
    add(mesh_->owner[f], f, Vec3::Zero());
    if (f < mesh_->n_interior) add(mesh_->neighbour[f], f, mesh_->shift(f));
  }
  return missed;
}

}  // namespace couplet::solid
