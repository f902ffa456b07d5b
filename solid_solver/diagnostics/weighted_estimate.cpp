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
#include "solid_solver/body/inner_variation.hpp"
#include "solid_solver/body/stress.hpp"
#include "solid_solver/method/solution_method.hpp"

namespace couplet::solid {

namespace {

using Values = std::vector<double>;
using Strains = std::vector<std::array<float, 6>>;  // of the flux faces: few digits do, and half the room

// Tolerance of the dual solve.
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

/// V u of the owned cells, zero on faces.
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

/// sum_P (sum_f V_fP s_f : E_f - V_P s_P : E_P)
double variation_in_cells(const SolidBody& body, const Strains& of_u, const Strains& of_z,
                          std::span<const double> pressure) {
  const auto n = std::size_t(body.mesh().cells.n_owned());
  std::vector<Tensor3> stress(n, Tensor3::Zero()), strain(stress);
  Values volume(n, 0), varies(n, 0);
  elastic::visit_pyramids(body.mesh(), body.geometry(), [&](Index c, Index f, double v) {
    const Tensor3 s = body.elastic().stress(c, unpacked(of_u[f])) - pressure[f] * Tensor3::Identity();
    const Tensor3 e = unpacked(of_z[f]);
    stress[c] += v * s, strain[c] += v * e, volume[c] += v, varies[c] += v * contraction(s, e);
  });
  double all = 0;
  for (std::size_t c = 0; c < n; ++c)
    if (volume[c] > 0) all += varies[c] - contraction(stress[c], strain[c]) / volume[c];
  return all;
}

/// sum_f V_f |2 mu dE_f(u) : dE_f(z)|, each face on its owner.
double gap_of_gradients(const SolidBody& body, const std::array<const Strains*, 2>& of_u,
                        const std::array<const Strains*, 2>& of_z) {
  double all = 0;
  elastic::visit_pyramids(body.mesh(), body.geometry(), [&](Index c, Index f, double v) {
    const auto gap = [&](const auto& of) { return Tensor3(unpacked((*of[1])[f]) - unpacked((*of[0])[f])); };
    all += v * 2 * body.elastic().lame(c).mu * std::abs(contraction(gap(of_u), gap(of_z)));
  });
  return all;
}

/// Integral of v^2 with v = e (x - x_0) about the middle x_0 of the body, e the free thermal strain [m^5].
double free_size(const SolidBody& body, std::span<const double> pressure) {
  const int axes = body.parameters().plane == SolidParameters::Plane::stress ? 2 : 3;
  const mesh::Extent box = mesh::extent_of(body.mesh(), body.geometry());
  double all = 0;
  elastic::visit_pyramids(body.mesh(), body.geometry(), [&](Index c, Index f, double v) {
    const elastic::LameConstants& lame = body.elastic().lame(c);
    const double strain = pressure[f] / (axes * lame.lambda + 2 * lame.mu);
    all +=
        v * strain * strain * (body.geometry().cell_centre[c] - 0.5 * (box.lower + box.upper)).squaredNorm();
  });
  return parallel::sum(body.mesh().comm, all);
}

/// Kernel with the other face gradient, for comparison.
elastic::ElasticKernel other_kernel(const SolidBody& body) {
  return {body.mesh(), body.elastic(),
          body.is_corrected() ? elastic::FaceGradientScheme::thesis : elastic::FaceGradientScheme::corrected};
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
  const double varies = std::abs(parallel::sum(mesh.comm, variation_in_cells(body, u1, z1, pressure))) / 3;
  const elastic::ElasticKernel other = other_kernel(body);
  const Strains u2 = strains(other, mesh, unknowns, known), z2 = strains(other, mesh, z, {});
  const double missed = varies + parallel::sum(mesh.comm, gap_of_gradients(body, {&u1, &u2}, {&z1, &z2}));
  return missed / std::max(size, std::sqrt(size * free_size(body, pressure)));
}

namespace {

/// Strains of all flux faces: Green's strain of u, and its change by x.
struct FaceStrains {
  std::vector<Tensor3> of_u, of_x;
};

FaceStrains strains_by(const elastic::ElasticKernel& kernel, Index faces, std::span<const double> unknowns,
                       std::span<const double> known, std::span<const double> x) {
  FaceStrains found{std::vector<Tensor3>(std::size_t(faces)), std::vector<Tensor3>(std::size_t(faces))};
  std::vector<Tensor3>& gradient = found.of_x;
  kernel.face_gradients(
      unknowns, known, [&](Index f, const Tensor3& h) { gradient[std::size_t(f)] = h; }, 0, faces);
  const std::vector<double> at_rest(known.size(), 0);
  kernel.face_gradients(
      x, at_rest,
      [&](Index f, const Tensor3& change) {
        const Tensor3 h = gradient[std::size_t(f)];
        const Tensor3 turned = change + h.transpose() * change;
        found.of_u[std::size_t(f)] = 0.5 * (h + h.transpose() + h.transpose() * h);
        found.of_x[std::size_t(f)] = 0.5 * (turned + turned.transpose());
      },
      0, faces);
  return found;
}

double size_of(const std::vector<Tensor3>& strains) {
  double size = 0;
  for (const Tensor3& e : strains) size += e.squaredNorm();
  return std::sqrt(size);
}

/// Product of the variations of the face strains, from two squares.
double by_inner_variation(const SolidBody& body, const FaceStrains& s) {
  const mesh::Mesh& mesh = body.mesh();
  if (!InnerVariation::is_needed(mesh, body.elastic())) return 0;
  const double of_u = parallel::max(mesh.comm, size_of(s.of_u)),
               of_x = parallel::max(mesh.comm, size_of(s.of_x));
  if (!(of_u > 0) || !(of_x > 0)) return 0;
  const double factor = of_u / of_x;
  InnerVariation sum(mesh, body.elastic()), difference(mesh, body.elastic());
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    const Tensor3 x = factor * s.of_x[std::size_t(f)];
    sum.add(f, s.of_u[std::size_t(f)] + x);
    difference.add(f, s.of_u[std::size_t(f)] - x);
  }
  return (sum.energy() - difference.energy()) / (4 * factor);
}

/// Half the product of the differences, because each gradient has an error.
double by_gradients(const SolidBody& body, const FaceStrains& s, const FaceStrains& other) {
  const mesh::Mesh& mesh = body.mesh();
  double product = 0;
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    if (mesh.owner[f] >= mesh.cells.n_owned()) continue;
    const auto [here, there] = elastic::pyramids(mesh, body.geometry(), f);
    const auto i = std::size_t(f);
    product += (here + there) * body.elastic().lame(mesh.owner[f]).mu *
               (other.of_u[i] - s.of_u[i]).cwiseProduct(other.of_x[i] - s.of_x[i]).sum();
  }
  return parallel::sum(mesh.comm, product);
}

}  // namespace

