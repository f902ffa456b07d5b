// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/motion/surface.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "common/base/error.hpp"

namespace couplet::plate {

Surface::Surface(modes::ModalModel model)
    : model_(std::move(model)), centres_(modes::face_centres(model_)), areas_(modes::face_areas(model_)) {
  for (const double frequency : model_.frequency) omega_.push_back(2 * std::numbers::pi * frequency);
}

std::vector<double> Surface::participation(const Vec3& direction) const {
  std::vector<double> result(omega_.size());
  for (std::size_t m = 0; m < omega_.size(); ++m)
    for (int c = 0; c < 3; ++c)
      result[m] += direction[c] * model_.participation[std::size_t(c) * omega_.size() + m];
  return result;
}

// Midpoint rule of thesis 4.5.1: the force of a face acts on the mode at the face.
void Surface::add_load(std::span<const double> force, std::span<double> load) const {
  const std::size_t n = omega_.size();
  for (std::size_t i = 0; i < force.size(); ++i) {
    if (force[i] == 0) continue;
    const double* shape = model_.face_shape.data() + i * n;
    for (std::size_t m = 0; m < n; ++m) load[m] += force[i] * shape[m];
  }
}

std::vector<double> Surface::motion(std::span<const double> q) const {
  std::vector<double> all(3 * model_.vertices.size(), 0);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double* shape = model_.vertex_shape.data() + i * omega_.size();
    for (std::size_t m = 0; m < omega_.size(); ++m) all[i] += shape[m] * q[m];
  }
  return all;
}

coupling::Interface Surface::describe() const {
  coupling::Interface interface;
  interface.dim = 3;
  interface.vertices = model_.vertices;
  interface.face_centres = centres_;
  interface.face_areas = areas_;
  interface.face_offset = model_.faces.offset;
  interface.face_vertices = model_.faces.index;
  return interface;
}

namespace {

/// Side of the plate: faces with normals within 60 degrees of that of the plate.
constexpr double least_cosine = 0.5;
/// Above any real pressure (4e11 Pa in the center of the earth), and far below the overflow of doubles.
constexpr double largest_pressure = 1e15;

bool is_on(const Vec3& area, const Vec3& normal, double sign) {
  return sign * area.dot(normal) > least_cosine * area.norm();
}

}  // namespace

PressureLoad::PressureLoad(const Surface& surface, const Load& load, const Vec3& normal, std::string name)
    : surface_(surface), normal_(normal), name_(std::move(name)) {
  if (load.upper) upper_.emplace(*load.upper, "load.upper-pressure");
  if (load.lower) lower_.emplace(*load.lower, "load.lower-pressure");
  int i = 0;
  for (const auto& [side, sign, name] :
       {std::tuple{&upper_, 1., "upper"}, std::tuple{&lower_, -1., "lower"}}) {
    std::vector<double>& unit = of_one_pascal_[i++];
    if (!*side) continue;
    if (std::ranges::none_of(surface.areas(), [&](const Vec3& area) { return is_on(area, normal_, sign); }))
      throw Error(
          "load.{}-pressure: the surface of the structure has no face on this side ({:g}, {:g}, {:g}).", name,
          sign * normal.x(), sign * normal.y(), sign * normal.z());
    if ((*side)->uses_space()) continue;
    unit.assign(surface.n_modes(), 0);
    add_faces(fv::Expression(1.0), sign, 0, unit);
  }
}

bool PressureLoad::changes_in_time() const {
  return (upper_ && upper_->uses_time()) || (lower_ && lower_->uses_time());
}
bool PressureLoad::is_uniform() const {
  return !(upper_ && upper_->uses_space()) && !(lower_ && lower_->uses_space());
}

double PressureLoad::push(const Vec3& area, const Vec3& x, double t) const {
  double sum = 0;
  if (upper_ && is_on(area, normal_, 1)) sum += value(*upper_, x, t);
  if (lower_ && is_on(area, normal_, -1)) sum += value(*lower_, x, t);
  return sum;
}

