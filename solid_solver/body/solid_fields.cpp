// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/body/solid_fields.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "common/parallel/collective.hpp"

namespace couplet::solid {
namespace {

/// Outward unit normal of a boundary face with points at `places`, oriented as the reference one.
Vec3 normal_at(const mesh::Mesh& mesh, const mesh::Geometry& geometry, Index face,
               std::span<const Vec3> places) {
  const auto corners = mesh.face_points[face];
  if (corners.size() == 2) {
    const auto turned = [&](std::span<const Vec3> x) {
      const Vec3 along = x[corners[1]] - x[corners[0]];
      return Vec3(along.y(), -along.x(), 0);
    };
    const double side = turned(geometry.points).dot(geometry.face_area[face]) > 0 ? 1 : -1;
    return side * turned(places).normalized();
  }
  Vec3 area = Vec3::Zero();
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    area += (places[corners[i]] - places[corners[0]]).cross(places[corners[i + 1]] - places[corners[0]]);
  return area.normalized();
}

/// Converts displacement gradients, entry (i, j) = d u_j/d x_i, to strains: at large strain Green's, (F^T F - I)/2.
void to_strain(bool is_large, std::span<Tensor3> gradients) {
  for (Tensor3& g : gradients) {
    const Tensor3 linear = 0.5 * (g + g.transpose());
    g = is_large ? Tensor3(linear + 0.5 * g * g.transpose()) : linear;
  }
}

Tensor3 mean_stress(std::span<const Index> corners, std::span<const double> point_stress) {
  Tensor3 mean = Tensor3::Zero();
  for (const Index v : corners)
    mean += unpack(point_stress.subspan(std::size_t(v) * tensor_size, tensor_size));
  return mean / double(corners.size());
}

}  // namespace

SolidFields::SolidFields(const SolidBody& body, const SolidState& state, const LastSolve& last)
    : body_(body),
      state_(state),
      last_(last),
      mesh_(body.mesh()),
      geometry_(body.geometry()),
      parameters_(body.parameters()),
      elastic_(body.elastic()) {}

std::vector<double> SolidFields::point_displacement() const {
  return body_.to_points(state_.cell_u, state_.face_u, state_.known);
}

std::vector<double> SolidFields::point_velocity() const {
  return body_.to_points(state_.cell_v, state_.face_v, state_.known_rate);
}

std::vector<double> SolidFields::point_acceleration() const {
  return body_.to_points(state_.acceleration, state_.face_acceleration, known_acceleration());
}

/// Acceleration of the prescribed columns at the accepted time, a difference over half of the last step.
std::vector<double> SolidFields::known_acceleration() const {
  std::vector<double> result(state_.known.size(), 0), before(result.size()), now(result.size());
  if (!body_.prescribed().uses_time() || !(state_.dt > 0)) return result;
  const double h = 0.25 * state_.dt;
  body_.prescribed().evaluate(state_.time - h, before);
  body_.prescribed().evaluate(state_.time, now);
  body_.prescribed().evaluate(state_.time + h, result);
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = (result[i] - 2 * now[i] + before[i]) / (h * h);
  return result;
}

Displaced SolidFields::displaced(std::span<const double> points) const {
  return {[this] { return body_.unknowns_of(state_.cell_u, state_.face_u); }, state_.known,
          [this, points](Index first, Index count) {
            return body_.face_gradients(first, count, displacement(points));
          },
          [this, points] { return cell_gradient(points); }};
}

std::vector<Tensor3> SolidFields::face_stress(Index first, Index count,
                                              std::span<const double> points) const {
  return body_.equilibrium().face_stress(displaced(points), first, count);
}

std::vector<Tensor3> SolidFields::face_strain(Index first, Index count,
                                              std::span<const double> points) const {
  std::vector<Tensor3> strain = body_.face_gradients(first, count, displacement(points));
  to_strain(body_.large_strain(), strain);
  return strain;
}

std::vector<Tensor3> SolidFields::cell_strain(std::span<const double> points) const {
  std::vector<Tensor3> strain = cell_gradient(points);
  to_strain(body_.large_strain(), strain);
  return strain;
}

std::vector<Tensor3> SolidFields::cell_stress(std::span<const double> points) const {
  return body_.equilibrium().cell_stress(displaced(points));
}

const PointTensors& SolidFields::point_tensors() const {
  if (!point_tensors_) {
    std::vector<bool> is_symmetry;
    for (const mesh::Patch& patch : mesh_.patches) {
      const auto found = parameters_.boundaries.find(patch.name);
      is_symmetry.push_back(found != parameters_.boundaries.end() && found->second.parts.empty() &&
                            is_symmetry_plane(found->second));
    }
    point_tensors_ = std::make_unique<PointTensors>(mesh_, geometry_, is_symmetry, elastic_.vertices());
  }
  return *point_tensors_;
}

/// Tractions of boundary faces of owned cells at small strain, from the loads; no shear at symmetry planes.
std::vector<SurfaceTraction> SolidFields::known_tractions() const {
  const std::vector<double> forces = loads_now().faces;
  std::vector<SurfaceTraction> result(std::size_t(mesh_.boundary.n_owned()));
  for (std::size_t b = 0; b < result.size(); ++b) {
    const Index f = mesh_.n_interior + Index(b);
    const double area = geometry_.face_area[f].norm();
    SurfaceTraction& known = result[b];
    const elastic::BoundaryRow& row = elastic_.at(f);
    if (row.is_free() && !body_.boundaries().knows_traction(f)) continue;
    if (row.spring.isZero(0)) known.projector = Tensor3::Identity() - row.transmitted;
    known.symmetry = row.mirrored;
    if (row.mirrored || row.fixed || row.level || row.shared) continue;
    Vec3 force = Vec3::Zero();
    for (int a = 0; a < mesh_.dim; ++a) force[a] = forces[b * std::size_t(mesh_.dim) + std::size_t(a)];
    known.traction = known.projector * force / area;
  }
  return result;
}

DiscreteStress SolidFields::discrete_stress(std::span<const double> points) const {
  DiscreteStress found{cell_stress(points),
                       face_stress(mesh_.n_interior, mesh_.boundary.n_owned(), points),
                       {},
                       {},
                       state_.cell_u,
                       state_.face_u,
                       known_tractions()};
  const ThermalLoad* thermal = body_.thermal();
  if (!thermal) return found;
  found.other_in_cells.assign(found.cells.size(), Tensor3::Zero());
  found.other_on_faces.assign(found.faces.size(), Tensor3::Zero());
  thermal->add_cell_stress(found.other_in_cells);
  thermal->add_face_stress(mesh_.n_interior, found.other_on_faces);
  return found;
}

bool recovers_stress(const SolidBody& body) {
  return !body.large_strain() && !is_axisymmetric(body.elastic());
}

const StressRecovery& SolidFields::recovery() const {
  if (!recovery_)
    recovery_ = std::make_unique<StressRecovery>(
        mesh_, elastic_, mesh_.dim == 2 && parameters_.plane == SolidParameters::Plane::stress);
  return *recovery_;
}

SidedTensors SolidFields::stress_sides(std::span<const double> points,
                                       std::span<const std::uint8_t> wanted) const {
  if (!recovers_stress(body_)) {
    const std::vector<Tensor3> faces = face_stress(mesh_.n_interior, mesh_.boundary.n_owned(), points);
    return point_tensors().interpolate(cell_stress(points), faces);
  }
  return recovery().at_points(discrete_stress(points), wanted);
}

SidedTensors SolidFields::strain_sides(std::span<const double> points) const {
  return point_tensors().interpolate(cell_strain(points),
                                     face_strain(mesh_.n_interior, mesh_.boundary.n_owned(), points));
}

// Gradients of the displacement in cells, from which stress and strain follow.

/// Mean of the face gradients weighted by the pyramids over the faces; exact for linear gradients if those of the faces are.
std::vector<Tensor3> SolidFields::cell_gradient(std::span<const double> points) const {
  const Index n_owned = mesh_.cells.n_owned();
  std::vector<Tensor3> gradient(n_owned, Tensor3::Zero());
  std::vector<double> weight(n_owned, 0);
  body_.visit_gradients(displacement(points), [&](Index f, const Tensor3& here) {
    const auto add = [&](Index c) {
      if (c >= n_owned) return;
      const Vec3 arm = geometry_.face_centre[f] - geometry_.cell_centre[c];
      const double pyramid = std::abs(arm.dot(geometry_.face_area[f]));
      gradient[c] += pyramid * here;
      weight[c] += pyramid;
    };
    add(mesh_.owner[f]);
    if (f < mesh_.n_interior) add(mesh_.neighbour[f]);
  });
  for (Index c = 0; c < n_owned; ++c) gradient[c] /= weight[c];
  return gradient;
}

// Tractions of boundary faces: from known loads, else from the stress at the faces' points.

std::vector<double> SolidFields::traction(std::span<const Vec3> places, const SidedTensors& sides) const {
  const std::size_t n = mesh_.boundary.n_owned(), dim = mesh_.dim;
  // Tractions are known on the undeformed surface.
  const std::span<const Vec3> moved = body_.large_strain() ? places : std::span<const Vec3>{};
  const std::vector<SurfaceTraction> known =
      moved.empty() ? known_tractions() : std::vector<SurfaceTraction>(n);
  std::vector<double> result(n * dim);
  for (std::size_t b = 0; b < n; ++b) {
    const Index f = mesh_.n_interior + Index(b);
    const Vec3 normal =
        moved.empty() ? geometry_.face_area[f].normalized() : normal_at(mesh_, geometry_, f, moved);
    const auto& side = sides[std::size_t(mesh_.material_of(mesh_.owner[f]))];
    const Vec3 here = mean_stress(mesh_.face_points[f], side) * normal;
    const Vec3 value = known[b].traction + here - known[b].projector * here;
    for (std::size_t a = 0; a < dim; ++a) result[b * dim + a] = value[Index(a)];
  }
  return result;
}

// Forces on the solid, and the largest strain, rotation and stress of the accepted state.

namespace {

/// Sum over the ranks. Collective.
elastic::Wrench sum_of(const elastic::Wrench& here, MPI_Comm comm) {
  elastic::Wrench total;
  double numbers[6];
  for (int a = 0; a < 3; ++a) numbers[a] = here.force[a], numbers[3 + a] = here.moment[a];
  MPI_Allreduce(MPI_IN_PLACE, numbers, 6, MPI_DOUBLE, MPI_SUM, comm);
  for (int a = 0; a < 3; ++a) total.force[a] = numbers[a], total.moment[a] = numbers[3 + a];
  return total;
}

}  // namespace

std::vector<PatchForce> SolidFields::reactions(std::span<const double> points) const {
  std::vector<PatchForce> forces = reactions_by_trial_functions();
  if (!forces.empty()) return forces;
  // Loops only from the first to the last held face, often a small part of the boundary.
  Index first = mesh_.n_flux_faces(), end = mesh_.n_interior;
  for (std::size_t p = 0; p < mesh_.patches.size(); ++p) {
    const mesh::Patch& patch = mesh_.patches[p];
    if (!body_.boundaries().holds(p) || patch.count == 0) continue;
    first = std::min(first, patch.first);
    end = std::max(end, patch.first + patch.count);
  }
  const std::vector<Tensor3> stress = face_stress(first, std::max<Index>(end - first, 0), points);
  for (std::size_t p = 0; p < mesh_.patches.size(); ++p) {
    if (!body_.boundaries().holds(p)) continue;
    const mesh::Patch& patch = mesh_.patches[p];
    elastic::Wrench held;
    for (Index f = patch.first; f < patch.first + patch.count; ++f)
      held.add(elastic_.holding_force(f, stress[f - first], state_.face_u, state_.known),
               geometry_.face_centre[f]);
    forces.push_back({sum_of(held, mesh_.comm), patch.name});
  }
  return forces;
}

/// Reactions as residual of the stress; empty for a gradient without trial functions.
std::vector<PatchForce> SolidFields::reactions_by_trial_functions() const {
  std::vector<PatchForce> forces;
  const std::vector<double> u = body_.unknowns_of(state_.cell_u, state_.face_u);
  body_.place_pressures(state_.time);
  const std::vector<elastic::Wrench> held = body_.equilibrium().holding_forces(u, state_.known, loads_now());
  if (held.empty()) return forces;
  for (std::size_t p = 0; p < mesh_.patches.size(); ++p) {
    if (!body_.boundaries().holds(p)) continue;
    forces.push_back({sum_of(held[p], mesh_.comm), mesh_.patches[p].name});
  }
  return forces;
}

elastic::ElasticLoads SolidFields::loads_now() const {
  elastic::ElasticLoads loads;
  loads.faces = body_.dead_loads(state_.time);
  for (std::size_t i = 0; i < last_.interface.size(); ++i) loads.faces[i] += last_.interface[i];
  if (body_.seat() && !last_.contact.empty()) body_.seat()->add_to_faces(last_.contact, loads.faces);
  loads.cells = body_.body_forces(state_.time);
  if (ThermalLoad* thermal = body_.thermal()) loads.pressure = thermal->pressure(state_.time);
  return loads;
}

Vec3 SolidFields::total_load() const {
  Vec3 load = last_.body_force + last_.face_force;
  if (body_.large_strain()) load += body_.large_strain()->pressure_force();
  for (int a = 0; a < 3; ++a) load[a] = parallel::sum(mesh_.comm, load[a]);
  return load;
}

Deformation SolidFields::deformation(std::span<const double> points) const {
  double gradient = 0, strain = 0, rotation = 0;
  body_.visit_gradients(displacement(points), [&](Index, const Tensor3& g) {
    gradient = std::max(gradient, g.squaredNorm());
    strain = std::max(strain, (0.5 * (g + g.transpose())).squaredNorm());
    rotation = std::max(rotation, (0.5 * (g - g.transpose())).squaredNorm());
  });
  // The skew part of a small rotation phi contains phi twice.
  return {.gradient = parallel::max(mesh_.comm, std::sqrt(gradient)),
          .strain = parallel::max(mesh_.comm, std::sqrt(strain)),
          .rotation = parallel::max(mesh_.comm, std::sqrt(rotation / 2))};
}

}  // namespace couplet::solid
