// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/elasticity/finite/finite_kernel.hpp"
#include "tests/verification/solid/support.hpp"

namespace couplet::testing {

/// Case E: a cantilever of square section, its tip pulled along the diagonal by K E I / L^2 times t, L = 10 sides.
inline constexpr double beam_side = 0.2, beam_length = 2;

inline SolidParameters bent(SolidParameters p, double K) {
  p.kinematics = SolidParameters::Kinematics::finite_strain;
  p.boundaries["zmin"] = clamped(3);
  const double inertia = std::pow(beam_side, 4) / 12,
               force = K * p.material.youngs_modulus * inertia / (beam_length * beam_length);
  const std::string pull = fmt::format("t*{:.17g}", force / (beam_side * beam_side) / std::sqrt(2.0));
  p.boundaries["zmax"] = boundary(Type::traction, {pull, pull, "0"});
  return p;
}

inline mesh::RawMesh beam(int n, int along) {
  return mesh::make_box(mesh::BoxCells::hexahedra, {n, n, along}, Vec3(-beam_side / 2, -beam_side / 2, 0),
                        Vec3(beam_side / 2, beam_side / 2, beam_length));
}

/// Deflection of the middle of the tip over the length, on all ranks.
inline double deflection(const Solid& solid) {
  const Vec3 tip = displacement_at(solid, Vec3(0, 0, beam_length));
  return std::hypot(tip[0], tip[1]) / beam_length;
}

/// Supports of several kinds, a pressure that follows the top.
inline SolidParameters busy(int dim, MethodParameters::VolumeStrain volume) {
  SolidParameters p = box_parameters(dim);
  p.kinematics = SolidParameters::Kinematics::finite_strain;
  p.material = {1000, 1e6, 0.3};
  p.material.law = "mooney-rivlin";
  p.material.law_coefficients = {0.3};
  p.method.volume_strain = volume;
  p.boundaries["xmin"] = clamped(dim);
  p.boundaries["ymin"] = boundary(Type::symmetry);
  p.boundaries["ymax"] = pressed("1e5*t");
  return p;
}

inline std::vector<double> noise(std::size_t n, double size, unsigned seed) {
  std::vector<double> values(n);
  for (std::size_t i = 0; i < n; ++i) values[i] = size * std::sin(12.9898 * double(i + 1) * seed + seed);
  return values;
}

inline double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double here = 0;
  for (std::size_t i = 0; i < a.size(); ++i) here += a[i] * b[i];
  return parallel::sum(MPI_COMM_WORLD, here);
}

/// The tangent is the derivative of the forces; with `energy` these are the energy's derivative and the tangent is symmetric.
inline void expect_derivatives(elastic::FiniteKernel& kernel, std::size_t n, bool energy = true,
                               double symmetry = 1e-10) {
  const std::vector<double> u = noise(n, 0.02, 1), v = noise(n, 1, 2), w = noise(n, 1, 3);
  const double h = 1e-6;
  std::vector<double> up = u, down = u, force(n), ahead(n), behind(n), kv(n), kw(n);
  for (std::size_t i = 0; i < n; ++i) up[i] += h * v[i], down[i] -= h * v[i];
  const auto energy_now = [&] { return energy ? parallel::sum(MPI_COMM_WORLD, kernel.energy()) : 0; };
  kernel.linearise(up, {}, 0, ahead);
  const double most = energy_now();
  kernel.linearise(down, {}, 0, behind);
  const double least = energy_now();
  kernel.linearise(u, {}, 0, force);
  kernel.apply_tangent(v, {}, 0, kv);
  kernel.apply_tangent(w, {}, 0, kw);
  std::vector<double> gap(n);
  for (std::size_t i = 0; i < n; ++i) gap[i] = (ahead[i] - behind[i]) / (2 * h) - kv[i];
  EXPECT_LT(std::sqrt(dot(gap, gap)), 1e-6 * std::sqrt(dot(kv, kv)));
  if (!energy) return;
  EXPECT_NEAR((most - least) / (2 * h), dot(force, v), 1e-5 * std::sqrt(dot(force, force) * dot(v, v)));
  EXPECT_NEAR(dot(w, kv), dot(v, kw), symmetry * std::sqrt(dot(kv, kv) * dot(w, w)));
}

}  // namespace couplet::testing
