// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/body/solid_body.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/error.hpp"
#include "common/elasticity/vector_at.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/boundary/checks.hpp"
#include "solid_solver/equilibrium/finite_strain.hpp"
#include "solid_solver/equilibrium/small_strain.hpp"
#include "solid_solver/method/solution_method.hpp"
#include "solid_solver/thesis/updated_lagrangian.hpp"

namespace couplet::solid {
namespace {

/// Largest Poisson's ratio of the thesis's gradient, which locks beyond it.
constexpr double most_poissons_ratio = 0.499;

/// True if a face has a vertex that is free in a direction known at the face.
bool has_loose_vertex(const mesh::Mesh& mesh, const elastic::ElasticOperator& elastic) {
  for (const Index f : elastic.known_faces()) {
    const Tensor3& known = elastic.at(f).known;
    for (const Index v : mesh.face_points[f])
      if ((known * elastic.constraints().free_part(v) * known).trace() > 0.5) return true;
  }
  return false;
}

/// With `automatic`, the symmetric gradient is not used if it would lose a part of the reaction.
elastic::FaceGradientScheme scheme_for(const mesh::Mesh& mesh, const SolidParameters& parameters,
                                       const elastic::ElasticOperator& elastic) {
  const elastic::FaceGradientScheme scheme = face_gradient_scheme(parameters);
  const bool free_to_choose = parameters.method.face_gradient == MethodParameters::FaceGradient::automatic &&
                              !has_finite_strain(parameters) && !has_orthotropic(parameters) &&
                              !is_axisymmetric(parameters) && !elastic.volume_by_cells() &&
                              !has_rigid_patch(parameters);
  if (free_to_choose && scheme == elastic::FaceGradientScheme::symmetric &&
      parallel::any(mesh.comm, has_loose_vertex(mesh, elastic)))
    return elastic::FaceGradientScheme::thesis;
  return scheme;
}

template <int D>
void interpolate(const elastic::ElasticOperator& elastic, std::span<const Index> points,
                 std::span<const double> cells, std::span<const double> faces, std::span<const double> known,
                 std::span<double> values) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const elastic::VertexConstraints& constraints = elastic.constraints();
    Vec<D> value = Vec<D>::Zero();
    if (!constraints.is_fixed(points[i])) {
      value = elastic.vertices().template scalar_at<D>(points[i], cells, faces);
      if (constraints.is_constrained(points[i]))
        value = constraints.free_part(points[i]).template topLeftCorner<D, D>() * value;
    }
    if (const Index column = constraints.column(points[i]); column >= 0)
      value += Eigen::Map<const Vec<D>>(known.data() + std::size_t(column) * D);
    for (int a = 0; a < D; ++a) values[i * D + a] = value[a];
  }
}

}  // namespace

SolidBody::SolidBody(mesh::LoadedMesh body, SolidParameters parameters)
    : mesh_(std::move(body.mesh)),
      geometry_(std::move(body.geometry)),
      parameters_(std::move(parameters)),
      materials_(materials_of(parameters_)),
      boundaries_(mesh_, geometry_, parameters_),
      elastic_(mesh_, geometry_, boundaries_.elastic(), elastic_body(parameters_, mesh_, geometry_)),
      kernel_(mesh_, elastic_, scheme_for(mesh_, parameters_, elastic_)),
      prescribed_(mesh_, boundaries_, elastic_),
      rigid_(mesh_, elastic_, boundaries_.rigid_faces()) {
  check_supports();
  make_equilibrium();
  find_mass();
  if (parameters_.contact) make_seat();
  if (!parameters_.body_force.empty())
    body_force_ = fv::make_expressions(parameters_.body_force, mesh_.dim, "body-force");
  if (parameters_.heat || parameters_.temperature ||
      (parameters_.interface_data && parameters_.interface_data->temperature))
    thermal_ = std::make_unique<ThermalLoad>(mesh_, elastic_, parameters_);
}

void SolidBody::make_equilibrium() {
  const auto keep = [this](auto made) {
    auto* kept = made.get();
    equilibrium_ = std::move(made);
    return kept;
  };
  if (!has_finite_strain(parameters_))
    keep(std::make_unique<SmallStrain>(mesh_, kernel_, elastic_, thermal_, parameters_));
  else if (is_updated_lagrangian(parameters_))
    large_strain_ = updated_lagrangian_ =
        keep(std::make_unique<UpdatedLagrangian>(mesh_, elastic_, parameters_));
  else
    large_strain_ = finite_strain_ = keep(std::make_unique<FiniteStrain>(mesh_, elastic_, parameters_));
}

void SolidBody::check_supports() const {
  check_mesh(mesh_, geometry_, elastic_.vertices());
  check_symmetry(parameters_, mesh_, elastic_);
  if (is_axisymmetric(elastic_)) check_axis(mesh_, elastic_);
  if (!parameters_.gravity.empty() && std::ssize(parameters_.gravity) != mesh_.dim)
    throw Error("gravity: {} components are given, but the {}-dimensional case needs {}.",
                parameters_.gravity.size(), mesh_.dim, mesh_.dim);
  if (!is_dynamic()) check_supported(mesh_, elastic_);
}

