// SPDX-License-Identifier: Apache-2.0
#include "common/fv/elastic_preconditioner.hpp"

#include <Eigen/Dense>
#include <algorithm>

namespace couplet {
namespace {

using Lanes = ComponentMultigrid::Lanes;

/// Two-point rows of the owned cells; boundary and partition faces stand on the diagonal only.
ComponentMultigrid::Rows compact_rows(const Mesh& mesh, const ElasticOperator& rows,
                                      std::span<const double> mu, std::span<const double> lambda,
                                      std::span<const double> inertia, double boundary_factor) {
  const Index n = mesh.cells.n_owned();
  const FaceGradient& faces = rows.faces();
  const auto coefficient = [&](Index f) {
    const Index p = mesh.owner[f];
    const double scale = mesh.reference.face_area[f].norm() * faces.inverse_dn[f];
    Lanes k{};
    for (int c = 0; c < mesh.dim; ++c) {
      const double nc = faces.normal[f][c];
      k[c] = static_cast<float>(scale * (mu[p] + (mu[p] + lambda[p]) * nc * nc));
    }
    return k;
  };
  const auto within = [&](Index f) { return mesh.owner[f] < n && mesh.neighbour[f] < n; };

  ComponentMultigrid::Rows result;
  Lanes unused{};
  for (int c = mesh.dim; c < ComponentMultigrid::lanes; ++c) unused[c] = 1;
  result.diagonal.assign(n, unused);
  result.offset.assign(n + 1, 0);
  for (Index f = 0; f < mesh.n_interior; ++f)
    if (within(f)) ++result.offset[mesh.owner[f] + 1], ++result.offset[mesh.neighbour[f] + 1];
  for (Index c = 0; c < n; ++c) result.offset[c + 1] += result.offset[c];
  result.index.resize(result.offset.back());
  result.value.resize(result.offset.back());
  std::vector<Index> next(result.offset.begin(), result.offset.end() - 1);
  // Faces come in the order of their smaller cell: first the rows' larger neighbours would be written, so
  // that the smaller ones take a pass of their own.
  const auto put = [&](Index row, Index column, const Lanes& k) {
    result.index[next[row]] = column;
    result.value[next[row]++] = -k;
  };
  for (const bool smaller : {true, false})
    for (Index f = 0; f < mesh.n_interior; ++f) {
      if (!within(f)) continue;
      const auto [low, high] = std::minmax(mesh.owner[f], mesh.neighbour[f]);
      smaller ? put(high, low, coefficient(f)) : put(low, high, coefficient(f));
    }
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    Lanes k = coefficient(f);
    if (f >= mesh.n_interior) {
      const ElasticCondition condition = rows.condition(f);
      if (condition == ElasticCondition::traction) continue;
      for (int c = 0; c < mesh.dim; ++c) {
        const double nc = faces.normal[f][c];
        k[c] *= static_cast<float>(condition == ElasticCondition::symmetry ? nc * nc : boundary_factor);
      }
    } else if (mesh.neighbour[f] < n) {
      result.diagonal[mesh.neighbour[f]] += k;
    }
    if (mesh.owner[f] < n) result.diagonal[mesh.owner[f]] += k;
  }
  for (std::size_t c = 0; c < inertia.size(); ++c)
    for (int a = 0; a < mesh.dim; ++a) result.diagonal[c][a] += static_cast<float>(inertia[c]);
  return result;
}

}  // namespace

ElasticPreconditioner::ElasticPreconditioner(const Mesh& mesh, const ElasticOperator& rows,
                                             std::span<const double> mu, std::span<const double> lambda,
                                             std::span<const double> inertia, FaceGradientScheme scheme,
                                             int n_aggregates)
    : mesh_(&mesh), rows_(&rows) {
  const double boundary_factor = scheme == FaceGradientScheme::corrected ? 2 : 1;  // 2 (u_B - u_P) there
  multigrid_ =
      std::make_unique<ComponentMultigrid>(compact_rows(mesh, rows, mu, lambda, inertia, boundary_factor));
  const FaceGradient& faces = rows.faces();
  for (const Index f : rows.traction_faces()) {
    const Index p = mesh.owner[f];
    const Tensor3 nn = faces.normal[f] * faces.normal[f].transpose();
    const Tensor3 own = boundary_factor * mesh.reference.face_area[f].norm() * faces.inverse_dn[f] *
                        (mu[p] * (Tensor3::Identity() + nn) + lambda[p] * nn);
    inverse_own_.push_back(own.inverse());
  }
  if (n_aggregates > 0)
    coarse_ = std::make_unique<RigidCoarseSpace>(mesh, rows, mu, lambda, inertia, n_aggregates);
}

void ElasticPreconditioner::apply(std::span<const double> r, std::span<double> z) {
  const int dim = mesh_->dim;
  const std::size_t n_cells = std::size_t(mesh_->cells.n_owned()) * dim;
  multigrid_->apply(r.first(n_cells), z.first(n_cells), dim);
  const auto& faces = rows_->traction_faces();
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const double* here = r.data() + n_cells + i * dim;
    const double* cell = z.data() + std::size_t(mesh_->owner[faces[i]]) * dim;
    for (int a = 0; a < dim; ++a) {
      double u = cell[a];
      for (int b = 0; b < dim; ++b) u += inverse_own_[i](a, b) * here[b];
      z[n_cells + i * dim + a] = u;
    }
  }
  if (coarse_) coarse_->add_correction(r, z);
}

}  // namespace couplet
