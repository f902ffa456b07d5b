// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/boundary/boundary.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/parameters/files.hpp"

namespace couplet::fluid {
namespace {

void check_names(const Mesh& mesh, const FluidParameters& parameters) {
  std::vector<std::string> patches, missing;
  for (const Patch& patch : mesh.patches) {
    patches.push_back(patch.name);
    if (!parameters.boundaries.contains(patch.name)) missing.push_back(patch.name);
  }
  for (const auto& [name, unused] : parameters.boundaries)
    if (!mesh.find_patch(name))
      throw Error("boundaries.{}: the mesh '{}' has no patch '{}'. {}", name, parameters.mesh, name,
                  did_you_mean(name, patches, "patches"));
  if (!missing.empty())
    throw Error(
        "boundaries: the mesh '{}' has patches without a boundary condition: {}. Give each of them a type "
        "(inlet, outlet, convective-outlet, no-slip, moving-wall, slip, symmetry, periodic, interface or "
        "body).",
        parameters.mesh, join(missing));
}

FaceKind kind_of(BoundaryType type) {
  if (type == BoundaryType::outlet) return FaceKind::pressure;
  return type == BoundaryType::slip || type == BoundaryType::symmetry ? FaceKind::slip : FaceKind::velocity;
}

Expression turning_of(const BoundaryParameters& b, const std::string& where) {
  Expression speed(b.rotation->speed, where + ".rotation.speed");
  if (speed.uses_space()) throw Error("{}.rotation.speed: it may depend on t only.", where);
  return speed;
}

bool uses_space(const std::vector<Expression>& expressions) {
  return std::ranges::any_of(expressions, [](const Expression& e) { return e.uses_space(); });
}

double ramp_factor(const BoundaryParameters& b, double t) {
  if (!b.ramp || t >= *b.ramp) return 1;
  return t <= 0 ? 0 : 0.5 * (1 - std::cos(std::numbers::pi * t / *b.ramp));
}

}  // namespace

template <int D>
Boundary<D>::Boundary(const Mesh& mesh, const FluidParameters& parameters) : comm_(mesh.comm) {
  check_names(mesh, parameters);
  kind_.assign(mesh.boundary.n_owned(), FaceKind::velocity);
  interface_.assign(kind_.size(), 0);
  convective_ = free_backflow_ = interface_;
  for (const Patch& patch : mesh.patches) add_patch(mesh, patch, parameters.boundaries.at(patch.name));
  add_openings(mesh, parameters);
}

/// What a compressible fluid makes of inlets and outlets.
template <int D>
void Boundary<D>::add_openings(const Mesh& mesh, const FluidParameters& parameters) {
  const bool compressible = parameters.is_compressible();
  const bool has_volume = compressible && parameters.compressibility->upstream_volume > 0;
  for (const Patch& patch : mesh.patches) {
    const BoundaryParameters& b = parameters.boundaries.at(patch.name);
    const FaceRange faces{patch.first - mesh.n_interior, patch.count};
    const bool inlet = b.type == BoundaryType::inlet;
    if (b.absorbing) {
      if (!compressible)
        throw Error(
            "boundaries.{}.absorbing: an incompressible fluid has no pressure waves to let out; add 'compressibility', or "
            "remove the key.",
            patch.name);
      if (inlet && has_volume)
        throw Error(
            "boundaries.{}.absorbing: behind this inlet lies the 'upstream-volume', which answers to the waves; remove one "
            "of the two.",
            patch.name);
      absorbing_patches_.push_back({faces, inlet});
    }
    if (compressible && b.type == BoundaryType::convective_outlet)
      throw Error(
          "boundaries.{}: a convective outlet sets no pressure level, which a compressible fluid needs; use 'type: outlet' "
          "with 'absorbing: true'.",
          patch.name);
    if (!has_volume || !inlet) continue;
    std::fill_n(kind_.begin() + faces.first, faces.count, FaceKind::pressure);
    upstream_patches_.push_back(faces);
    closed_ = false;
  }
  if (has_volume && upstream_patches_.empty())
    throw Error(
        "compressibility.upstream-volume: this fluid has no inlet that it could lie behind; remove the key.");
}

template <int D>
void Boundary<D>::add_patch(const Mesh& mesh, const Patch& patch, const BoundaryParameters& b) {
  const Index first = patch.first - mesh.n_interior;
  const std::string where = "boundaries." + patch.name;
  std::fill_n(kind_.begin() + first, patch.count, kind_of(b.type));
  Given given;
  given.first = first;
  given.count = patch.count;
  given.parameters = b;
  switch (b.type) {
    case BoundaryType::interface:
      std::fill_n(interface_.begin() + first, patch.count, 1);
      interface_patches_.push_back(patch.name);
      turns_ = true;
      if (b.foresees()) {
        yields_ = true;
        wall_mass_.resize(kind_.size(), 0.);
        std::fill_n(wall_mass_.begin() + first, patch.count, b.surface_density.value_or(0.));
      }
      if (b.impedance == Impedance::structure) {
        asks_for_mass_ = true;
        asked_.resize(kind_.size(), 0);
        std::fill_n(asked_.begin() + first, patch.count, 1);
      }
      return;
    case BoundaryType::body:
      std::fill_n(interface_.begin() + first, patch.count, 1);
      body_patches_.push_back(&patch);
      turns_ = true;
      return;
    case BoundaryType::convective_outlet:
      std::fill_n(convective_.begin() + first, patch.count, 1);
      convective_patches_.emplace_back(first, patch.count);
      return;
    case BoundaryType::outlet:
      closed_ = false;
      std::fill_n(free_backflow_.begin() + first, patch.count, b.backflow_stabilisation ? 0 : 1);
      given.pressure = Expression(b.pressure, where + ".pressure");
      pressure_patches_.push_back(std::move(given));
      return;
    case BoundaryType::slip:
    case BoundaryType::symmetry:
      return;
    case BoundaryType::periodic:
      if (sum(comm_, GlobalIndex(patch.count)) > 0)
        throw Error("{}: the mesh is not joined at this periodic patch.", where);
      return;
    case BoundaryType::inlet:
    case BoundaryType::moving_wall:
      if (b.rotation) given.turning = turning_of(b, where);
      if (b.table) {
        given.table = velocity_table(b.table->file, b.table->outside, D);
      } else if (b.mean_speed) {
        given.mean_speed = Expression(*b.mean_speed, where + ".mean-speed");
        given.shape = inlet_shape<D>(mesh, patch, b.profile);
      } else if (!b.velocity.empty()) {
        given.velocity = make_expressions(b.velocity, D, where + ".velocity");
      }
      if (b.type == BoundaryType::moving_wall && (b.rotation || b.table || uses_space(given.velocity))) {
        given.turns = &patch;
        turns_ = true;
      }
      [[fallthrough]];
    case BoundaryType::no_slip:
      velocity_patches_.push_back(std::move(given));
  }
}

template <int D>
bool Boundary<D>::set_wall_mass(std::span<const Index> boundary_faces, std::span<const double> masses) {
  bool changed = false;
  for (std::size_t i = 0; i < boundary_faces.size(); ++i) {
    const Index b = boundary_faces[i];
    if (!asked_[b]) continue;
    if (!(masses[i] > 0) || !std::isfinite(masses[i]))
      throw Error(
          "impedance: structure: the structure gave a 'surface-density' of {:g} kg/m^2 at an interface "
          "face; it must be above 0.",
          masses[i]);
    changed = changed || wall_mass_[b] != masses[i];
    wall_mass_[b] = masses[i];
  }
  return changed;
}

template <int D>
void Boundary<D>::velocity_of(const Given& g, double t, std::span<const Vec3> places, Vec<D>* w) const {
  const std::size_t n = places.size();
  if (n == 0) return;
  const std::span<double> values(w->data(), n * D);
  if (!g.shape.speed.empty()) {
    const double mean = g.mean_speed(Vec3::Zero(), t);
    for (std::size_t i = 0; i < n; ++i) w[i] = mean * g.shape.speed[i] * g.shape.direction;
  } else if (g.table) {
    for (std::size_t i = 0; i < n; ++i) g.table->evaluate(places[i], t, values.subspan(i * D, D));
  } else if (g.velocity.empty()) {
    std::fill(values.begin(), values.end(), 0.0);
  } else {
    for (int c = 0; c < D; ++c) g.velocity[c].evaluate(places, t, values, D, c);
  }
  if (const auto& r = g.parameters.rotation) {
    const Vec3 omega = g.turning(Vec3::Zero(), t) * (D == 2 ? Vec3::UnitZ() : Vec3(r->axis.normalized()));
    for (std::size_t i = 0; i < n; ++i) w[i] += omega.cross(places[i] - r->centre).template head<D>();
  }
  const double factor = ramp_factor(g.parameters, t);
  for (std::size_t i = 0; factor != 1 && i < n; ++i) w[i] *= factor;
}

template <int D>
void Boundary<D>::velocity_at(double t, const std::vector<Vec3>& centres, Vectors<D>& w) const {
  for (const Given& g : velocity_patches_)
    velocity_of(g, t, {centres.data() + g.first, std::size_t(g.count)}, w.data() + g.first);
}

template <int D>
void Boundary<D>::convect(const Mesh& mesh, const Placement<D>& at, const Vectors<D>& u,
                          const Vectors<D>& w_begin, double dt, Vectors<D>& w) const {
  for (const auto& [first, count] : convective_patches_) {
    double sums[2] = {0, 0};
    for (Index b = first; b < first + count; ++b) {
      const Vec<D>& area = at.area[mesh.n_interior + b];
      sums[0] += w_begin[b].dot(area);
      sums[1] += area.norm();
    }
    MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, comm_);
    const double speed = std::max(0.0, sums[0] / sums[1]);
    for (Index b = first; b < first + count; ++b) {
      const Index f = mesh.n_interior + b;
      const double courant = dt * speed * at.conductance[f] / at.area[f].norm();
      w[b] = (w_begin[b] + courant * u[mesh.owner[f]]) / (1 + courant);
    }
  }
}

template <int D>
void Boundary<D>::pressure_at(double t, const std::vector<Vec3>& centres, std::vector<double>& p) const {
  for (const Given& g : pressure_patches_)
    g.pressure.evaluate({centres.data() + g.first, std::size_t(g.count)}, t,
                        {p.data() + g.first, std::size_t(g.count)});
}

template <int D>
void Boundary<D>::close(const Mesh& mesh, const Placement<D>& at, const Vectors<D>& u, const Vectors<D>& w,
                        Vectors<D>& u_boundary) const {
  u_boundary.resize(kind_.size());
  for (std::size_t b = 0; b < kind_.size(); ++b) {
    const Index f = mesh.n_interior + static_cast<Index>(b);
    const Vec<D>& inside = u[mesh.owner[f]];
    switch (kind_[b]) {
      case FaceKind::velocity:
        u_boundary[b] = w[b];
        break;
      case FaceKind::pressure:
        u_boundary[b] = inside;
        break;
      case FaceKind::slip: {
        const Vec<D> n = at.area[f].normalized();
        u_boundary[b] = inside + (w[b] - inside).dot(n) * n;
        break;
      }
    }
  }
}

template class Boundary<2>;
template class Boundary<3>;

}  // namespace couplet::fluid