void SolidBody::make_seat() {
  if (!kernel_.is_symmetric())
    throw Error(
        "contact: the seat needs the symmetric face gradient, but the boundaries or the method of this solid require another: "
        "use 'solution-method: {{face-gradient: symmetric}}'.");
  std::vector<std::uint8_t> open;
  for (Index f = mesh_.n_interior; f < mesh_.n_flux_faces(); ++f) open.push_back(elastic_.at(f).is_free());
  seat_ = std::make_unique<Seat>(mesh_, elastic_, kernel_, *parameters_.contact, open, !is_dynamic());
}

void SolidBody::find_mass() {
  bool has_no_energy = false;
  for (Index f = mesh_.n_interior; f < mesh_.n_flux_faces(); ++f)
    has_no_energy = has_no_energy || elastic_.at(f).level;
  if (kernel_.is_symmetric() && parallel::any(mesh_.comm, has_no_energy))
    throw Error(
        "solution-method.face-gradient: symmetric: a boundary of 'type: zero-normal-gradient' has no energy functional, so "
        "this gradient does not support it; use 'symmetry' or 'frictionless', or 'face-gradient: thesis'.");
  if (kernel_.is_symmetric() && parallel::any(mesh_.comm, has_loose_vertex(mesh_, elastic_)))
    throw Error(
        "solution-method.face-gradient: symmetric: a part of a patch prescribes components of the displacement, but not those "
        "of the vertices at its edge; this gradient would lose part of the reaction there. Give the part its own patch, "
        "prescribe all components, or use 'face-gradient: thesis'.");
  if (!kernel_.is_symmetric() && largest_poissons_ratio(parameters_) > most_poissons_ratio)
    throw Error(
        "material.poissons-ratio: {:g} exceeds {:g}, the limit of 'face-gradient: thesis'; "
        "use 'symmetric' (with 'solution-method: {{type: auto}}' and without 'zero-normal-gradient').",
        largest_poissons_ratio(parameters_), most_poissons_ratio);
  if (!is_dynamic()) return;
  std::vector<double> densities;
  for (Index c = 0; c < mesh_.cells.n_local(); ++c) densities.push_back(density(c));
  has_mass_ = kernel_.set_density(densities);
  if (finite_strain_) finite_strain_->set_density(densities);
}

bool SolidBody::apply_stiffness() {
  const auto lame = thermal_ ? thermal_->stiffness() : std::span<const elastic::LameConstants>{};
  if (lame.empty()) return false;
  elastic_.set_lame({lame.begin(), lame.end()});
  kernel_ = elastic::ElasticKernel(mesh_, elastic_, kernel_.scheme());
  find_mass();
  return true;
}

void SolidBody::place_expansion(double t) const {
  if (thermal_ && finite_strain_) finite_strain_->set_expansion(thermal_->expansion(t));
}

std::vector<double> SolidBody::scaled(std::vector<double> values) const {
  if (load_factor_ != 1)
    for (double& v : values) v *= load_factor_;
  return values;
}

std::vector<double> SolidBody::dead_loads(double t) const {
  if (t != time_of_dead_loads_) {
    dead_loads_.assign(boundaries_.n_forces(), 0);
    boundaries_.add_forces(t, dead_loads_, !large_strain_);
    time_of_dead_loads_ = t;
  }
  return scaled(dead_loads_);
}

std::vector<double> SolidBody::body_forces(double t, const Vec3& shift) const {
  if (!has_body_forces()) return {};
  const int dim = mesh_.dim;
  std::vector<double> forces(std::size_t(mesh_.cells.n_owned()) * dim);
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
    for (int a = 0; a < dim; ++a) {
      double force = body_force_.empty() ? 0 : body_force_[a](geometry_.cell_centre[c] + shift, t);
      if (!parameters_.gravity.empty()) force += density(c) * parameters_.gravity[a];
      forces[std::size_t(c) * dim + a] = force * geometry_.volume[c];  // (2.59)
    }
  return scaled(std::move(forces));
}

std::vector<double> SolidBody::known_acceleration(double start, double dt) const {
  if (!prescribed_.uses_time()) return {};
  std::vector<double> before(prescribed_.size() * mesh_.dim), after(before);
  prescribed_.evaluate_rate(start, dt, before);
  prescribed_.evaluate_rate(start + dt, dt, after);
  for (std::size_t i = 0; i < after.size(); ++i) after[i] = (after[i] - before[i]) / dt;
  return after;
}

std::vector<double> SolidBody::known_velocity(double start, double dt) const {
  if (!prescribed_.uses_time()) return {};
  std::vector<double> before(prescribed_.size() * mesh_.dim), after(before);
  prescribed_.evaluate(start, before);
  prescribed_.evaluate(start + dt, after);
  for (std::size_t i = 0; i < after.size(); ++i) after[i] = (after[i] - before[i]) / dt;
  return after;
}

