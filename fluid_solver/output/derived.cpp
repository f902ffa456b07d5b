// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/output/derived.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "common/parallel/collective.hpp"
#include "fluid_solver/parameters/parameters.hpp"

namespace couplet::fluid {

namespace {

/// Round-off may make a square negative; NaN is kept.
double root(double square) { return square < 0 ? 0.0 : std::sqrt(square); }

}  // namespace

template <int D>
RunningStatistics<D>::RunningStatistics(std::size_t cells, std::size_t faces)
    : cells_(cells),
      velocity_(cells + faces, Vec<D>::Zero()),
      normal_(cells + faces, Vec<D>::Zero()),
      shear_(cells * n_shear, 0.0),
      pressure_(cells + faces, 0.0),
      pressure_square_(cells + faces, 0.0) {}

template <int D>
RunningStatistics<D> RunningStatistics<D>::nothing_yet(std::size_t cells, std::size_t faces) {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  RunningStatistics none(cells, faces);
  for (Vectors<D>* v : {&none.velocity_, &none.normal_}) v->assign(v->size(), Vec<D>::Constant(unknown));
  for (auto* v : {&none.shear_, &none.pressure_, &none.pressure_square_}) v->assign(v->size(), unknown);
  none.duration_ = 1;
  return none;
}

template <int D>
void RunningStatistics<D>::add(std::size_t i, const Vec<D>& velocity, double dt) {
  const double share = dt / duration_;
  const Vec<D> before = velocity - velocity_[i];
  velocity_[i] += share * before;
  const Vec<D> after = velocity - velocity_[i];
  normal_[i] += dt * before.cwiseProduct(after);
  if (i >= cells_) return;
  double* shear = shear_.data() + i * n_shear;
  for (int a = 0; a < D; ++a)
    for (int b = a + 1; b < D; ++b) *shear++ += dt * before[a] * after[b];
}

template <int D>
void RunningStatistics<D>::add_pressure(std::size_t i, double pressure, double dt) {
  const double before = pressure - pressure_[i];
  pressure_[i] += dt / duration_ * before;
  pressure_square_[i] += dt * before * (pressure - pressure_[i]);
}

template <int D>
void RunningStatistics<D>::add(const State<D>& s, const PressureLevel<D>* pressure, double dt) {
  duration_ += dt;
  for (std::size_t c = 0; c < cells_; ++c) add(c, s.u[c], dt);
  for (std::size_t b = 0; b < s.u_boundary.size(); ++b) add(cells_ + b, s.u_boundary[b], dt);
  if (!pressure) return;
  for (std::size_t c = 0; c < cells_; ++c) add_pressure(c, pressure->p[c], dt);
  for (std::size_t b = 0; b < pressure->boundary.size(); ++b)
    add_pressure(cells_ + b, pressure->boundary[b], dt);
}

template <int D>
Vectors<D> RunningStatistics<D>::velocity_rms() const {
  Vectors<D> rms(normal_.size(), Vec<D>::Zero());
  if (duration_ > 0)
    for (std::size_t c = 0; c < rms.size(); ++c) rms[c] = (normal_[c] / duration_).unaryExpr(&root);
  return rms;
}

template <int D>
std::vector<double> RunningStatistics<D>::pressure_rms() const {
  std::vector<double> rms(pressure_.size(), 0.0);
  if (duration_ > 0)
    for (std::size_t c = 0; c < rms.size(); ++c) rms[c] = root(pressure_square_[c] / duration_);
  return rms;
}

template <int D>
std::vector<double> RunningStatistics<D>::reynolds_shear() const {
  std::vector<double> shear = shear_;
  if (duration_ > 0)
    for (double& value : shear) value /= duration_;
  return shear;
}

template <int D>
void RunningStatistics<D>::visit(io::Archive archive) {
  const auto part = [&](mesh::Entries entries, const std::string& name, std::span<double> values,
                        std::size_t width) {
    std::vector<double> copy(values.begin(), values.end());
    archive.field(entries, "statistics-" + name, copy, width);
    std::ranges::copy(copy, values.begin());
  };
  const auto both = [&](const std::string& name, std::span<double> values, std::size_t width) {
    part(mesh::Entries::cells, name, values.first(cells_ * width), width);
    part(mesh::Entries::owned_boundary, "boundary-" + name, values.subspan(cells_ * width), width);
  };
  archive.common("statistics-duration", duration_);
  both("velocity", flat<D>(velocity_), D);
  both("normal", flat<D>(normal_), D);
  both("pressure", pressure_, 1);
  both("pressure-square", pressure_square_, 1);
  part(mesh::Entries::cells, "shear", shear_, n_shear);
}

template class RunningStatistics<2>;
template class RunningStatistics<3>;

template <int D>
std::vector<std::array<double, 2>> wall_units(const Fluid<D>& fluid) {
  const mesh::Mesh& mesh = fluid.mesh();
  const Placement<D>& at = *fluid.state().placement;
  const auto [rho, mu, nu, sound] = fluid.properties();
  const std::vector<double>& excess = fluid.state().excess;
  std::vector<std::array<double, 2>> units(fluid.viscous_force().size());
  for (std::size_t b = 0; b < units.size(); ++b) {
    const Index f = mesh.n_interior + static_cast<Index>(b);
    const double area = at.area[f].norm();
    const Vec<D> n = at.area[f] / area, &force = fluid.viscous_force()[b];
    const double shear = (force - force.dot(n) * n).norm() / area;
    const double distance = area / at.conductance[f];
    const double local = nu + (excess.empty() ? 0 : excess[f]);
    units[b] = {shear, local > 0 ? distance * std::sqrt(shear / rho) / local : 0};
  }
  return units;
}

template <int D>
WallSummary summarise_wall(const Fluid<D>& fluid, const mesh::Patch& patch) {
  const mesh::Mesh& mesh = fluid.mesh();
  const auto units = wall_units(fluid);
  double sums[3] = {}, largest[2] = {};
  if (!units.empty())
    for (Index f = patch.first; f < patch.first + patch.count; ++f) {
      const double area = fluid.state().placement->area[f].norm();
      const auto& here = units[f - mesh.n_interior];
      sums[2] += area;
      for (int i = 0; i < 2; ++i) {
        sums[i] += area * here[i];
        largest[i] = std::max(largest[i], here[i]);
      }
    }
  MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPI_DOUBLE, MPI_SUM, mesh.comm);
  MPI_Allreduce(MPI_IN_PLACE, largest, 2, MPI_DOUBLE, MPI_MAX, mesh.comm);
  if (!(sums[2] > 0)) return {};
  return {largest[0], sums[0] / sums[2], largest[1], sums[1] / sums[2]};
}

