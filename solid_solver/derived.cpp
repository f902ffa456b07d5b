// SPDX-License-Identifier: Apache-2.0
// Strains, stresses and accelerations from the accepted state.
#include <algorithm>
#include <cmath>

#include "solid_solver/output.hpp"
#include "solid_solver/solid.hpp"
#include "solid_solver/spectrum.hpp"

namespace couplet {
namespace {

Tensor3 symmetric(const Tensor3& gradient) { return 0.5 * (gradient + gradient.transpose()); }

/// Green's strain (F^T F - I) / 2; entry (i, j) of the gradient is d u_j / d x_i.
Tensor3 green(const Tensor3& gradient) { return symmetric(gradient) + 0.5 * gradient * gradient.transpose(); }

}  // namespace

/// Those of all flux faces. `cells`, `faces`, `points`: of all local ones. Collective.
void Solid::visit_gradients(std::span<const double> cells, std::span<const double> faces,
                            std::span<const double> points, const ElasticKernel::TakeGradient& take) const {
  kernel_.face_gradients(unknowns_of(cells, faces), known_of(faces, points), take, 0, mesh_.n_flux_faces());
}

/// Those of the flux faces first, first + 1, ... Collective.
std::vector<Tensor3> Solid::face_gradients(Index first, Index count, std::span<const double> cells,
                                           std::span<const double> faces,
                                           std::span<const double> points) const {
  std::vector<Tensor3> gradients(count);
  const auto take = [&](Index f, const Tensor3& gradient) { gradients[f - first] = gradient; };
  kernel_.face_gradients(unknowns_of(cells, faces), known_of(faces, points), take, first, first + count);
  return gradients;
}

std::vector<Tensor3> Solid::face_stress(Index first, Index count, std::span<const double> points) const {
  if (finite_) return finite_face_stress(first, count);
  std::vector<Tensor3> stress = face_gradients(first, count, state_.cell_u, state_.face_u, points);
  for (Index i = 0; i < count; ++i) stress[i] = elastic_.stress(mesh_.owner[first + i], stress[i]);
  for (const auto& effect : effects_) effect->add_face_stress(first, stress);
  return stress;
}

std::vector<Tensor3> Solid::face_strain(Index first, Index count, std::span<const double> points) const {
  std::vector<Tensor3> strain = face_gradients(first, count, state_.cell_u, state_.face_u, points);
  for (Tensor3& e : strain) e = finite_ ? green(e) : symmetric(e);
  return strain;
}

std::vector<Tensor3> Solid::cell_strain(std::span<const double> points) const {
  std::vector<Tensor3> strain = cell_gradient(points);
  for (Tensor3& e : strain) e = finite_ ? green(e) : symmetric(e);
  return strain;
}

std::vector<Tensor3> Solid::cell_stress(std::span<const double> points) const {
  if (finite_) return finite_cell_stress();
  std::vector<Tensor3> stress = cell_gradient(points);
  for (std::size_t c = 0; c < stress.size(); ++c) stress[c] = elastic_.stress(Index(c), stress[c]);
  for (const auto& effect : effects_) effect->add_cell_stress(stress);
  // Across a 2-D scene: lambda tr(epsilon) in plane strain (it stands there already), nothing in plane
  // stress.
  if (mesh_.dim == 2 && parameters_.plane == SolidParameters::Plane::stress)
    for (Tensor3& s : stress) s(2, 2) = 0;
  return stress;
}

std::vector<std::complex<double>> Solid::eigenvalues() const {
  if (has_mass_)
    return symmetric_spectrum(
        mesh_, elastic_.n_unknowns(),
        [&](std::span<const double> x, std::span<double> y) { kernel_.apply(x, {}, y); },
        [&](std::span<const double> x, std::span<double> y) { kernel_.apply_with_mass(x, {}, 1, false, y); });
  std::vector<double> mass;
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) mass.push_back(density(c) * mesh_.reference.volume[c]);
  const std::vector<double> still(known_accepted_.size(), 0);
  return spectrum(mesh_, mass, elastic_.n_unknowns(),
                  [&](std::span<const double> x, std::span<double> y) { kernel_.apply(x, still, y); });
}

