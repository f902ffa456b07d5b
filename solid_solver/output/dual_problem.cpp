// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/output/dual_problem.hpp"

#include <algorithm>

#include "common/elasticity/symmetric/symmetric_faces.hpp"
#include "common/elasticity/symmetric/symmetric_space.hpp"
#include "common/elasticity/vector_at.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/body/stress.hpp"

namespace couplet::solid {
namespace {

using Values = std::vector<double>;

Values rows_of_points(const SolidBody& body, std::span<const double> weights) {
  elastic::SymmetricSpace space(body.mesh(), body.elastic());
  space.clear_forces();
  const int dim = body.mesh().dim;
  for (Index v = 0; v * dim < Index(weights.size()); ++v)
    space.force(space.place_of_point(v)) = elastic::vector_at(weights, v, dim);
  Values rows(body.elastic().n_unknowns(), 0);
  space.add_collected(rows);
  return rows;
}

/// Transpose of the gradient of FaceRows: forces of sum_f stress_f : G_f.
Values rows_of_stress(const SolidBody& body, const std::vector<Tensor3>& stress) {
  elastic::SymmetricSpace space(body.mesh(), body.elastic());
  space.clear_forces();
  for (Index f = 0; f < body.mesh().n_flux_faces(); ++f) {
    if (stress[std::size_t(f)].isZero(0)) continue;
    const elastic::FaceRows face = elastic::symmetric_rows(body.mesh(), body.elastic(), f);
    for (const auto& [place, b] : face.all()) space.force(place) += stress[std::size_t(f)] * b;
  }
  Values rows(body.elastic().n_unknowns(), 0);
  space.add_collected(rows);
  return rows;
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
  return rows_of_points(body_, weights);
}

std::vector<double> DualProblem::of_stress(std::span<const Index> cells, const Tensor3& weights) const {
  const mesh::Mesh& mesh = body_.mesh();
  double volume = 0;
  std::vector<Tensor3> stress(std::size_t(mesh.n_flux_faces()), Tensor3::Zero());
  elastic::visit_pyramids(body_.mesh(), body_.geometry(), [&](Index c, Index f, double v) {
    if (std::ranges::find(cells, c) == cells.end()) return;
    volume += v;
    stress[std::size_t(f)] += v * body_.elastic().stress(c, weights);  // C is symmetric
  });
  volume = parallel::sum(mesh.comm, volume);
  for (Tensor3& s : stress) s /= volume;
  return rows_of_stress(body_, stress);
}

double DualProblem::missed(std::span<const double> j, SolutionMethod& method) const {
  Values z(j.size(), 0);
  method.solve(j, z);
  const std::vector<Tensor3> of_z = gap(z, {});
  double sum = 0;
  elastic::visit_pyramids(body_.mesh(), body_.geometry(), [&](Index c, Index f, double v) {
    const Tensor3 &e = gap_[std::size_t(f)], &of_dual = of_z[std::size_t(f)];
    sum += v * contraction(body_.elastic().stress(c, e), of_dual);
    // The mean volume strain of a cell has no gap.
    if (body_.elastic().volume_by_cells())
      sum -= v * body_.elastic().lame(c).lambda * e.trace() * of_dual.trace();
  });
  return parallel::sum(body_.mesh().comm, sum);
}

}  // namespace couplet::solid