template <int D>
ForceCoefficients force_coefficients(const Fluid<D>& fluid, const CoefficientParameters& c) {
  const mesh::Mesh& mesh = fluid.mesh();
  Vec3 sums[2] = {Vec3::Zero(), Vec3::Zero()};  // force, moment
  for (const std::string& name : c.patches) {
    const mesh::Patch& patch = *mesh.find_patch(name);
    if (fluid.pressure_force().empty()) break;  // before the first step
    for (Index b = patch.first - mesh.n_interior; b < patch.first - mesh.n_interior + patch.count; ++b) {
      Vec3 force = Vec3::Zero();
      force.template head<D>() = fluid.pressure_force()[b] + fluid.viscous_force()[b];
      sums[0] += force;
      sums[1] += (fluid.state().placement->boundary_centre[b] - c.centre).cross(force);
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 6, MPI_DOUBLE, MPI_SUM, mesh.comm);
  const double qa = 0.5 * fluid.properties().rho * c.speed * c.speed * c.area;
  return {sums[0].dot(c.drag.normalized()) / qa, sums[0].dot(c.lift.normalized()) / qa,
          sums[1].dot(c.axis.normalized()) / (qa * c.length)};
}

template <int D>
EnergyBudget energy_budget(const Fluid<D>& fluid) {
  const mesh::Mesh& mesh = fluid.mesh();
  const State<D>& s = fluid.state();
  const Placement<D>& at = *s.placement;
  const auto [rho, mu, nu, sound] = fluid.properties();
  double sums[4] = {};
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) sums[0] += 0.5 * rho * at.volume[c] * s.u[c].squaredNorm();
  const bool before = s.u_old.size() == s.u.size();
  for (Index c = 0; s.pressure[0] && c < mesh.cells.n_owned(); ++c) {
    const Vec<D> middle = before ? Vec<D>(0.5 * (s.u[c] + s.u_old[c])) : s.u[c];
    sums[3] += at.volume[c] * s.pressure[0]->gradient[c].dot(middle);
  }
  for (Index f = 0; f < mesh.n_interior; ++f) {
    const Index p = mesh.owner[f], n = mesh.neighbour[f];
    const int owned = (p < mesh.cells.n_owned()) + (n < mesh.cells.n_owned());  // shared by two ranks: half
    sums[1] += 0.5 * owned * mu * at.conductance[f] * (s.u[n] - s.u[p]).squaredNorm();
  }
  if (fluid.fourth() && !s.implicit) sums[1] += fluid.fourth()->dissipation(mu, s.u);
  for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f)
    sums[1] +=
        mu * at.conductance[f] * (s.u_boundary[f - mesh.n_interior] - s.u[mesh.owner[f]]).squaredNorm();
  if (!s.eddy.empty()) {
    std::vector<Tensor<D>> gradient;
    velocity_gradient<D>(mesh, at, s.u, s.u_boundary, gradient);
    for (Index f = 0; f < mesh.n_interior; ++f) {
      const Index p = mesh.owner[f], n = mesh.neighbour[f];
      const int owned = (p < mesh.cells.n_owned()) + (n < mesh.cells.n_owned());
      sums[2] += 0.5 * owned * rho * eddy_stress<D>(at, s.eddy, s.u, gradient, f, p, n).dot(s.u[n] - s.u[p]);
    }
    for (const Index b : fluid.boundary().rows().of_mirror) {
      const Index f = mesh.n_interior + b, p = mesh.owner[f];
      sums[2] +=
          rho *
          mirrored_eddy_stress<D>(at, s.eddy[p], s.u[p], s.u_boundary[b], f).dot(s.u_boundary[b] - s.u[p]);
    }
  }
  if (!s.excess.empty())
    sums[1] += rho * excess_dissipation<D>(mesh, fluid.boundary(), fluid.parameters(), s);
  MPI_Allreduce(MPI_IN_PLACE, sums, 4, MPI_DOUBLE, MPI_SUM, mesh.comm);
  return {sums[0], sums[1], sums[2], sums[3]};
}