std::optional<SolidProblem> Solid::vibration() const {
  if (!has_mass_) return {};
  return SolidProblem{mesh_, elastic_, {}, kernel_, 0};
}

const PointTensors& Solid::point_tensors() const {
  if (!point_tensors_) {
    std::vector<bool> is_symmetry;
    for (const Patch& patch : mesh_.patches) {
      const auto found = parameters_.boundaries.find(patch.name);
      is_symmetry.push_back(found != parameters_.boundaries.end() && found->second.parts.empty() &&
                            found->second.type == SolidBoundary::Type::symmetry);
    }
    point_tensors_ = std::make_unique<PointTensors>(mesh_, is_symmetry, elastic_.vertices());
  }
  return *point_tensors_;
}

std::vector<double> Solid::point_stress(std::span<const double> points) const {
  std::vector<Tensor3> faces = face_stress(mesh_.n_interior, mesh_.boundary.n_owned(), points);
  if (mesh_.dim == 2 && parameters_.plane == SolidParameters::Plane::stress)
    for (Tensor3& s : faces) s(2, 2) = 0;
  return point_tensors().interpolate(cell_stress(points), faces);
}

std::vector<double> Solid::point_strain(std::span<const double> points) const {
  return point_tensors().interpolate(cell_strain(points),
                                     face_strain(mesh_.n_interior, mesh_.boundary.n_owned(), points));
}

bool Solid::wants_acceleration() const {
  if (!is_dynamic()) return false;
  return parameters_.output.acceleration || parameters_.step_control ||
         std::ranges::any_of(parameters_.probes, [](const auto& entry) {
           return std::ranges::count(entry.second.fields, "acceleration") > 0;
         });
}

// The mean over a step lives in its middle, in every scheme; at n+1 it is extrapolated from the last two.
// Traction faces have that of their cell and the change of their offset's rate.
void Solid::finish_acceleration() {
  const double dt = step_.dt, slope = state_.steps > 0 ? dt / (dt + state_.dt) : 0;
  for (std::size_t i = 0; i < trial_.acceleration.size(); ++i) {
    const double mean = (trial_.cell_v[i] - state_.cell_v[i]) / dt;
    trial_.mean_acceleration[i] = mean;
    trial_.acceleration[i] = mean + slope * (mean - state_.mean_acceleration[i]);
  }
  const int dim = mesh_.dim;
  for (const Index f : elastic_.unknown_faces())
    for (int a = 0; a < dim; ++a) {
      const std::size_t b = std::size_t(f - mesh_.n_interior) * dim + a;
      const std::size_t c = std::size_t(mesh_.owner[f]) * dim + a;
      // Faces with inertia: as their cell, with what their own velocity changes more.
      const double rate = trial_.face_v[b] - trial_.cell_v[c], before = state_.face_v[b] - state_.cell_v[c];
      trial_.face_acceleration[b] = trial_.acceleration[c] + (rate - before) / dt;
    }
  mesh_.cells.update_ghosts(trial_.acceleration, dim);
  mesh_.boundary.update_ghosts(trial_.face_acceleration, dim);
  elastic_.join_twins(trial_.face_acceleration);
}

/// Of the prescribed columns at the accepted time: a difference over half of the last step.
std::vector<double> Solid::known_acceleration() const {
  std::vector<double> result(known_accepted_.size(), 0), before(result.size()), now(result.size());
  if (!prescribed_.uses_time() || !(state_.dt > 0)) return result;
  const double h = 0.25 * state_.dt;
  prescribed_.evaluate(state_.time - h, before);
  prescribed_.evaluate(state_.time, now);
  prescribed_.evaluate(state_.time + h, result);
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = (result[i] - 2 * now[i] + before[i]) / (h * h);
  return result;
}

}  // namespace couplet
