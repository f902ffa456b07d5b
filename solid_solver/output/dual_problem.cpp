// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/output/dual_problem.hpp"

#include <algorithm>

#include "common/elasticity/symmetric/symmetric_faces.hpp"
#include "common/elasticity/symmetric/symmetric_space.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/body/stress.hpp"

namespace couplet::solid {
namespace {

using Values = std::vector<double>;

template <int D>
Values rows_of_points(const SolidBody& body, std::span<const double> weights) {
  elastic::SymmetricSpace<D> space(body.mesh(), body.elastic());
  constexpr std::size_t stride = elastic::SymmetricSpace<D>::stride;
  space.clear_forces();
  for (std::size_t i = 0; i < weights.size(); ++i) space.point_forces()[i / D * stride + i % D] = weights[i];
  Values rows(body.elastic().n_unknowns(), 0);
  space.add_collected(rows);
  return rows;
}

/// The transpose of the gradient of SymmetricFace: forces of sum_f stress_f : G_f.
template <int D>
Values rows_of_stress(const SolidBody& body, const std::vector<Tensor3>& stress) {
  elastic::SymmetricSpace<D> space(body.mesh(), body.elastic());
  constexpr std::size_t stride = elastic::SymmetricSpace<D>::stride;
  space.clear_forces();
  const auto add = [](double* forces, Index at, const Vec3& force) {
    for (int a = 0; a < D; ++a) forces[std::size_t(at) * stride + std::size_t(a)] += force[a];
  };
  const auto times = [](const Tensor3& s, const std::array<double, D>& area) {
    Vec3 v = Vec3::Zero();
    for (int a = 0; a < D; ++a) v[a] = area[std::size_t(a)];
    return Vec3(s * v);
  };
  for (Index f = 0; f < body.mesh().n_flux_faces(); ++f) {
    const Tensor3& s = stress[std::size_t(f)];
    if (s.isZero(0)) continue;
    const elastic::SymmetricFace<D> face = elastic::symmetric_face<D>(body.mesh(), body.elastic(), f);
    const Vec3 across = face.inverse * times(s, face.area);
    add(space.forces(), space.node_across(f), across);
    add(space.forces(), body.mesh().owner[f], -across);
    for (std::size_t i = 0; i < D - 1; ++i) {
      const Vec3 along = face.inverse * times(s, face.across[i]);
      add(space.point_forces(), face.plus[i], along);
      add(space.point_forces(), face.minus[i], -along);
    }
  }
  Values rows(body.elastic().n_unknowns(), 0);
  space.add_collected(rows);
  return rows;
}

/// take(owned cell, face, volume of its pyramid).
template <class Take>
void visit_pyramids(const SolidBody& body, const Take& take) {
  const mesh::Mesh& mesh = body.mesh();
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    const auto [here, there] = elastic::pyramids(mesh, body.geometry(), f);
    if (mesh.owner[f] < mesh.cells.n_owned()) take(mesh.owner[f], f, here);
    if (f < mesh.n_interior && mesh.neighbour[f] < mesh.cells.n_owned()) take(mesh.neighbour[f], f, there);
  }
}

}  // namespace

DualProblem::DualProblem(const SolidBody& body, std::span<const double> unknowns,
                         std::span<const double> known)
    : body_(body),
      other_(body.mesh(), body.elastic(), elastic::FaceGradientScheme::corrected),
      gap_(gap(unknowns, known)) {}

std::vector<Tensor3> DualProblem::gap(std::span<const double> unknowns, std::span<const double> known) const {
  const Index n = body_.mesh().n_flux_faces();
  std::vector<Tensor3> result(static_cast<std::size_t>(n));
  const auto strain = [](const Tensor3& g) { return Tensor3(0.5 * (g + g.transpose())); };
  body_.kernel().face_gradients(
      unknowns, known, [&](Index f, const Tensor3& g) { result[std::size_t(f)] = -strain(g); }, 0, n);
  other_.face_gradients(
      unknowns, known, [&](Index f, const Tensor3& g) { result[std::size_t(f)] += strain(g); }, 0, n);
  return result;
}

std::vector<double> DualProblem::of_points(std::span<const double> weights) const {
  return body_.mesh().dim == 2 ? rows_of_points<2>(body_, weights) : rows_of_points<3>(body_, weights);
}

std::vector<double> DualProblem::of_stress(std::span<const Index> cells, const Tensor3& weights) const {
  const mesh::Mesh& mesh = body_.mesh();
  double volume = 0;
  std::vector<Tensor3> stress(std::size_t(mesh.n_flux_faces()), Tensor3::Zero());
  visit_pyramids(body_, [&](Index c, Index f, double v) {
    if (std::ranges::find(cells, c) == cells.end()) return;
    volume += v;
    stress[std::size_t(f)] += v * body_.elastic().stress(c, weights);  // C is symmetric
  });
  volume = parallel::sum(mesh.comm, volume);
  for (Tensor3& s : stress) s /= volume;
  return mesh.dim == 2 ? rows_of_stress<2>(body_, stress) : rows_of_stress<3>(body_, stress);
}

double DualProblem::missed(std::span<const double> j, SolutionMethod& method) const {
  Values z(j.size(), 0);
  method.solve(j, z);
  const std::vector<Tensor3> of_z = gap(z, {});
  double sum = 0;
  visit_pyramids(body_, [&](Index c, Index f, double v) {
    sum += v * contraction(body_.elastic().stress(c, gap_[std::size_t(f)]), of_z[std::size_t(f)]);
  });
  return parallel::sum(body_.mesh().comm, sum);
}

}  // namespace couplet::solid