template decltype(wall_units<2>) wall_units<2>;
template decltype(wall_units<3>) wall_units<3>;
template decltype(summarise_wall<2>) summarise_wall<2>;
template decltype(summarise_wall<3>) summarise_wall<3>;
template decltype(force_coefficients<2>) force_coefficients<2>;
template decltype(force_coefficients<3>) force_coefficients<3>;
template decltype(energy_budget<2>) energy_budget<2>;
template decltype(energy_budget<3>) energy_budget<3>;

template <int D>
FlowQuantities<D>::FlowQuantities(const Fluid<D>& fluid) : fluid_(fluid), pressure_(fluid.pressure()) {
  const State<D>& s = fluid.state();
  all_.push_back({"velocity", "m/s", D, flat<D>(s.u), flat<D>(s.u_boundary)});
  if (pressure_)
    all_.push_back({"pressure", "Pa", 1, pressure_->p, pressure_->boundary});
  else
    all_.push_back({"pressure", "Pa", 1, keep(std::vector<double>(fluid.mesh().cells.n_local(), 0.0)), {}});
  if (const auto& heat = fluid.parameters().heat) {
    const auto absolute = [&](std::vector<double> values) {
      for (double& t : values) t += heat->reference_temperature;
      return keep(std::move(values));
    };
    all_.push_back({"temperature", "K", 1, absolute(s.heat.temperature), absolute(s.heat.boundary)});
  }
}

template <int D>
std::span<const double> FlowQuantities<D>::keep(std::vector<double> values) {
  kept_.push_back(std::move(values));
  return kept_.back();
}

/// `values`: cells first, then boundary faces.
template <int D>
void FlowQuantities<D>::add(const char* name, const char* unit, int components,
                            std::span<const double> values, std::size_t cells) {
  const std::size_t n = cells * static_cast<std::size_t>(components);
  all_.push_back({name, unit, components, values.first(n), values.subspan(n)});
}

template <int D>
void FlowQuantities<D>::add(const RunningStatistics<D>& statistics) {
  const std::size_t n = statistics.cells();
  const Vectors<D> velocity_rms = statistics.velocity_rms();
  const std::span<const double> rms = flat<D>(velocity_rms);
  add("velocity-mean", "m/s", D, flat<D>(statistics.velocity_mean()), n);
  add("pressure-mean", "Pa", 1, statistics.pressure_mean(), n);
  add("velocity-rms", "m/s", D, keep({rms.begin(), rms.end()}), n);
  add("pressure-rms", "Pa", 1, keep(statistics.pressure_rms()), n);
}

template <int D>
void FlowQuantities<D>::add_in_cells(const RunningStatistics<D>* statistics) {
  const State<D>& s = fluid_.state();
  const FluidOutputParameters& wanted = fluid_.parameters().output;
  const std::size_t n = s.u.size();
  std::vector<Tensor<D>> gradient;
  for (const GradientField& field : gradient_fields()) {
    const auto asked = wanted.gradient_fields.find(field.name);
    if (asked == wanted.gradient_fields.end() || !asked->second) continue;
    if (gradient.empty()) velocity_gradient<D>(fluid_.mesh(), *s.placement, s.u, s.u_boundary, gradient);
    const int components = field.is_vector && D == 3 ? 3 : 1, first = field.is_vector && D == 2 ? 2 : 0;
    std::vector<double> values;
    for (const Tensor<D>& g : gradient) {
      Tensor3 whole = Tensor3::Zero();
      whole.template topLeftCorner<D, D>() = g;
      const Vec3 value = field.value(whole);
      for (int i = first; i < first + components; ++i) values.push_back(value[i]);
    }
    add(field.name, field.unit, components, keep(std::move(values)), n);
  }
  if (wanted.viscosity) {
    if (gradient.empty()) velocity_gradient<D>(fluid_.mesh(), *s.placement, s.u, s.u_boundary, gradient);
    add("viscosity", "Pa s", 1, keep(viscosity_in_cells<D>(fluid_.parameters(), s, gradient)), n);
  }
  if (!s.eddy.empty()) add("eddy-viscosity", "m^2/s", 1, s.eddy, n);
  if (statistics)
    add("reynolds-shear", "m^2/s^2", RunningStatistics<D>::n_shear, keep(statistics->reynolds_shear()), n);
}

template <int D>
int FlowQuantities<D>::width() const {
  int sum = 0;
  for (const FlowQuantity& quantity : all_) sum += quantity.components;
  return sum;
}

template class FlowQuantities<2>;
template class FlowQuantities<3>;

}  // namespace couplet::fluid
