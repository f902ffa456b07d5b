// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/solve/rigid_coarse_space.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "common/elasticity/elastic_nodes.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::elastic {
namespace {

using Modes = Eigen::Matrix<double, 3, 6>;
using Block = Eigen::Matrix<double, 6, 6>;

Tensor3 cross_matrix(const Vec3& v) {
  Tensor3 m;
  m << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0;
  return m;
}

/// Entry of Z^T A Z for another rank.
struct Entry {
  Index row, column;
  double value;
};

}  // namespace

/// Assembly of Z^T A Z.
struct RigidCoarseSpace::Assembly {
  /// Part of a vertex value that follows one aggregate: sum w and sum w (x_i - c) over its nodes there.
  struct Share {
    Index aggregate;
    double weight;
    Vec3 arm;
  };
  const RigidCoarseSpace& space;
  const mesh::Mesh& mesh;
  const mesh::Geometry& geometry;
  const ElasticOperator& rows;
  std::vector<std::int64_t> offset{0};
  std::vector<Share> shares;                                 // of each vertex
  std::vector<std::vector<std::pair<Index, Block>>> blocks;  // of this rank's aggregates: column, value
  Index first_row;

  Assembly(const RigidCoarseSpace& s, const mesh::Mesh& m, const ElasticOperator& r, Index first, int n_here)
      : space(s), mesh(m), geometry(r.geometry()), rows(r), blocks(n_here), first_row(first) {
    for (Index v = 0; v < mesh.points.n_local(); ++v) {
      add_vertex(v);
      offset.push_back(std::ssize(shares));
    }
  }

  void add_vertex(Index v) {
    if (rows.constraints().is_fixed(v)) return;
    const std::size_t first = shares.size();
    const auto nodes = rows.vertices().nodes(v);
    const auto weights = rows.vertices().weights(v);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const bool is_cell = nodes[i] < mesh.cells.n_local();
      const Index face = nodes[i] - mesh.cells.n_local() + mesh.n_interior;
      const Index a = space.aggregate_[is_cell ? nodes[i] : mesh.owner[face]];
      const Vec3& x = is_cell ? geometry.cell_centre[nodes[i]] : geometry.face_centre[face];
      std::size_t s = first;
      while (s < shares.size() && shares[s].aggregate != a) ++s;
      if (s == shares.size()) shares.push_back({a, 0, Vec3::Zero()});
      shares[s].weight += weights[i];
      shares[s].arm += weights[i] * (x - space.centre_[a]);
    }
  }

  bool within_one(Index f) const {
    if (f >= mesh.n_interior) return false;
    const Index a = space.aggregate_[mesh.owner[f]];
    if (space.aggregate_[mesh.neighbour[f]] != a) return false;
    for (const Index v : mesh.face_points[f])
      if (offset[v + 1] - offset[v] != 1 || shares[offset[v]].aggregate != a ||
          rows.constraints().is_constrained(v))
        return false;
    return true;
  }

  /// Adds the force on the face by the modes of each aggregate in its stencil to the rows of its cells.
  void add_face(Index f) {
    const bool on_boundary = f >= mesh.n_interior;
    const fv::FaceLine line = fv::face_line(mesh, geometry, f);
    std::array<Vec3, 4> weights;
    fv::tangential_weights(mesh, geometry.points, f, line, weights.data());
    const auto [mu, lambda] = face_lame(mesh, rows, f);
    const Vec3& n = line.normal;
    const Tensor3 nn = n * n.transpose(), identity = Tensor3::Identity();
    Tensor3 scale = line.area * identity;
    if (on_boundary) scale = scale * rows.at(f).passing;
    const Tensor3 across = scale * (mu * (identity + nn) + lambda * nn) * line.inverse_dn;
    found_.clear();
    add_node(mesh.owner[f], -across);
    if (!on_boundary)
      add_node(mesh.neighbour[f], across);
    else if (!rows.at(f).mirrored && !rows.at(f).fixed)
      add_face_node(f, across);
    for (Index e = mesh.face_points.offset[f]; e < mesh.face_points.offset[f + 1]; ++e) {
      const Index v = mesh.face_points.index[e];
      if (offset[v] == offset[v + 1]) continue;
      const Vec3& c = weights[e - mesh.face_points.offset[f]];
      const double kc = line.skew.dot(c);
      Tensor3 block =
          scale * (mu * (kc * (identity + nn) + c * n.transpose()) + lambda * (kc * nn + n * c.transpose()));
      if (rows.constraints().is_constrained(v)) block = block * rows.constraints().free_part(v);
      for (auto s = offset[v]; s < offset[v + 1]; ++s)
        add(shares[s].aggregate, block, shares[s].weight, shares[s].arm);
    }
    for (const auto& [column, force] : found_) {
      add_row(mesh.owner[f], column, -force);
      if (!on_boundary) add_row(mesh.neighbour[f], column, force);
    }
  }

  void add_inertia(std::span<const double> inertia) {
    for (std::size_t c = 0; c < inertia.size(); ++c) {
      Modes here = Modes::Zero();
      here.leftCols<3>() = inertia[c] * Tensor3::Identity();
      here.rightCols<3>() = -inertia[c] * cross_matrix(space.arm(static_cast<Index>(c)));
      add_row(static_cast<Index>(c), space.aggregate_[c], here);
    }
  }

 private:
  void add_node(Index cell, const Tensor3& block) { add(space.aggregate_[cell], block, 1, space.arm(cell)); }

  // A shared face uses the mean of both sides instead of the true balance.
  void add_face_node(Index f, const Tensor3& across) {
    const Vec3& x = geometry.face_centre[f];
    const auto follow = [&](Index cell, const Tensor3& block, double share) {
      const Index a = space.aggregate_[cell];
      add(a, block, share, share * (x - space.centre_[a]));
    };
    const BoundaryRow& s = rows.at(f);
    if (s.shared) {
      follow(mesh.owner[f], across, 0.5);
      return follow(mesh.owner[mesh.n_interior + mesh.twin[f - mesh.n_interior]], across, 0.5);
    }
    const Tensor3 open = Tensor3::Identity() - s.known;
    follow(mesh.owner[f], (across - geometry.face_area[f].norm() * open * s.spring) * open, 1);
  }

  // Adds block u with u = weight t + spin x arm.
  void add(Index aggregate, const Tensor3& block, double weight, const Vec3& arm) {
    std::size_t i = 0;
    while (i < found_.size() && found_[i].first != aggregate) ++i;
    if (i == found_.size()) found_.push_back({aggregate, Modes::Zero()});
    found_[i].second.leftCols<3>() += weight * block;
    found_[i].second.rightCols<3>() -= block * cross_matrix(arm);
  }

  // Adds force and moment of this row to the modes of the cell's aggregate.
  void add_row(Index cell, Index column, const Modes& force) {
    if (cell >= mesh.cells.n_owned()) return;
    auto& row = blocks[space.aggregate_[cell] - first_row];
    std::size_t i = 0;
    while (i < row.size() && row[i].first != column) ++i;
    if (i == row.size()) row.push_back({column, Block::Zero()});
    row[i].second.topRows<3>() += force;
    row[i].second.bottomRows<3>() += cross_matrix(space.arm(cell)) * force;
  }

  std::vector<std::pair<Index, Modes>> found_;
};

