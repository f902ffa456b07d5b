// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/diagnostics/weighted_estimate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "common/elasticity/symmetric/symmetric_faces.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/body/inner_variation.hpp"

namespace couplet::solid {

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
