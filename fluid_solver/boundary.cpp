// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/boundary.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/parallel/collective.hpp"

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
        "boundaries: the mesh '{}' has patches without a boundary: {}. Give each of them a type (inlet, "
        "outlet, "
        "no-slip, moving-wall, slip or interface).",
        parameters.mesh, join(missing));
}

FaceKind kind_of(BoundaryType type) {
  if (type == BoundaryType::outlet) return FaceKind::pressure;
  return type == BoundaryType::slip ? FaceKind::slip : FaceKind::velocity;
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
  for (const Patch& patch : mesh.patches) {
    const BoundaryParameters& b = parameters.boundaries.at(patch.name);
    const Index first = patch.first - mesh.n_interior;
    std::fill_n(kind_.begin() + first, patch.count, kind_of(b.type));
    Given given{first, patch.count, b, {}, {}};
    if (b.type == BoundaryType::interface) {
      std::fill_n(interface_.begin() + first, patch.count, 1);
      interface_patches_.push_back(patch.name);
    } else if (b.type == BoundaryType::outlet) {
      closed_ = false;
      given.pressure = Expression(b.pressure, "boundaries." + patch.name + ".pressure");
      pressure_patches_.push_back(std::move(given));
    } else if (b.type != BoundaryType::slip) {
      if (b.type != BoundaryType::no_slip)
        given.velocity = make_expressions(b.velocity, D, "boundaries." + patch.name + ".velocity");
      velocity_patches_.push_back(std::move(given));
    }
  }
}

template <int D>
void Boundary<D>::velocity_at(double t, const std::vector<Vec3>& centres, Vectors<D>& w) const {
  for (const Given& g : velocity_patches_) {
    const std::span<const Vec3> places(centres.data() + g.first, g.count);
    const std::span<double> values = flat<D>(w).subspan(std::size_t(g.first) * D, std::size_t(g.count) * D);
    if (g.velocity.empty() || g.count == 0) {
      std::fill(values.begin(), values.end(), 0.0);
      continue;
    }
    for (int c = 0; c < D; ++c) g.velocity[c].evaluate(places, t, values, D, c);
    const double factor = ramp_factor(g.parameters, t);
    if (factor != 1)
      for (double& v : values) v *= factor;
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

template <int D>
double Boundary<D>::largest_speed(double t, const std::vector<Vec3>& centres) const {
  Vectors<D> w(kind_.size(), Vec<D>::Zero());
  velocity_at(t, centres, w);
  double speed = 0;
  for (const Vec<D>& v : w) speed = std::max(speed, v.norm());
  return max(comm_, speed);
}

template class Boundary<2>;
template class Boundary<3>;

}  // namespace couplet::fluid
