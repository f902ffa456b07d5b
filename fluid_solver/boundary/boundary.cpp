// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/boundary/boundary.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::fluid {

namespace {

void check_names(const mesh::Mesh& mesh, const FluidParameters& parameters) {
  std::vector<std::string> patches, missing;
  for (const mesh::Patch& patch : mesh.patches) {
    patches.push_back(patch.name);
    if (!parameters.boundaries.contains(patch.name)) missing.push_back(patch.name);
  }
  for (const auto& [name, unused] : parameters.boundaries)
    if (!mesh.find_patch(name))
      throw Error("boundaries.{}: the mesh '{}' has no patch '{}'. {}", name, parameters.mesh, name,
                  base::did_you_mean(name, patches, "patches"));
  if (!missing.empty())
    throw Error(
        "boundaries: the mesh '{}' has patches without a boundary condition: {}. Give each of them a type ({}).",
        parameters.mesh, base::join(missing), condition_names(" or "));
}

}  // namespace

template <int D>
Boundary<D>::Boundary(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                      const FluidParameters& parameters)
    : comm_(mesh.comm), rows_(mesh.boundary.n_owned()) {
  check_names(mesh, parameters);
  interface_.assign(rows_.pressure.size(), 0);
  convective_ = interface_;
  for (const mesh::Patch& patch : mesh.patches)
    add_patch(mesh, geometry, patch, parameters.boundaries.at(patch.name));
  add_openings(mesh, parameters);
  rows_.sort();
}

/// Adds the absorbing patches and the inlets before a volume, which only a compressible fluid has.
template <int D>
void Boundary<D>::add_openings(const mesh::Mesh& mesh, const FluidParameters& parameters) {
  const bool compressible = parameters.is_compressible();
  const bool has_volume = compressible && parameters.compressibility->upstream_volume > 0;
  for (const mesh::Patch& patch : mesh.patches) {
    const BoundaryParameters& b = parameters.boundaries.at(patch.name);
    const FaceRange faces{patch.first - mesh.n_interior, patch.count};
    const Condition& condition = condition_of(b);
    const bool inlet = condition.passage == Passage::in;
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
    if (compressible && condition.velocity == GivenBy::flow)
      throw Error(
          "boundaries.{}: a convective outlet sets no pressure level, which a compressible fluid needs; use 'type: outlet' "
          "with 'absorbing: true'.",
          patch.name);
    if (!has_volume || !inlet) continue;
    rows_.set(faces, {.pressure = 1, .slip_length = no_friction, .inflow = 0.5}, false);
    upstream_patches_.push_back(faces);
    closed_ = false;
  }
  if (has_volume && upstream_patches_.empty())
    throw Error(
        "compressibility.upstream-volume: this fluid has no inlet that it could lie behind; remove the key.");
}

template <int D>
void Boundary<D>::add_patch(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const mesh::Patch& patch,
                            const BoundaryParameters& b) {
  const FaceRange faces{patch.first - mesh.n_interior, patch.count};
  const std::string where = "boundaries." + patch.name;
  const Condition& condition = condition_of(b);
  if (condition.joined && parallel::sum(comm_, GlobalIndex(patch.count)) > 0)
    throw Error("{}: the mesh is not joined at this periodic patch.", where);
  rows_.set(faces, condition.row(b), condition.velocity == GivenBy::mesh);
  if (gives_pressure(b)) {
    closed_ = false;
    pressure_patches_.push_back({faces, fv::Expression(b.pressure, where + ".pressure")});
  }
  if (condition.velocity == GivenBy::keys) {
    velocity_patches_.emplace_back(mesh, geometry, patch, b);
    turns_ = turns_ || velocity_patches_.back().turns();
  }
  if (condition.velocity == GivenBy::flow) {
    std::fill_n(convective_.begin() + faces.first, faces.count, 1);
    convective_patches_.push_back(faces);
  }
  if (condition.velocity == GivenBy::motion) body_patches_.push_back(&patch);
  if (condition.velocity == GivenBy::structure) add_interface(patch, faces, b);
  if (condition.velocity == GivenBy::structure || condition.velocity == GivenBy::motion) {
    std::fill_n(interface_.begin() + faces.first, faces.count, 1);
    turns_ = true;
  }
}

template <int D>
void Boundary<D>::add_interface(const mesh::Patch& patch, const FaceRange& faces,
                                const BoundaryParameters& b) {
  interface_patches_.push_back(patch.name);
  if (b.foresees()) {
    yields_ = true;
    wall_mass_.resize(interface_.size(), 0.);
    std::fill_n(wall_mass_.begin() + faces.first, faces.count, b.surface_density.value_or(0.));
    for (Index i = 0; b.sides != Sides::apart && i < faces.count; ++i) two_sided_.push_back(faces.first + i);
  }
  if (b.impedance == Impedance::structure) {
    asks_for_mass_ = true;
    asked_.resize(interface_.size(), 0);
    std::fill_n(asked_.begin() + faces.first, faces.count, 1);
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
void Boundary<D>::velocity_at(double t, const std::vector<Vec3>& centres, Vectors<D>& w) const {
  for (const GivenVelocity<D>& given : velocity_patches_) {
    const auto [first, count] = given.faces();
    given.evaluate(t, {centres.data() + first, std::size_t(count)}, w.data() + first);
  }
}

template <int D>
void Boundary<D>::pressure_at(double t, const std::vector<Vec3>& centres, std::vector<double>& p) const {
  for (const auto& [faces, value] : pressure_patches_)
    value.evaluate({centres.data() + faces.first, std::size_t(faces.count)}, t,
                   {p.data() + faces.first, std::size_t(faces.count)});
}

/// u_b = t w + (1 - t) u_P + (1 - q - t) n n.(w - u_P), q = 1 where the pressure is given.
template <int D>
void Boundary<D>::close(const mesh::Mesh& mesh, const Placement<D>& at, const Vectors<D>& u,
                        const Vectors<D>& w, Vectors<D>& u_boundary) const {
  u_boundary.resize(rows_.pressure.size());
  for (std::size_t b = 0; b < u_boundary.size(); ++b) {
    const Index f = mesh.n_interior + static_cast<Index>(b);
    const Vec<D>& inside = u[mesh.owner[f]];
    const Vec<D> n = at.area[f].normalized();
    const double t = rows_.friction(at, static_cast<Index>(b), f), q = rows_.pressure[b];
    u_boundary[b] = t * w[b] + (1 - t) * inside + (1 - q - t) * (w[b] - inside).dot(n) * n;
  }
}

template <int D>
void Boundary<D>::convect(const mesh::Mesh& mesh, const Placement<D>& at, const Vectors<D>& u,
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

template class Boundary<2>;
template class Boundary<3>;

}  // namespace couplet::fluid
