// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/boundary/boundary.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_set>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/fv/face_mean.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::fluid {

namespace {

constexpr double flat_enough = 1e-3;  // of the size of the patch
constexpr double round_enough = 0.1;  // of the area of the disc

struct PatchExtent {
  Vec3 area = Vec3::Zero(), centre = Vec3::Zero();
  double size = 0, radius = 0;  // sum of |S|; largest distance of a point from the center
};

PatchExtent extent_of(const mesh::Mesh& mesh, const mesh::Geometry& g, const mesh::Patch& patch) {
  double sums[7] = {};
  for (Index f = patch.first; f < patch.first + patch.count; ++f) {
    const double size = g.face_area[f].norm();
    for (int c = 0; c < 3; ++c) {
      sums[c] += g.face_area[f][c];
      sums[3 + c] += size * g.face_centre[f][c];
    }
    sums[6] += size;
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 7, MPI_DOUBLE, MPI_SUM, mesh.comm);
  PatchExtent e{{sums[0], sums[1], sums[2]}, Vec3(sums[3], sums[4], sums[5]) / sums[6], sums[6], 0};
  for (Index f = patch.first; f < patch.first + patch.count; ++f)
    for (const Index p : mesh.face_points[f]) e.radius = std::max(e.radius, (g.points[p] - e.centre).norm());
  e.radius = parallel::max(mesh.comm, e.radius);
  return e;
}

using Conditions = std::map<std::string, BoundaryParameters>;

/// Unit normals and levels n . x of the symmetry planes at the rim of a patch that they cut at right angles. Collective.
template <int D>
std::vector<Eigen::Vector4d> planes_at_rim(const mesh::Mesh& mesh, const mesh::Geometry& g,
                                           const mesh::Patch& patch, const Vec3& direction,
                                           const Conditions& boundaries) {
  std::vector<GlobalIndex> ids;
  for (Index f = patch.first; f < patch.first + patch.count; ++f)
    for (const Index v : mesh.face_points[f]) ids.push_back(mesh.point_id[v]);
  ids = parallel::all_gather(mesh.comm, ids);
  const std::unordered_set<GlobalIndex> on_patch(ids.begin(), ids.end());
  std::vector<Eigen::Vector4d> planes;
  const auto add = [&](const Eigen::Vector4d& plane) {
    if (std::ranges::none_of(planes, [&](const Eigen::Vector4d& p) {
          return p.head<3>().dot(plane.head<3>()) > 1 - flat_enough;
        }))
      planes.push_back(plane);
  };
  for (const mesh::Patch& other : mesh.patches) {
    const auto given = boundaries.find(other.name);
    if (given == boundaries.end() || given->second.type != BoundaryType::symmetry) continue;
    for (Index f = other.first; f < other.first + other.count; ++f) {
      const Vec3 n = g.face_area[f].normalized();
      if (std::abs(n.dot(direction)) < flat_enough &&
          std::ranges::count_if(mesh.face_points[f],
                                [&](Index v) { return on_patch.contains(mesh.point_id[v]); }) >= D - 1)
        add(Eigen::Vector4d(n.x(), n.y(), n.z(), n.dot(g.face_centre[f])));
    }
  }
  const auto all = parallel::all_gather(mesh.comm, std::exchange(planes, {}));
  std::ranges::for_each(all, add);
  return planes;
}

/// Completes a patch by its mirror images: moves its center onto the planes. Returns the number of images, itself included.
/// Throws Error if the planes have no point in common. Collective.
template <int D>
double mirror(const mesh::Mesh& mesh, const mesh::Geometry& g, const mesh::Patch& patch,
              const Conditions& boundaries, PatchExtent& e) {
  const std::vector<Eigen::Vector4d> planes =
      planes_at_rim<D>(mesh, g, patch, e.area.normalized(), boundaries);
  if (planes.empty()) return 1;
  const auto above = [&](const Eigen::Vector4d& plane) { return plane.head<3>().dot(e.centre) - plane[3]; };
  for (int i = 0; i < 200; ++i)  // projections converge to the nearest common point
    for (const Eigen::Vector4d& plane : planes) e.centre -= above(plane) * plane.head<3>();
  if (!std::ranges::all_of(
          planes, [&](const auto& plane) { return std::abs(above(plane)) < flat_enough * e.radius; }))
    throw Error(
        "boundaries.{}: the symmetry planes at its rim do not meet in it, so a parabolic profile is not defined. Give "
        "a 'velocity'.",
        patch.name);
  e.radius = 0;
  for (Index f = patch.first; f < patch.first + patch.count; ++f)
    for (const Index p : mesh.face_points[f]) e.radius = std::max(e.radius, (g.points[p] - e.centre).norm());
  e.radius = parallel::max(mesh.comm, e.radius);
  if (planes.size() == 1) return 2;
  return 2 * std::numbers::pi / (std::numbers::pi - std::acos(planes[0].head<3>().dot(planes[1].head<3>())));
}

/// Parabolic profile: zero at the ends of a line (2-D), 1 - (r/R)^2 on a disk (3-D), scaled to the mean. Symmetry planes continue
/// the patch by its mirror image. Throws Error if it is neither. Collective.
template <int D>
InletShape<D> inlet_shape(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const mesh::Patch& patch,
                          InletProfile profile, const Conditions& boundaries) {
  const bool parabolic = profile == InletProfile::parabolic;
  PatchExtent e = extent_of(mesh, geometry, patch);
  if (!(e.area.norm() > (1 - flat_enough) * e.size))
    throw Error("boundaries.{}: the patch is not flat, so '{}' has no direction. Give a 'velocity'.",
                patch.name, boundaries.at(patch.name).flow_rate ? "flow-rate" : "mean-speed");
  const double images = parabolic ? mirror<D>(mesh, geometry, patch, boundaries, e) : 1;
  if (D == 3 && parabolic &&
      std::abs(images * e.size / (std::numbers::pi * e.radius * e.radius) - 1) > round_enough)
    throw Error(
        "boundaries.{}: the patch is not round, so a parabolic profile is not defined. Give a 'velocity'.",
        patch.name);
  InletShape<D> shape;
  shape.direction = -e.area.normalized().template head<D>();
  double flow = 0;
  for (Index f = patch.first; f < patch.first + patch.count; ++f) {
    const auto speed = [&](const Vec3& x) {
      return Vec3(std::max(0.0, 1 - (x - e.centre).squaredNorm() / (e.radius * e.radius)), 0, 0);
    };
    shape.speed.push_back(parabolic ? fv::mean_over_face(mesh, geometry, f, speed).whole.x() : 1.0);
    flow -= shape.speed.back() * shape.direction.dot(geometry.face_area[f].template head<D>());
  }
  const double mean = parallel::sum(mesh.comm, flow) / e.size;
  for (double& speed : shape.speed) speed /= mean;
  shape.area = e.size;
  return shape;
}

fv::Expression turning_of(const BoundaryParameters& b, int dim, const std::string& where) {
  fv::check_axis(b.rotation->axis, dim, where + ".rotation.axis");
  fv::Expression speed(b.rotation->speed, where + ".rotation.speed");
  if (speed.uses_space()) throw Error("{}.rotation.speed: it may depend on t only.", where);
  return speed;
}

FaceCorners corners_of(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const mesh::Patch& patch) {
  FaceCorners corners(std::size_t(patch.count));
  for (Index i = 0; i < patch.count; ++i)
    for (const Index v : mesh.face_points[patch.first + i])
      corners[std::size_t(i)].push_back(geometry.points[v] - geometry.face_centre[patch.first + i]);
  return corners;
}

bool uses_space(const std::vector<fv::Expression>& expressions) {
  return std::ranges::any_of(expressions, [](const fv::Expression& e) { return e.uses_space(); });
}

double ramp_factor(const BoundaryParameters& b, double t) {
  if (!b.ramp || t >= *b.ramp) return 1;
  return t <= 0 ? 0 : 0.5 * (1 - std::cos(std::numbers::pi * t / *b.ramp));
}

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

fv::GridTable velocity_table(const std::filesystem::path& file, const VelocityTableParameters& parameters,
                             int dimension) {
  std::vector<std::string> columns{"u", "v", "w"};
  columns.resize(std::size_t(dimension));
  return fv::GridTable::read(file, columns, parameters.outside, parameters.repeat.value_or(0));
}

std::vector<app::ProblemOfKey> problems_of_files(const FluidParameters& parameters,
                                                 const diagnostics::CaseScene& scene) {
  std::vector<app::ProblemOfKey> all;
  if (parameters.volume_level == VolumeLevelBy::structure && !scene.coupled)
    all.push_back({"volume-level", "this fluid runs alone, without a structure; remove the key."});
  for (const auto& [patch, boundary] : parameters.boundaries) {
    if (condition_of(boundary).velocity == GivenBy::motion && !parameters.motion && !scene.has_mover)
      all.push_back(
          {"boundaries." + patch + ".type",
           "a body moves by the section 'motion' or with a mesh mover (`coupling.mesh`); both are missing."});
    if (!boundary.table) continue;
    try {
      (void)velocity_table(scene.folder / boundary.table->file, *boundary.table, parameters.dimension);
    } catch (const Error& error) {
      all.push_back({"boundaries." + patch + ".table.file", error.what()});
    }
  }
  return all;
}

template <int D>
GivenVelocity<D>::GivenVelocity(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                const mesh::Patch& patch,
                                const std::map<std::string, BoundaryParameters>& boundaries)
    : faces_{patch.first - mesh.n_interior, patch.count},
      patch_(&patch),
      parameters_(boundaries.at(patch.name)) {
  const BoundaryParameters& b = parameters_;
  const std::string where = "boundaries." + patch.name;
  if (b.rotation) turning_ = turning_of(b, D, where);
  if (b.table) {
    table_ = velocity_table(b.table->file, *b.table, D);
  } else if (b.mean_speed) {
    mean_speed_ = fv::Expression(*b.mean_speed, where + ".mean-speed");
    shape_ = inlet_shape<D>(mesh, geometry, patch, b.profile, boundaries);
  } else if (b.flow_rate) {
    mean_speed_ = fv::Expression(*b.flow_rate, where + ".flow-rate");
    if (mean_speed_.uses_space()) throw Error("{}.flow-rate: it may depend on t only.", where);
    shape_ = inlet_shape<D>(mesh, geometry, patch, b.profile, boundaries);
  } else if (!b.velocity.empty()) {
    velocity_ = fv::make_expressions(b.velocity, D, where + ".velocity");
  }
  const bool varies = b.table || uses_space(velocity_);
  turns_ = is_wall(b) && (b.rotation || varies);
  if (varies) corners_ = corners_of(mesh, geometry, patch);
  steady_ = !table_ && !b.rotation &&
            std::ranges::none_of(velocity_, [](const fv::Expression& e) { return e.uses_time(); });
}

template <int D>
void GivenVelocity<D>::evaluate(double t, std::span<const Vec3> places, Vec<D>* w) const {
  without_ramp(t, places, w);
  const double factor = ramp_factor(parameters_, t);
  for (std::size_t i = 0; factor != 1 && i < places.size(); ++i) w[i] *= factor;
}

template <int D>
double GivenVelocity<D>::flow(double t) const {
  return ramp_factor(parameters_, t) * mean_speed_(Vec3::Zero(), t);
}

template <int D>
void GivenVelocity<D>::without_ramp(double t, std::span<const Vec3> places, Vec<D>* w) const {
  const std::size_t n = places.size();
  if (n == 0) return;
  const std::span<double> values(w->data(), n * D);
  if (!shape_.speed.empty()) {
    const double mean = mean_speed_(Vec3::Zero(), t) / (gives_flow() ? shape_.area : 1);
    for (std::size_t i = 0; i < n; ++i) w[i] = mean * shape_.speed[i] * shape_.direction;
  } else if (table_) {
    for (std::size_t i = 0; i < n; ++i) table_->evaluate(places[i], t, values.subspan(i * D, D));
  } else if (velocity_.empty()) {
    std::fill(values.begin(), values.end(), 0.0);
  } else {
    for (int c = 0; c < D; ++c) velocity_[c].evaluate(places, t, values, D, c);
  }
  if (const auto& r = parameters_.rotation) {
    const Vec3 omega = turning_(Vec3::Zero(), t) * (D == 2 ? Vec3::UnitZ() : Vec3(r->axis.normalized()));
    for (std::size_t i = 0; i < n; ++i) w[i] += omega.cross(places[i] - r->centre).template head<D>();
  }
}

template <int D>
void GivenVelocity<D>::average(double t, std::span<const Vec3> centres, Vec<D>* w) const {
  if (corners_.empty()) return evaluate(t, centres, w);
  if (!steady_ || !std::ranges::equal(centres, mean_at_)) {
    mean_at_.assign(centres.begin(), centres.end());
    mean_.resize(centres.size());
    for (std::size_t i = 0; i < centres.size(); ++i)
      mean_[i] = fv::mean_over_face(corners_[i], Vec3::Zero(), [&](const Vec3& x) {
                   const Vec3 place = centres[i] + x;
                   Vec<D> here;
                   without_ramp(t, {&place, 1}, &here);
                   Vec3 value = Vec3::Zero();
                   value.template head<D>() = here;
                   return value;
                 }).whole.template head<D>();
  }
  const double factor = ramp_factor(parameters_, t);
  for (std::size_t i = 0; i < centres.size(); ++i) w[i] = factor * mean_[i];
}

template class GivenVelocity<2>;
template class GivenVelocity<3>;

template <int D>
Boundary<D>::Boundary(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                      const FluidParameters& parameters)
    : comm_(mesh.comm), rows_(mesh.boundary.n_owned()) {
  check_names(mesh, parameters);
  interface_.assign(rows_.pressure.size(), 0);
  convective_ = interface_;
  for (const mesh::Patch& patch : mesh.patches) add_patch(mesh, geometry, patch, parameters.boundaries);
  add_openings(mesh, parameters);
  rows_.sort();
}

/// Adds absorbing patches and a volume upstream of the inlets, for a compressible fluid, and circuits behind outlets.
template <int D>
void Boundary<D>::add_openings(const mesh::Mesh& mesh, const FluidParameters& parameters) {
  const bool compressible = parameters.is_compressible();
  const bool has_upstream = compressible && parameters.compressibility->upstream_volume > 0;
  if (has_upstream) ends_.push_back({"upstream", {}, parameters.compressibility->upstream_volume, {}, {}});
  for (const mesh::Patch& patch : mesh.patches) {
    const BoundaryParameters& b = parameters.boundaries.at(patch.name);
    const FaceRange faces{patch.first - mesh.n_interior, patch.count};
    if (b.circuit.count() > 0) {
      ends_.push_back({patch.name, {faces}, 0, b.circuit, {}});
      if (b.circuit.pressure_drop)
        ends_.back().drop.emplace(*b.circuit.pressure_drop, "boundaries." + patch.name + ".pressure-drop",
                                  "q");
    }
    const bool inlet = condition_of(b).passage == Passage::in;
    if (b.absorbing) absorbing_patches_.push_back({faces, inlet});
    if (!has_upstream || !inlet) continue;
    // The fluid accelerates from rest in the volume: it loses rho/2 u^2 of the pressure.
    rows_.set(faces, {.pressure = 1, .friction = 0, .inflow = 0.5}, false);
    ends_.front().faces.push_back(faces);
    closed_ = false;
  }
}

template <int D>
void Boundary<D>::add_patch(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const mesh::Patch& patch,
                            const std::map<std::string, BoundaryParameters>& boundaries) {
  const BoundaryParameters& b = boundaries.at(patch.name);
  const FaceRange faces{patch.first - mesh.n_interior, patch.count};
  const std::string where = "boundaries." + patch.name;
  const FlowCondition& condition = condition_of(b);
  if (condition.joined && parallel::sum(comm_, GlobalIndex(patch.count)) > 0)
    throw Error("{}: the mesh is not joined at this periodic patch.", where);
  rows_.set(faces, condition.row(b), condition.velocity == GivenBy::mesh);
  sealed_ = sealed_ && condition.passage == Passage::none;
  if (gives_pressure(b)) {
    closed_ = false;
    fv::Expression pressure(b.pressure, where + ".pressure");
    FaceCorners corners = pressure.uses_space() ? corners_of(mesh, geometry, patch) : FaceCorners();
    pressure_patches_.push_back({faces, std::move(pressure), std::move(corners)});
  }
  if (condition.velocity == GivenBy::keys) {
    velocity_patches_.emplace_back(mesh, geometry, patch, boundaries);
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
  if (!b.surface_density) return;
  yields_ = true;
  wall_mass_.resize(interface_.size(), 0.);
  std::fill_n(wall_mass_.begin() + faces.first, faces.count, *b.surface_density);
}

template <int D>
void Boundary<D>::velocity_at(double t, const std::vector<Vec3>& centres, Vectors<D>& w) const {
  for (const GivenVelocity<D>& given : velocity_patches_) {
    const auto [first, count] = given.faces();
    given.average(t, {centres.data() + first, std::size_t(count)}, w.data() + first);
  }
}

template <int D>
void Boundary<D>::velocity_at(double t, const mesh::Mesh& mesh, const Placement<D>& at, Vectors<D>& w) const {
  velocity_at(t, at.boundary_centre, w);
  for (const GivenVelocity<D>& given : velocity_patches_) {
    if (!given.gives_flow()) continue;
    const auto [first, count] = given.faces();
    double flow = 0;
    for (Index b = first; b < first + count; ++b) flow -= w[b].dot(at.area[mesh.n_interior + b]);
    flow = parallel::sum(mesh.comm, flow);
    if (flow == 0) continue;
    const double factor = given.flow(t) / flow;
    for (Index b = first; b < first + count; ++b) w[b] *= factor;
  }
}

template <int D>
void Boundary<D>::pressure_at(double t, const std::vector<Vec3>& centres, std::vector<double>& p) const {
  for (const auto& [faces, value, corners] : pressure_patches_) {
    for (Index i = 0; i < faces.count; ++i) {
      const Vec3& centre = centres[std::size_t(faces.first + i)];
      const auto given = [&](const Vec3& x) { return Vec3(value(centre + x, t), 0, 0); };
      p[std::size_t(faces.first + i)] =
          corners.empty() ? value(Vec3::Zero(), t)
                          : fv::mean_over_face(corners[std::size_t(i)], Vec3::Zero(), given).whole[0];
    }
  }
}

template <int D>
double Boundary<D>::pressure_of_rest(double t, const std::vector<Vec3>& centres) const {
  std::vector<double> p(centres.size(), std::numeric_limits<double>::infinity());
  pressure_at(t, centres, p);
  const auto nearer = [](double a, double b) { return std::abs(a) < std::abs(b); };
  const auto nearest = [&](const std::vector<double>& values) {
    const auto found = std::ranges::min_element(values, nearer);
    return found == values.end() ? std::numeric_limits<double>::infinity() : *found;
  };
  const double rest = nearest(parallel::all_gather(comm_, std::vector<double>{nearest(p)}));
  return std::isfinite(rest) ? rest : 0;
}

/// u_b = t w + (1 - t) u_P + (1 - q - t) n n.(w - u_P), q = 1 if the pressure is given.
template <int D>
void Boundary<D>::close(const mesh::Mesh& mesh, const Placement<D>& at, const Vectors<D>& u,
                        const Vectors<D>& w, Vectors<D>& u_boundary) const {
  u_boundary.resize(rows_.pressure.size());
  for (std::size_t b = 0; b < u_boundary.size(); ++b) {
    const Index f = mesh.n_interior + static_cast<Index>(b);
    const Vec<D>& inside = u[mesh.owner[f]];
    const Vec<D> n = at.area[f].normalized();
    const double t = rows_.friction[b], q = rows_.pressure[b];
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
