// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/boundary/boundaries.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/boundary/loads.hpp"

namespace couplet::solid {
namespace {

int n_corners(const mesh::Mesh& mesh) { return mesh.dim == 2 ? 2 : 4; }
Vec3 unit(const Vec3&) { return Vec3::Ones(); }

using Type = SolidCondition::Type;

// Difference of displacements that count as equal, relative to the largest prescribed one; on patches whose
// normals at points are means of faces.
constexpr double equal = 1e-6, equal_on_curved = 0.2;

std::vector<std::string> patch_names(const mesh::Mesh& mesh) {
  std::vector<std::string> names;
  for (const mesh::Patch& patch : mesh.patches)
    if (!patch.bonded) names.push_back(patch.name);
  return names;
}

}  // namespace

void check_names(const mesh::Mesh& mesh, const SolidParameters& parameters) {
  const std::vector<std::string> patches = patch_names(mesh);
  for (const auto& [name, boundary] : parameters.boundaries)
    if (std::ranges::find(patches, name) == patches.end())
      throw Error("boundaries.{}: mesh '{}' has no patch with this name. {}", name, parameters.mesh,
                  base::did_you_mean(name, patches, "patches"));
  if (parameters.analysis == SolidParameters::Analysis::thermal) return;
  for (const std::string& name : patches)
    if (!parameters.boundaries.contains(name))
      throw Error(
          "boundaries: patch '{}' of mesh '{}' has no entry; each patch needs one (a stress-free patch: "
          "'type: free'). "
          "The patches are {}.",
          name, parameters.mesh, base::join(patches));
}

SolidBoundaries::SolidBoundaries(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                 const SolidParameters& parameters)
    : mesh_(&mesh),
      geometry_(&geometry),
      is_ring_(is_axisymmetric(parameters)),
      condition_of_face_(mesh.boundary.n_local(), -1) {
  check_names(mesh, parameters);
  for (const mesh::Patch& patch : mesh.patches) {
    holds_.push_back(0);
    if (patch.bonded) continue;
    const SolidBoundary& boundary = parameters.boundaries.at(patch.name);
    holds_.back() = !is_load(boundary);
    for (const SolidPart& part : boundary.parts) holds_.back() |= !is_load(part);
    if (is_interface(boundary)) {
      if (!boundary.parts.empty())
        throw Error("boundaries.{}: an interface cannot have parts; make them separate patches.", patch.name);
      interface_patches_.push_back(patch.name);
    }
    choose_faces(patch, boundary);
  }
  make_point_loads(parameters);
}

SolidBoundaries::Condition SolidBoundaries::make_condition(const SolidCondition& from,
                                                           const std::string& where) const {
  const int dim = mesh_->dim;
  Condition c;
  c.type = from.type;
  c.is_load = is_load(from);
  c.by_component = from.type == Type::fixed_displacement && from.value.empty();
  if (c.by_component) {
    for (int i = 0; i < dim; ++i) {
      c.known_components[i] = from.components[i].has_value();
      c.known.emplace_back(from.components[i].value_or(config::ExpressionText{}), where + ".components");
    }
    // All components are known, so the part is held like one with `value`, including its vertices.
    c.by_component = c.known_components.head(dim).minCoeff() == 0;
  } else if (from.type == Type::fixed_displacement || from.type == Type::spring) {
    if (!from.value.empty()) c.known = fv::make_expressions(from.value, dim, where + ".value");
    c.known_components.head(dim).setConstant(from.type == Type::fixed_displacement);
  }
  if (from.type == Type::roller && !fv::Expression(from.along, where + ".value").is_zero())
    for (int i = 0; i < dim; ++i)
      c.known.emplace_back(
          config::ExpressionText{fmt::format("({})*({})", from.along.text, from.normal.normalized()[i])},
          where + ".value");
  if (std::ranges::all_of(c.known, [](const fv::Expression& e) { return e.is_zero(); })) c.known.clear();
  if (from.type == Type::traction) c.traction = fv::make_expressions(from.value, dim, where + ".value");
  if (!from.traction.empty()) c.traction = fv::make_expressions(from.traction, dim, where + ".traction");
  c.presses = from.type == Type::pressure;
  if (c.presses) c.pressure = fv::Expression(from.pressure, where + ".value");
  if (from.type == Type::spring) c.stiffness = fv::Expression(from.stiffness, where + ".stiffness");
  if (c.stiffness.uses_time())
    throw Error("{}.stiffness: the stiffness of a spring cannot depend on the time t.", where);
  c.along_normal = from.along_normal;
  c.normal = from.normal.normalized();
  return c;
}

void SolidBoundaries::choose_faces(const mesh::Patch& patch, const SolidBoundary& boundary) {
  const auto own = static_cast<Index>(conditions_.size());
  const std::string where = "boundaries." + patch.name;
  conditions_.push_back(make_condition(boundary, where));
  std::vector<fv::Expression> tests;
  for (std::size_t i = 0; i < boundary.parts.size(); ++i) {
    const std::string part = fmt::format("{}.parts[{}]", where, i);
    conditions_.push_back(make_condition(boundary.parts[i], part));
    tests.emplace_back(boundary.parts[i].where, part + ".where");
  }
  const auto choose = [&](Index f) {
    Index chosen = own;
    for (std::size_t i = 0; i < tests.size() && chosen == own; ++i)
      if (tests[i](geometry_->face_centre[f], 0) != 0) chosen = own + 1 + static_cast<Index>(i);
    condition_of_face_[f - mesh_->n_interior] = chosen;
    if (f < mesh_->n_flux_faces()) conditions_[chosen].faces.push_back(f);
  };
  for (Index f = patch.first; f < patch.first + patch.count; ++f) choose(f);
  for (Index f = patch.ghost_first; f < patch.ghost_first + patch.ghost_count; ++f) choose(f);
  for (std::size_t i = 0; i < tests.size(); ++i) {
    if (parallel::any(mesh_->comm, !conditions_[own + 1 + i].faces.empty())) continue;
    bool is_taken = false;
    for (Index f = patch.first; f < patch.first + patch.count && f < mesh_->n_flux_faces(); ++f)
      is_taken = is_taken || tests[i](geometry_->face_centre[f], 0) != 0;
    throw Error(
        "{}.parts[{}].where: '{}' selects no face of patch '{}'. {}", where, i, tests[i].text(), patch.name,
        parallel::any(mesh_->comm, is_taken)
            ? "Parts before it select all of its faces, and the first one that selects a face applies; put it before them."
            : "It is evaluated at the face centers; widen it, for example to abs(z - 0.5) < half the height of a face.");
  }
  if (!tests.empty() && boundary.type != Type::free &&
      !parallel::any(mesh_->comm, !conditions_[own].faces.empty()))
    throw Error(
        "{}: its parts select all of its faces, so that its own condition acts nowhere. Make it 'free', or narrow the "
        "parts.",
        where);
  make_load(conditions_[own], boundary, where);
  for (std::size_t i = 0; i < tests.size(); ++i)
    make_load(conditions_[own + 1 + i], boundary.parts[i], fmt::format("{}.parts[{}]", where, i));
}

void SolidBoundaries::make_load(Condition& c, const SolidCondition& from, const std::string& where) const {
  if (from.type == Type::force || from.type == Type::remote_load)
    c.distributed.emplace(*mesh_, *geometry_, c.faces, from.load, from.type == Type::remote_load, where);
  c.is_rigid = is_rigid(from);
  if (from.type == Type::bearing_load) c.bearing.emplace(*mesh_, *geometry_, c.faces, from.load, where);
  if (from.type == Type::hydrostatic_pressure) c.liquid.emplace(*mesh_, *geometry_, from.load, where);
}

void SolidBoundaries::make_point_loads(const SolidParameters& parameters) {
  if (parameters.point_loads.empty()) return;
  std::vector<std::uint8_t> open(mesh_->boundary.n_owned());
  for (std::size_t b = 0; b < open.size(); ++b)
    open[b] = condition_of_face_[b] >= 0 && at(static_cast<Index>(b)).is_load;
  for (const auto& [name, load] : parameters.point_loads) {
    const std::string where = "point-loads." + name;
    point_loads_.emplace_back(*mesh_, *geometry_, faces_of_point_load(*mesh_, *geometry_, load, open, where),
                              load, load.radius > 0, where);
  }
}

/// Row of a condition type: its projector and its stiffness at a face.
elastic::BoundaryRow SolidBoundaries::row_at(const Condition& c, Index face) const {
  const Vec3 n = geometry_->face_area[face].normalized();
  const Tensor3 none = Tensor3::Zero(), across = n * n.transpose(), lifted = c.normal * c.normal.transpose();
  switch (c.type) {
    case Type::symmetry:
      return elastic::mirror_row();
    case Type::zero_normal_gradient:
      return elastic::level_row();
    case Type::fixed_displacement:
      return c.by_component ? elastic::support_row(c.known_components.asDiagonal(), none)
                            : elastic::fixed_row();
    case Type::frictionless:
      return elastic::support_row(across, none);
    case Type::roller:
    case Type::soft_support:
      return elastic::support_row(lifted, none);
    case Type::hard_support: {
      const Vec3 along = n.cross(c.normal);
      // At the top and bottom of the plate there is no edge direction.
      const bool has_edge = along.norm() > 1e-3;
      return elastic::support_row(
          has_edge ? Tensor3(lifted + along * along.transpose() / along.squaredNorm()) : lifted, none);
    }
    case Type::spring: {
      const double stiffness = c.stiffness(geometry_->face_centre[face], 0);
      if (stiffness < 0)
        throw Error("boundaries: the spring stiffness '{}' is {:g} N/m^3 at a face; it must not be negative.",
                    c.stiffness.text(), stiffness);
      return elastic::support_row(none, stiffness * (c.along_normal ? across : Tensor3::Identity()));
    }
    default:
      return elastic::free_row();
  }
}

elastic::ElasticBoundary SolidBoundaries::elastic() const {
  elastic::ElasticBoundary result;
  for (std::size_t b = 0; b < condition_of_face_.size(); ++b)
    result.add(condition_of_face_[b] < 0
                   ? elastic::free_row()  // between materials
                   : row_at(at(static_cast<Index>(b)), mesh_->n_interior + static_cast<Index>(b)));
  return result;
}

double SolidBoundaries::Condition::pressure_at(const Vec3& x, double level, double t) const {
  return liquid ? liquid->at(x, level) : pressure(x, t);
}

bool SolidBoundaries::Condition::varies() const {
  return liquid || pressure.uses_space() ||
         std::ranges::any_of(traction, [](const fv::Expression& e) { return e.uses_space(); });
}

/// Means of a load over a face, per circumference at the face center on a ring.
fv::FaceMean SolidBoundaries::mean_over(Index f, const std::function<Vec3(const Vec3&)>& load) const {
  const double radius = geometry_->face_centre[f][0];
  if (!is_ring_ || radius == 0) return fv::mean_over_face(*mesh_, *geometry_, f, load);
  return fv::mean_over_face(*mesh_, *geometry_, f,
                            [&](const Vec3& x) { return Vec3(x[0] / radius * load(x)); });
}

std::vector<std::vector<Index>> SolidBoundaries::rigid_faces() const {
  std::vector<std::vector<Index>> faces;
  for (const Condition& c : conditions_)
    if (c.is_rigid) faces.push_back(c.faces);
  return faces;
}

std::vector<double> SolidBoundaries::pressures(double t, const Vec3& shift) const {
  const auto varies_here = [](const Condition& c) { return c.has_pressure() && c.varies(); };
  const bool varies = std::ranges::any_of(conditions_, varies_here);
  const std::size_t n = std::size_t(mesh_->boundary.n_owned()), n_places = std::size_t(1 + n_corners(*mesh_));
  std::vector<double> pressure(n * (varies ? 1 + n_places : 1), 0);
  for (const Condition& c : conditions_) {
    if (!c.has_pressure()) continue;
    const double level = c.liquid ? c.liquid->level(t) : 0;
    const auto at = [&](const Vec3& x) { return Vec3(c.pressure_at(x + shift, level, t), 0, 0); };
    for (const Index f : c.faces) {
      const std::size_t b = std::size_t(f - mesh_->n_interior);
      double* const here = varies ? pressure.data() + n + b * n_places : nullptr;  // at its node and corners
      if (!c.varies()) {
        pressure[b] = c.pressure(Vec3::Zero(), t);
        if (varies) std::fill_n(here, n_places, pressure[b]);
        continue;
      }
      const fv::FaceMean mean = mean_over(f, at), even = mean_over(f, unit);
      pressure[b] = c.liquid ? c.liquid->mean(f, level, shift) : mean.whole[0];
      double part = pressure[b], share = 1;
      for (std::size_t i = 0; i + 1 < n_places; ++i) {
        part -= mean.corner[i][0], share -= even.corner[i][0];
        here[1 + i] = even.corner[i][0] > 0 ? mean.corner[i][0] / even.corner[i][0] : 0;
      }
      here[0] = part / share;
    }
  }
  return pressure;
}

std::size_t SolidBoundaries::n_forces() const {
  const bool varies = std::ranges::any_of(conditions_, &Condition::varies);
  return mesh_->boundary.n_owned() * std::size_t(mesh_->dim * (varies ? 1 + n_corners(*mesh_) : 1));
}

/// Adds a traction or pressure that varies within faces.
void SolidBoundaries::add_varying_forces(const Condition& c, double t, std::span<double> forces) const {
  const std::size_t dim = std::size_t(mesh_->dim), n_corner = std::size_t(n_corners(*mesh_)),
                    n_whole = mesh_->boundary.n_owned() * dim;
  const double level = c.liquid ? c.liquid->level(t) : 0;
  for (const Index f : c.faces) {
    const Vec3& area = geometry_->face_area[f];
    const Vec3 n = area.normalized();
    const auto load = [&](const Vec3& x) {
      Vec3 value = Vec3::Zero();
      for (std::size_t a = 0; a < c.traction.size(); ++a) value[Index(a)] = c.traction[a](x, t);
      if (c.has_pressure()) value -= c.pressure_at(x, level, t) * n;
      return value;
    };
    const fv::FaceMean mean = mean_over(f, load), even = mean_over(f, unit);
    const Vec3 whole = c.liquid && !is_ring_ ? Vec3(-c.liquid->mean(f, level, Vec3::Zero()) * n) : mean.whole;
    const std::size_t b = std::size_t(f - mesh_->n_interior);
    for (std::size_t a = 0; a < dim; ++a) {
      forces[b * dim + a] += area.norm() * whole[Index(a)];
      for (std::size_t i = 0; i < n_corner && n_whole < forces.size(); ++i)
        forces[n_whole + (b * n_corner + i) * dim + a] +=
            area.norm() * (mean.corner[i] - even.corner[i].cwiseProduct(mean.whole))[Index(a)];
    }
  }
}

void SolidBoundaries::add_forces(double t, std::span<double> forces, bool with_pressure) const {
  const int dim = mesh_->dim;
  const auto force_on = [&](Index f) { return forces.data() + std::size_t(f - mesh_->n_interior) * dim; };
  for (const Condition& c : conditions_) {
    if (c.distributed) c.distributed->add_forces(t, forces);
    if (c.bearing) c.bearing->add_forces(t, forces);
    if (c.varies() && (with_pressure || !c.has_pressure())) {
      add_varying_forces(c, t, forces);
      continue;
    }
    if (c.presses && with_pressure)
      for (const Index f : c.faces) {
        const double p = c.pressure(Vec3::Zero(), t);
        for (int a = 0; a < dim; ++a) force_on(f)[a] -= p * geometry_->face_area[f][a];
      }
    if (c.traction.empty()) continue;
    for (const Index f : c.faces) {
      const double size = geometry_->face_area[f].norm();
      for (int a = 0; a < dim; ++a) force_on(f)[a] += c.traction[a](Vec3::Zero(), t) * size;
    }
  }
  for (const DistributedForce& load : point_loads_) load.add_forces(t, forces);
}

PrescribedDisplacement::PrescribedDisplacement(const mesh::Mesh& mesh, const SolidBoundaries& boundaries,
                                               const elastic::ElasticOperator& elastic)
    : mesh_(&mesh), dim_(mesh.dim), size_(elastic.n_known()) {
  const mesh::Geometry& geometry = elastic.geometry();
  std::vector<Group> all(boundaries.conditions_.size());
  for (std::size_t c = 0; c < all.size(); ++c) all[c].value = &boundaries.conditions_[c].known;
  const auto group_of = [&](Index entry) -> Group& { return all[boundaries.condition_of_face_[entry]]; };
  const elastic::VertexConstraints& vertices = elastic.constraints();
  for (const Index f : elastic.known_faces()) {
    Group& group = group_of(f - mesh.n_interior);
    group.columns.push_back(elastic.known_of_face(f));
    group.places.push_back(geometry.face_centre[f]);
  }
  for (std::size_t i = 0; i < vertices.points().size(); ++i)
    for (const auto& [face, share] : vertices.sources(static_cast<Index>(i))) {
      Group& group = group_of(face);
      group.columns.push_back(static_cast<Index>(i));
      group.places.push_back(geometry.points[vertices.points()[i]]);
      group.shares.push_back(share);
    }
  const std::vector<Index> patch_of = mesh.patch_of_boundary();
  for (const elastic::VertexConstraints::Repeated& r : vertices.repeated()) {
    const Index column = vertices.column(r.point);
    if (column < 0) continue;
    const auto sources = vertices.sources(column);
    const auto first = std::ranges::max_element(
        sources, {}, [&](const auto& source) { return (r.along * source.share).norm(); });
    const Index condition = boundaries.condition_of_face_[r.face],
                known = boundaries.condition_of_face_[first->face];
    if (condition != known)
      shared_.push_back({column, geometry.points[r.point], r.along, &boundaries.conditions_[condition],
                         patch_of[first->face], patch_of[r.face]});
  }
  for (Group& group : all) {
    if (group.value->empty()) continue;
    for (const fv::Expression& e : *group.value) uses_time_ = uses_time_ || e.uses_time();
    groups_.push_back(std::move(group));
  }
}

void PrescribedDisplacement::evaluate(double t, std::span<double> values) const {
  std::ranges::fill(values, 0.0);
  for (const Group& group : groups_) {
    const std::size_t whole = group.places.size() - group.shares.size();
    for (std::size_t i = 0; i < group.columns.size(); ++i) {
      Vec3 g = Vec3::Zero();
      for (int c = 0; c < dim_; ++c) g[c] = (*group.value)[c](group.places[i], t);
      if (i >= whole) g = group.shares[i - whole] * g;
      for (int c = 0; c < dim_; ++c) values[std::size_t(group.columns[i]) * dim_ + c] += g[c];
    }
  }
}

void PrescribedDisplacement::check(double t, std::span<const double> values) const {
  double largest = 0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  largest = parallel::max(mesh_->comm, largest);
  std::string trouble;
  for (const Shared& s : shared_) {
    Vec3 known = Vec3::Zero(), other = Vec3::Zero();
    for (int a = 0; a < dim_; ++a) {
      known[a] = values[std::size_t(s.column) * std::size_t(dim_) + std::size_t(a)];
      if (!s.condition->known.empty()) other[a] = s.condition->known[std::size_t(a)](s.place, t);
    }
    known = s.along * known, other = s.along * other;
    const double same = s.condition->type == Type::frictionless ? equal_on_curved : equal;
    if ((known - other).norm() <= same * largest) continue;
    trouble = fmt::format(
        "boundaries: '{}' and '{}' prescribe different displacements at {}, a common point: {} m and {} m at t = {:g} s. "
        "Prescribe the same there, or leave the component free on one of the patches.",
        mesh_->patches[std::size_t(s.patch)].name, mesh_->patches[std::size_t(s.other)].name,
        place_of(s.place, dim_), place_of(known, dim_), place_of(other, dim_), t);
    break;
  }
  parallel::throw_together(mesh_->comm, trouble);
}

void PrescribedDisplacement::evaluate_rate(double t, double dt, std::span<double> values) const {
  std::ranges::fill(values, 0.0);
  if (!uses_time_) return;
  const double h = 1e-3 * dt;
  std::vector<double> before(values.size());
  evaluate(t - h, before);
  evaluate(t + h, values);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = (values[i] - before[i]) / (2 * h);
}

}  // namespace couplet::solid
