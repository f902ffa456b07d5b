// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/tied/tied_assembly.hpp"

#include <algorithm>
#include <cmath>

#include "common/elasticity/elastic_nodes.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::elastic {

GradientStiffness stiffness_of(const LameConstants& lame) {
  GradientStiffness c = GradientStiffness::Zero();
  for (int k = 0; k < 3; ++k)
    for (int a = 0; a < 3; ++a) {
      c(3 * k + k, 3 * a + a) += lame.lambda;
      c(3 * k + a, 3 * k + a) += lame.mu;
      c(3 * k + a, 3 * a + k) += lame.mu;
    }
  return c;
}

GradientStiffness stiffness_of(const ElasticMatrix& matrix) {
  constexpr int strain[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
  GradientStiffness c;
  for (int i = 0; i < 9; ++i)
    for (int j = 0; j < 9; ++j) c(i, j) = matrix(strain[i / 3][i % 3], strain[j / 3][j % 3]);
  return c;
}

GradientStiffness stiffness_of_stress(const Tensor3& stress) {
  GradientStiffness c = GradientStiffness::Zero();
  for (int k = 0; k < 3; ++k) c.block<3, 3>(3 * k, 3 * k) = stress;
  return c;
}

TiedAssembly::TiedAssembly(const mesh::Mesh& mesh, const ElasticOperator& rows, const TiedUnknowns& unknowns)
    : mesh_(mesh), geometry_(rows.geometry()), rows_(rows), unknowns_(unknowns) {
  pairs_.reserve(std::size_t(mesh.n_flux_faces()) * (mesh.dim == 2 ? 8 : 40));
}

void TiedAssembly::add(std::span<const TiedTerm> terms, const GradientStiffness& stiffness) {
  for (const TiedTerm& i : terms) {
    Eigen::Matrix<double, 3, 9> left;
    for (int k = 0; k < 3; ++k) left.row(k) = i.b.transpose() * stiffness.middleRows<3>(3 * k);
    left = (i.turn.transpose() * left).eval();
    for (const TiedTerm& j : terms) {
      Tensor3 block;
      for (int m = 0; m < 3; ++m) block.col(m) = left.middleCols<3>(3 * m) * j.b;
      add_block(i.block, j.block, block * j.turn);
    }
  }
}

/// Springs act on the mean displacement of a face.
void TiedAssembly::add_supports() {
  for (const Index f : rows_.known_faces()) {
    const BoundaryRow& s = rows_.at(f);
    if (s.fixed) continue;
    const LameConstants lame = rows_.lame(mesh_.owner[f]);
    const fv::FaceLine line = fv::face_line(mesh_, geometry_, f);
    const GlobalIndex node = unknowns_.node(mesh_.cells.n_local() + f - mesh_.n_interior);
    add_block(node, node, (2 * lame.mu + lame.lambda) * line.area * line.inverse_dn * s.known);
    if (s.spring.isZero(0)) continue;
    const Tensor3 open = Tensor3::Identity() - s.known,
                  spring = geometry_.face_area[f].norm() * (open * s.spring * open);
    const std::vector<TiedTerm> mean = mean_terms(mesh_, rows_, unknowns_, f);
    for (const TiedTerm& i : mean)
      for (const TiedTerm& j : mean)
        add_block(i.block, j.block, i.b[0] * j.b[0] * (i.turn.transpose() * spring * j.turn));
  }
}

void TiedAssembly::add_mass(double factor, std::span<const double> of_nodes,
                            std::span<const double> of_points) {
  for (Index i = 0; i < Index(of_nodes.size()); ++i) {
    const GlobalIndex node = unknowns_.node(i);
    if (node < 0 || of_nodes[std::size_t(i)] == 0) continue;
    Tensor3 open = Tensor3::Identity();
    const Index f = i - mesh_.cells.n_local() + mesh_.n_interior;
    if (i >= mesh_.cells.n_local()) open -= rows_.at(f).known;
    add_block(node, node, factor * of_nodes[std::size_t(i)] * open);
  }
  for (Index v = 0; v < Index(of_points.size()); ++v)
    if (unknowns_.point(v) >= 0 && of_points[std::size_t(v)] != 0)
      add_block(unknowns_.point(v), unknowns_.point(v),
                factor * of_points[std::size_t(v)] * Tensor3::Identity());
}

void TiedAssembly::add_places(double factor, std::span<const PlaceBlock> blocks) {
  const Index n_cells = mesh_.cells.n_local(), n_nodes = n_cells + mesh_.boundary.n_local();
  const auto number = [&](Index place) {
    return place < n_nodes ? unknowns_.node(place) : unknowns_.point(place - n_nodes);
  };
  const auto open = [&](Index place) {
    Tensor3 part = Tensor3::Identity();
    const Index f = place - n_cells + mesh_.n_interior;
    if (place >= n_cells && place < n_nodes) part -= rows_.at(f).known;
    return part;
  };
  for (const PlaceBlock& b : blocks)
    if (number(b.i) >= 0 && number(b.j) >= 0)
      add_block(number(b.i), number(b.j), factor * (open(b.i) * b.block * open(b.j)));
}

double TiedAssembly::mean_diagonal() const {
  double total = 0, count = 0;
  for (std::size_t k = 0; k < pairs_.size(); ++k)
    if (pairs_.pair(k).first == pairs_.pair(k).second) total += std::abs(pairs_.block(k)(0, 0)), count += 1;
  return parallel::sum(mesh_.comm, total) / std::max(1.0, parallel::sum(mesh_.comm, count));
}

void TiedAssembly::add_ties(double tie) {
  const auto both = [&](GlobalIndex i, GlobalIndex j, const Tensor3& block) {
    add_block(i, j, block);
    add_block(j, i, block.transpose());
  };
  for (std::size_t k = 0; k < unknowns_.points().size(); ++k) {
    const Index v = unknowns_.points()[k];
    const GlobalIndex multiplier = unknowns_.first_multiplier() + GlobalIndex(k);
    both(multiplier, unknowns_.point(v), tie * Tensor3::Identity());
    const auto nodes = rows_.vertices().nodes(v);
    const auto weights = rows_.vertices().weights(v);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const GlobalIndex node = unknowns_.node(nodes[i]);
      if (node < 0) continue;
      Tensor3 turn = rows_.constraints().free_part(v);
      const Index f = nodes[i] - mesh_.cells.n_local() + mesh_.n_interior;
      if (nodes[i] >= mesh_.cells.n_local() && rows_.at(f).held)
        turn = (turn * (Tensor3::Identity() - rows_.at(f).known)).eval();
      both(multiplier, node, -tie * weights[i] * turn);
    }
  }
}

linalg::SparseMatrix TiedAssembly::matrix(double& tie) {
  if (tie == 0) tie = mean_diagonal();
  add_ties(tie);
  return pairs_.matrix(mesh_.comm, GlobalIndex(unknowns_.n_blocks()) * mesh_.dim, mesh_.dim,
                       [](GlobalIndex block) { return block; });
}

}  // namespace couplet::elastic