double soft_mesh_error(const SolidBody& body, std::span<const double> unknowns, std::span<const double> known,
                       const SoftMotion& softest) {
  const std::vector<double>& x = softest.shape;
  const mesh::Mesh& mesh = body.mesh();
  if (!parallel::any(mesh.comm, !x.empty()) || !(softest.stiffness > 0)) return 0;
  const FaceStrains used = strains_by(body.kernel(), mesh.n_flux_faces(), unknowns, known, x);
  const FaceStrains other =
      strains_by(elastic::ElasticKernel(mesh, body.elastic(), elastic::FaceGradientScheme::corrected),
                 mesh.n_flux_faces(), unknowns, known, x);
  const double missed =
      std::max(std::abs(by_inner_variation(body, used)), std::abs(by_gradients(body, used, other)));
  std::vector<double> force(x.size());
  body.kernel().apply(x, {}, force);
  std::array<double, 3> sums{};  // x . K x of the body at rest; squares of x and u over the cells
  for (std::size_t i = 0; i < x.size(); ++i) sums[0] += x[i] * force[i];
  for (Index c = 0; c < mesh.cells.n_owned(); ++c)
    for (auto i = std::size_t(c) * mesh.dim; i < std::size_t(c + 1) * mesh.dim; ++i) {
      sums[1] += body.geometry().volume[c] * x[i] * x[i];
      sums[2] += body.geometry().volume[c] * unknowns[i] * unknowns[i];
    }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), int(sums.size()), MPI_DOUBLE, MPI_SUM, mesh.comm);
  if (!(sums[0] > 0) || !(sums[2] > 0)) return 0;
  return missed / (softest.stiffness * sums[0]) * std::sqrt(sums[1] / sums[2]);
}

}  // namespace couplet::solid