RigidCoarseSpace::RigidCoarseSpace(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                   std::span<const double> inertia, int n_aggregates)
    : mesh_(&mesh), geometry_(&rows.geometry()), rows_(&rows), modes_(mesh.dim == 2 ? 3 : 6) {
  const mesh::Geometry& geometry = rows.geometry();
  const Index n_owned = mesh.cells.n_owned();
  const double share = double(n_aggregates) * n_owned / static_cast<double>(mesh.cells.n_global());
  const int n_here = n_owned == 0 ? 0 : std::clamp<int>(static_cast<int>(std::lround(share)), 1, n_owned);
  number_aggregates(bisect({geometry.cell_centre.data(), std::size_t(n_owned)}, n_here), n_here);
  const auto first = static_cast<Index>(parallel::exclusive_scan(mesh.comm, n_here));

  Assembly assembly(*this, mesh, rows, first, n_here);
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    if (f >= mesh.n_interior && rows.at(f).is_free()) continue;
    if (!assembly.within_one(f)) assembly.add_face(f);
  }
  assembly.add_inertia(inertia);

  // In 2-D the modes are two translations and the rotation about z.
  const std::array<int, 6> mode = modes_ == 6 ? std::array{0, 1, 2, 3, 4, 5} : std::array{0, 1, 5, 0, 0, 0};
  std::vector<Entry> entries;
  for (int a = 0; a < n_here; ++a)
    for (const auto& [column, block] : assembly.blocks[a])
      for (int i = 0; i < modes_; ++i)
        for (int j = 0; j < modes_; ++j)
          entries.push_back({(first + a) * modes_ + i, column * modes_ + j, block(mode[i], mode[j])});
  entries = parallel::all_gather(mesh.comm, entries);
  double largest = 0;
  for (const Entry& e : entries)
    if (e.row == e.column) largest = std::max(largest, std::abs(e.value));
  std::vector<Eigen::Triplet<double>> triplets;
  triplets.reserve(entries.size());
  for (const Entry& e : entries)
    triplets.emplace_back(e.row, e.column,
                          e.row == e.column ? e.value + floor_of_diagonal * largest : e.value);
  const Index n = std::ssize(centre_) * modes_;
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  factors_ = std::make_unique<Eigen::SparseLU<Eigen::SparseMatrix<double>>>();
  factors_->compute(matrix);
}