double SolidBody::lowest_stiffness(std::span<const double> unknowns, std::span<const double> known) const {
  if (!finite_strain_) return 1;
  return finite_strain_->lowest_stiffness(
      unknowns, known, [this](std::span<const double> x, std::span<double> y) { kernel_.apply(x, {}, y); },
      any_start());
}

std::vector<double> SolidBody::any_start() const {
  const mesh::Extent box = mesh::extent_of(mesh_, geometry_);
  const double size = box.diagonal();
  std::vector<double> start;
  const auto add = [&](const Vec3& x) {
    const Vec3 s = (x - box.lower) / size;
    for (int a = 0; a < mesh_.dim; ++a) {
      double value = 0;
      for (int k = 1; k <= 4; ++k)
        value += std::sin(k * (2.1 * s[0] + 2.7 * s[1] + 3.3 * s[2]) + 0.7 + 1.9 * a + 0.37 * k) / (k * k);
      start.push_back(value);
    }
  };
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) add(geometry_.cell_centre[c]);
  for (const Index f : elastic_.unknown_faces()) add(geometry_.face_centre[f]);
  return start;
}

bool SolidBody::wants_acceleration() const {
  if (!is_dynamic()) return false;
  return parameters_.output.acceleration || parameters_.step_control ||
         std::ranges::any_of(parameters_.probes, [](const auto& entry) {
           return std::ranges::count(entry.second.fields, "acceleration") > 0;
         });
}

// Values at points and gradients at faces of a field that is given in cells and on the boundary.

std::vector<double> SolidBody::at_points(std::span<const Index> points, std::span<const double> cells,
                                         std::span<const double> faces, std::span<const double> known) const {
  std::vector<double> values(points.size() * mesh_.dim);
  if (mesh_.dim == 2)
    interpolate<2>(elastic_, points, cells, faces, known, values);
  else
    interpolate<3>(elastic_, points, cells, faces, known, values);
  return values;
}

std::vector<double> SolidBody::to_points(std::span<const double> cells, std::span<const double> faces,
                                         std::span<const double> known) const {
  std::vector<double> values;
  if (kernel_.scheme() == elastic::FaceGradientScheme::thesis) {
    std::vector<Index> all(mesh_.points.n_local());
    for (Index v = 0; v < mesh_.points.n_local(); ++v) all[v] = v;
    values = at_points(all, cells, faces, known);
  } else {
    values.assign(std::size_t(mesh_.points.n_local()) * mesh_.dim, 0);
    kernel_.point_values(unknowns_of(cells, faces), known, values);
  }
  mesh_.points.update_ghosts(values, mesh_.dim);
  return values;
}

std::vector<double> SolidBody::unknowns_of(std::span<const double> cells,
                                           std::span<const double> faces) const {
  const std::size_t dim = mesh_.dim, n_cells = mesh_.cells.n_owned() * dim;
  std::vector<double> unknowns(cells.begin(), cells.begin() + std::ptrdiff_t(n_cells));
  for (const Index f : elastic_.unknown_faces()) {
    const auto first = faces.begin() + std::ptrdiff_t((f - mesh_.n_interior) * dim);
    unknowns.insert(unknowns.end(), first, first + std::ptrdiff_t(dim));
  }
  return unknowns;
}

/// Prescribed directions of points, and known faces.
std::vector<double> SolidBody::known_of(const BodyField& field) const {
  const int dim = mesh_.dim;
  const elastic::VertexConstraints& constraints = elastic_.constraints();
  std::vector<double> known(elastic_.n_known() * dim, 0);
  for (const Index v : constraints.points()) {
    const Vec3 u = elastic::vector_at(field.points, v, dim), held = u - constraints.free_part(v) * u;
    for (int a = 0; a < dim; ++a) known[std::size_t(constraints.column(v)) * dim + a] = held[a];
  }
  for (const Index f : elastic_.known_faces()) {
    const Vec3 u = elastic::vector_at(field.faces, f - mesh_.n_interior, dim);
    for (int a = 0; a < dim; ++a) known[std::size_t(elastic_.known_of_face(f)) * dim + a] = u[a];
  }
  return known;
}

void SolidBody::visit_gradients(const BodyField& field,
                                const elastic::ElasticKernel::TakeGradient& take) const {
  kernel_.face_gradients(unknowns_of(field.cells, field.faces), known_of(field), take, 0,
                         mesh_.n_flux_faces());
}

std::vector<Tensor3> SolidBody::face_gradients(Index first, Index count, const BodyField& field) const {
  std::vector<Tensor3> gradients(count);
  const auto take = [&](Index f, const Tensor3& gradient) { gradients[f - first] = gradient; };
  kernel_.face_gradients(unknowns_of(field.cells, field.faces), known_of(field), take, first, first + count);
  return gradients;
}

}  // namespace couplet::solid