void PressureLoad::add_faces(const fv::Expression& side, double sign, double t,
                             std::span<double> load) const {
  std::vector<double> force(3 * surface_.n_faces(), 0);
  for (std::size_t f = 0; f < surface_.n_faces(); ++f) {
    const Vec3& area = surface_.areas()[f];
    if (!is_on(area, normal_, sign)) continue;
    const double pressure = value(side, surface_.centres()[f], t);
    for (int c = 0; c < 3; ++c) force[3 * f + c] = -pressure * area[c];
  }
  surface_.add_load(force, load);
}

void PressureLoad::at(double t, std::span<double> load) const {
  std::ranges::fill(load, 0);
  int i = 0;
  for (const auto& [side, sign] : {std::pair{&upper_, 1.}, std::pair{&lower_, -1.}}) {
    const std::vector<double>& unit = of_one_pascal_[i++];
    if (!*side) continue;
    if (unit.empty()) {
      add_faces(**side, sign, t, load);
      continue;
    }
    const double pressure = value(**side, Vec3::Zero(), t);
    for (std::size_t m = 0; m < unit.size(); ++m) load[m] += pressure * unit[m];
  }
}

double PressureLoad::value(const fv::Expression& side, const Vec3& x, double t) const {
  const auto fail = [&](const std::string& what) {
    throw Error("participants.{}.load.{}-pressure: at t = {:g} s{}: {}", name_,
                &side == &*upper_ ? "upper" : "lower", t,
                side.uses_space() ? fmt::format(" and ({:g}, {:g}, {:g})", x.x(), x.y(), x.z()) : "", what);
  };
  double pressure = 0;
  try {
    pressure = side(x, t);
  } catch (const Error& error) {
    fail(error.what());
  }
  if (!(std::abs(pressure) <= largest_pressure))
    fail(fmt::format("a pressure of {:g} Pa is not valid: magnitudes up to {:g} Pa are accepted.", pressure,
                     largest_pressure));
  return pressure;
}

mesh::Mesh mesh_of_surface(MPI_Comm comm, std::size_t n_vertices, const mesh::Csr& faces) {
  const bool has_all = parallel::comm_rank(comm) == 0;
  mesh::Mesh mesh;
  mesh.comm = comm;
  mesh.dim = 3;
  if (has_all) mesh.cell_points = faces;
  const Index n_faces = mesh.cell_points.size(), n_points = has_all ? Index(n_vertices) : 0;
  mesh.cells = parallel::IndexMap(comm, n_faces, {}, {});
  mesh.points = parallel::IndexMap(comm, n_points, {}, {});
  for (Index f = 0; f < n_faces; ++f)
    mesh.cell_type.push_back(faces[f].size() == 3 ? mesh::CellType::triangle : mesh::CellType::quadrilateral);
  mesh.cell_id.resize(std::size_t(n_faces));
  mesh.point_id.resize(std::size_t(n_points));
  std::iota(mesh.cell_id.begin(), mesh.cell_id.end(), 0);
  std::iota(mesh.point_id.begin(), mesh.point_id.end(), 0);
  return mesh;
}

std::vector<double> cell_pressures(const PlateModel& plate, const Parameters& parameters,
                                   const PressureLoad* load, std::span<const double> fluid, double t) {
  const Midsurface& s = plate.surface();
  const PlateFrame& place = parameters.placement;
  const Vec3 normal = place.normal();
  std::vector<double> pressure(s.cells.size(), 0);
  const std::vector<double> areas = plate.cell_areas();
  const std::size_t sides = parameters.wetted == Wetted::both ? 2 : 1;  // behind them the rim
  for (std::size_t f = 0; !fluid.empty() && f < sides * areas.size(); ++f)
    pressure[f % areas.size()] += Vec3(&fluid[3 * f]).dot(normal) / areas[f % areas.size()];
  for (Index c = 0; c < s.cells.size(); ++c) {
    Vec2 middle = Vec2::Zero();
    for (const Index p : s.cells[c]) middle += s.points[p] / double(s.cells[c].size());
    const double half = 0.5 * plate.cell(c).thickness;
    if (load && load->upper()) pressure[c] -= load->value(*load->upper(), place.place(middle, half), t);
    if (load && load->lower()) pressure[c] += load->value(*load->lower(), place.place(middle, -half), t);
    if (!parameters.gravity.empty())
      pressure[c] += plate.cell(c).surface_density() * normal.dot(Vec3(parameters.gravity.data()));
  }
  return pressure;
}

}  // namespace couplet::plate
