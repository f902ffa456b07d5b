// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/diagnostics/weighted_estimate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "common/base/error.hpp"
#include "common/elasticity/symmetric/symmetric_faces.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/body/stress.hpp"
#include "solid_solver/diagnostics/inner_variation.hpp"
#include "solid_solver/method/solution_method.hpp"

namespace couplet::solid {
namespace {

using Values = std::vector<double>;
using Strains = std::vector<std::array<float, 6>>;  // of the flux faces: few digits do, and half the room

// Of the one solve.
constexpr double tolerance = 1e-4;

std::array<float, 6> packed(const Tensor3& t) {
  std::array<float, 6> e{};
  std::ranges::transform(pack(t), e.begin(), [](double v) { return float(v); });
  return e;
}

Tensor3 unpacked(const std::array<float, 6>& e) {
  PackedTensor t;
  std::ranges::copy(e, t.begin());
  return unpack(t);
}

Strains strains(const elastic::ElasticKernel& kernel, const mesh::Mesh& mesh,
                std::span<const double> unknowns, std::span<const double> known) {
  Strains all(std::size_t(mesh.n_flux_faces()));
  kernel.face_gradients(
      unknowns, known,
      [&](Index f, const Tensor3& h) { all[std::size_t(f)] = packed(0.5 * (h + h.transpose())); }, 0,
      mesh.n_flux_faces());
  return all;
}

/// V u of the owned cells, nothing on faces.
Values weight_of(const mesh::Mesh& mesh, const mesh::Geometry& geometry, std::span<const double> unknowns) {
  const std::size_t dim = std::size_t(mesh.dim), n = std::size_t(mesh.cells.n_owned()) * dim;
  Values weight(unknowns.size(), 0);
  for (std::size_t i = 0; i < n; ++i) weight[i] = geometry.volume[i / dim] * unknowns[i];
  return weight;
}

Values sensitivity(const SolidBody& body, std::span<const double> weight) {
  const SolidProblem problem{
      body.mesh(), body.elastic(), {}, body.kernel(), 0, body.rigid().empty() ? nullptr : &body.rigid()};
  MethodParameters method = body.parameters().method;
  method.relative_tolerance = std::max(method.relative_tolerance, tolerance);
  Values z(weight.size(), 0);
  make_solution_method(problem, method)->solve(weight, z);
  return z;
}

/// Both sides of a face with the volumes of their pyramids, those of this rank.
template <class Take>
void visit_sides(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const Take& take) {
  const Index n = mesh.cells.n_owned();
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    const auto [here, there] = elastic::pyramids(mesh, geometry, f);
    if (mesh.owner[f] < n) take(mesh.owner[f], f, here);
    if (f < mesh.n_interior && mesh.neighbour[f] < n) take(mesh.neighbour[f], f, there);
  }
}

/// sum_P |sum_f V_fP s_f : E_f - V_P s_P : E_P|
double variation_in_cells(const SolidBody& body, const Strains& of_u, const Strains& of_z,
                          std::span<const double> pressure) {
  const auto n = std::size_t(body.mesh().cells.n_owned());
  std::vector<Tensor3> stress(n, Tensor3::Zero()), strain(stress);
  Values volume(n, 0), varies(n, 0);
  visit_sides(body.mesh(), body.geometry(), [&](Index c, Index f, double v) {
    const Tensor3 s = body.elastic().stress(c, unpacked(of_u[f])) - pressure[f] * Tensor3::Identity();
    const Tensor3 e = unpacked(of_z[f]);
    stress[c] += v * s, strain[c] += v * e, volume[c] += v, varies[c] += v * contraction(s, e);
  });
  double all = 0;
  for (std::size_t c = 0; c < n; ++c)
    if (volume[c] > 0) all += std::abs(varies[c] - contraction(stress[c], strain[c]) / volume[c]);
  return all;
}

/// sum_f V_f |2 mu dE_f(u) : dE_f(z)|, faces by their owners.
double gap_of_gradients(const SolidBody& body, const std::array<const Strains*, 2>& of_u,
                        const std::array<const Strains*, 2>& of_z) {
  double all = 0;
  visit_sides(body.mesh(), body.geometry(), [&](Index c, Index f, double v) {
    const auto gap = [&](const auto& of) { return Tensor3(unpacked((*of[1])[f]) - unpacked((*of[0])[f])); };
    all += v * 2 * body.elastic().lame(c).mu * std::abs(contraction(gap(of_u), gap(of_z)));
  });
  return all;
}

/// With the gradient that the body's is compared with.
elastic::ElasticKernel other_kernel(const SolidBody& body) {
  return {body.mesh(), body.elastic(),
          body.is_corrected() ? elastic::FaceGradientScheme::thesis : elastic::FaceGradientScheme::corrected};
}

double energy_missed(const SolidBody& body, const Strains& used, const Strains& compared) {
  const mesh::Geometry& geometry = body.geometry();
  const mesh::Mesh& mesh = body.mesh();
  double gap = 0, size = 0;
  visit_sides(mesh, geometry, [&](Index c, Index f, double v) {
    const Tensor3 e = unpacked(used[f]);
    const double weight = v * body.elastic().lame(c).mu;
    gap += weight * (unpacked(compared[f]) - e).squaredNorm(), size += weight * e.squaredNorm();
  });
  gap = parallel::sum(mesh.comm, gap), size = parallel::sum(mesh.comm, size);
  const double missed = size > 0 ? gap / size : 0;
  if (!InnerVariation::is_needed(mesh, body.elastic())) return missed;
  InnerVariation variation(mesh, body.elastic());
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) variation.add(f, unpacked(used[f]));
  return std::max(missed, variation.missed());
}

}  // namespace

double weighted_mesh_error(const SolidBody& body, std::span<const double> unknowns,
                           std::span<const double> known, std::span<const double> pressure) {
  const mesh::Geometry& geometry = body.geometry();
  const mesh::Mesh& mesh = body.mesh();
  const Values weight = weight_of(mesh, geometry, unknowns);
  double size = 0;
  for (std::size_t i = 0; i < weight.size(); ++i) size += weight[i] * unknowns[i];
  size = parallel::sum(mesh.comm, size);
  if (!(size > 0)) return 0;
  Values z;
  try {
    z = sensitivity(body, weight);
  } catch (const SolveFailure&) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const Strains u1 = strains(body.kernel(), mesh, unknowns, known), z1 = strains(body.kernel(), mesh, z, {});
  double missed = variation_in_cells(body, u1, z1, pressure) / 3;
  const elastic::ElasticKernel other = other_kernel(body);
  const Strains u2 = strains(other, mesh, unknowns, known), z2 = strains(other, mesh, z, {});
  missed += gap_of_gradients(body, {&u1, &u2}, {&z1, &z2});
  return parallel::sum(mesh.comm, missed) / size;
}

double energy_mesh_error(const SolidBody& body, std::span<const std::span<const double>> shapes) {
  const elastic::ElasticKernel other = other_kernel(body);
  double most = 0;
  for (const std::span<const double> shape : shapes)
    most = std::max(most, energy_missed(body, strains(body.kernel(), body.mesh(), shape, {}),
                                        strains(other, body.mesh(), shape, {})));
  return most;
}

}  // namespace couplet::solid