RigidCoarseSpace::~RigidCoarseSpace() = default;

void RigidCoarseSpace::number_aggregates(std::span<const Index> local, int n_here) {
  const auto first = static_cast<Index>(parallel::exclusive_scan(mesh_->comm, n_here));
  std::vector<Vec3> sum(n_here, Vec3::Zero());
  std::vector<double> count(n_here, 0);
  std::vector<GlobalIndex> global(mesh_->cells.n_local(), 0);
  for (Index c = 0; c < mesh_->cells.n_owned(); ++c) {
    sum[local[c]] += geometry_->cell_centre[c];
    count[local[c]] += 1;
    global[c] = first + local[c];
  }
  for (int a = 0; a < n_here; ++a) sum[a] /= count[a];
  centre_ = parallel::all_gather(mesh_->comm, sum);
  mesh_->cells.update_ghosts(std::span<GlobalIndex>(global));
  aggregate_.assign(global.begin(), global.end());
}

void RigidCoarseSpace::add_correction(std::span<const double> r, std::span<double> z) const {
  const int dim = mesh_->dim;
  Eigen::VectorXd coarse = Eigen::VectorXd::Zero(std::ssize(centre_) * modes_);
  for (Index c = 0; c < mesh_->cells.n_owned(); ++c) {
    double* q = coarse.data() + std::size_t(aggregate_[c]) * modes_;
    const double* here = r.data() + std::size_t(c) * dim;
    const Vec3 x = arm(c);
    for (int a = 0; a < dim; ++a) q[a] += here[a];
    if (dim == 3) {
      q[3] += x[1] * here[2] - x[2] * here[1];
      q[4] += x[2] * here[0] - x[0] * here[2];
    }
    q[modes_ - 1] += x[0] * here[1] - x[1] * here[0];
  }
  MPI_Allreduce(MPI_IN_PLACE, coarse.data(), static_cast<int>(coarse.size()), MPI_DOUBLE, MPI_SUM,
                mesh_->comm);
  coarse = factors_->solve(coarse).eval();
  const auto move = [&](Index aggregate, const Vec3& x, double* u) {
    const double* q = coarse.data() + std::size_t(aggregate) * modes_;
    const double spin = q[modes_ - 1];
    u[0] += q[0] - spin * x[1];
    u[1] += q[1] + spin * x[0];
    if (dim == 2) return;
    u[0] += q[4] * x[2];
    u[1] -= q[3] * x[2];
    u[2] += q[2] + q[3] * x[1] - q[4] * x[0];
  };
  for (Index c = 0; c < mesh_->cells.n_owned(); ++c)
    move(aggregate_[c], arm(c), z.data() + std::size_t(c) * dim);
  const auto& faces = rows_->unknown_faces();
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const Index a = aggregate_[mesh_->owner[faces[i]]];
    Vec3 u = Vec3::Zero();
    move(a, geometry_->face_centre[faces[i]] - centre_[a], u.data());
    u -= (rows_->at(faces[i]).known * u).eval();
    for (int c = 0; c < dim; ++c) z[(std::size_t(mesh_->cells.n_owned()) + i) * dim + c] += u[c];
  }
}

std::vector<Index> bisect(std::span<const Vec3> places, int n_parts) {
  std::vector<Index> order(places.size()), part(places.size());
  std::iota(order.begin(), order.end(), 0);
  struct Piece {
    std::size_t first, last;
    int part, n;
  };
  std::vector<Piece> open{{0, places.size(), 0, n_parts}};
  while (!open.empty()) {
    const Piece piece = open.back();
    open.pop_back();
    if (piece.n <= 1) {
      for (std::size_t i = piece.first; i < piece.last; ++i) part[order[i]] = piece.part;
      continue;
    }
    Vec3 lower = Vec3::Constant(std::numeric_limits<double>::max()), upper = -lower;
    for (std::size_t i = piece.first; i < piece.last; ++i) {
      lower = lower.cwiseMin(places[order[i]]);
      upper = upper.cwiseMax(places[order[i]]);
    }
    int axis = 0;
    (upper - lower).maxCoeff(&axis);
    const int half = piece.n / 2;
    const std::size_t middle = piece.first + (piece.last - piece.first) * half / piece.n;
    std::nth_element(
        order.begin() + piece.first, order.begin() + middle, order.begin() + piece.last,
        [&](Index a, Index b) { return std::pair(places[a][axis], a) < std::pair(places[b][axis], b); });
    open.push_back({piece.first, middle, piece.part, half});
    open.push_back({middle, piece.last, piece.part + half, piece.n - half});
  }
  return part;
}

}  // namespace couplet::elastic
