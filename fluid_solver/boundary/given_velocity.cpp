// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/boundary/given_velocity.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::fluid {

namespace {

constexpr double flat_enough = 1e-3;  // of the size of the patch
constexpr double round_enough = 0.1;  // of the area of the disc

struct Extent {
  Vec3 area = Vec3::Zero(), centre = Vec3::Zero();
  double size = 0, radius = 0;  // sum of |S|; largest distance of a point from the centre
};

Extent extent_of(const mesh::Mesh& mesh, const mesh::Geometry& g, const mesh::Patch& patch) {
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
  Extent e{{sums[0], sums[1], sums[2]}, Vec3(sums[3], sums[4], sums[5]) / sums[6], sums[6], 0};
  for (Index f = patch.first; f < patch.first + patch.count; ++f)
    for (const Index p : mesh.face_points[f]) e.radius = std::max(e.radius, (g.points[p] - e.centre).norm());
  e.radius = parallel::max(mesh.comm, e.radius);
  return e;
}

}  // namespace

template <int D>
InletShape<D> inlet_shape(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const mesh::Patch& patch,
                          InletProfile profile) {
  const Extent e = extent_of(mesh, geometry, patch);
  if (!(e.area.norm() > (1 - flat_enough) * e.size))
    throw Error("boundaries.{}: the patch is not flat, so 'mean-speed' has no direction. Give a 'velocity'.",
                patch.name);
  if (D == 3 && profile == InletProfile::parabolic &&
      std::abs(e.size / (std::numbers::pi * e.radius * e.radius) - 1) > round_enough)
    throw Error(
        "boundaries.{}: the patch is not round, so a parabolic profile is not defined. Give a 'velocity'.",
        patch.name);
  InletShape<D> shape;
  shape.direction = -e.area.normalized().template head<D>();
  double flow = 0;
  for (Index f = patch.first; f < patch.first + patch.count; ++f) {
    const double r = (geometry.face_centre[f] - e.centre).norm() / e.radius;
    shape.speed.push_back(profile == InletProfile::parabolic ? std::max(0.0, 1 - r * r) : 1.0);
    flow -= shape.speed.back() * shape.direction.dot(geometry.face_area[f].template head<D>());
  }
  const double mean = parallel::sum(mesh.comm, flow) / e.size;
  for (double& speed : shape.speed) speed /= mean;
  return shape;
}

fv::GridTable velocity_table(const std::filesystem::path& file, fv::GridTable::Outside outside,
                             int dimension) {
  std::vector<std::string> columns{"u", "v", "w"};
  columns.resize(std::size_t(dimension));
  return fv::GridTable::read(file, columns, outside);
}

std::vector<app::ProblemOfKey> problems_of_files(const FluidParameters& parameters,
                                                 const std::filesystem::path& case_folder) {
  std::vector<app::ProblemOfKey> all;
  for (const auto& [patch, boundary] : parameters.boundaries) {
    if (!boundary.table) continue;
    try {
      (void)velocity_table(case_folder / boundary.table->file, boundary.table->outside, parameters.dimension);
    } catch (const Error& error) {
      all.push_back({"boundaries." + patch + ".table.file", error.what()});
    }
  }
  return all;
}

namespace {

fv::Expression turning_of(const BoundaryParameters& b, const std::string& where) {
  fv::Expression speed(b.rotation->speed, where + ".rotation.speed");
  if (speed.uses_space()) throw Error("{}.rotation.speed: it may depend on t only.", where);
  return speed;
}

bool uses_space(const std::vector<fv::Expression>& expressions) {
  return std::ranges::any_of(expressions, [](const fv::Expression& e) { return e.uses_space(); });
}

double ramp_factor(const BoundaryParameters& b, double t) {
  if (!b.ramp || t >= *b.ramp) return 1;
  return t <= 0 ? 0 : 0.5 * (1 - std::cos(std::numbers::pi * t / *b.ramp));
}

}  // namespace

template <int D>
GivenVelocity<D>::GivenVelocity(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                const mesh::Patch& patch, const BoundaryParameters& b)
    : faces_{patch.first - mesh.n_interior, patch.count}, patch_(&patch), parameters_(b) {
  const std::string where = "boundaries." + patch.name;
  if (b.rotation) turning_ = turning_of(b, where);
  if (b.table) {
    table_ = velocity_table(b.table->file, b.table->outside, D);
  } else if (b.mean_speed) {
    mean_speed_ = fv::Expression(*b.mean_speed, where + ".mean-speed");
    shape_ = inlet_shape<D>(mesh, geometry, patch, b.profile);
  } else if (!b.velocity.empty()) {
    velocity_ = fv::make_expressions(b.velocity, D, where + ".velocity");
  }
  turns_ = is_wall(b) && (b.rotation || b.table || uses_space(velocity_));
}

template <int D>
void GivenVelocity<D>::evaluate(double t, std::span<const Vec3> places, Vec<D>* w) const {
  const std::size_t n = places.size();
  if (n == 0) return;
  const std::span<double> values(w->data(), n * D);
  if (!shape_.speed.empty()) {
    const double mean = mean_speed_(Vec3::Zero(), t);
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
  const double factor = ramp_factor(parameters_, t);
  for (std::size_t i = 0; factor != 1 && i < n; ++i) w[i] *= factor;
}

template InletShape<2> inlet_shape<2>(const mesh::Mesh&, const mesh::Geometry&, const mesh::Patch&,
                                      InletProfile);
template InletShape<3> inlet_shape<3>(const mesh::Mesh&, const mesh::Geometry&, const mesh::Patch&,
                                      InletProfile);
template class GivenVelocity<2>;
template class GivenVelocity<3>;

}  // namespace couplet::fluid
