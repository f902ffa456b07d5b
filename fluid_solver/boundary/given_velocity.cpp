// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/boundary/given_velocity.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/error.hpp"
#include "fluid_solver/parameters/files.hpp"

namespace couplet::fluid {
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

template class GivenVelocity<2>;
template class GivenVelocity<3>;

}  // namespace couplet::fluid
