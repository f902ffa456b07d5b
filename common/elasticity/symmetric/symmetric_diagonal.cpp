// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/symmetric/symmetric_diagonal.hpp"

#include "common/elasticity/elastic_nodes.hpp"
#include "common/elasticity/symmetric/symmetric_faces.hpp"

namespace couplet::elastic {
namespace {

// Block entries are xx, yy, zz, then xy, yz, xz.
constexpr int block_size = 6, diagonal_size = 3;

class Sum {
 public:
  Sum(const mesh::Mesh& mesh, const ElasticOperator& rows, VolumeStrain without)
      : mesh_(mesh),
        rows_(rows),
        without_(without),
        gradient_(std::size_t(n_node_places(mesh)), Vec3::Zero()),
        cells_(std::size_t(mesh.cells.n_local()) * diagonal_size, 0),
        boundary_(std::size_t(mesh.boundary.n_local()) * block_size, 0) {}

  void add_face(Index f);
  SymmetricDiagonal finish();

 private:
  void add(Index node, const Vec3& b) {
    if (gradient_[node].isZero(0)) nodes_.push_back(node);
    gradient_[node] += b;
  }
  void add_vertex(Index v, const Vec3& c) {
    if (rows_.constraints().is_fixed(v)) return;
    const auto nodes = rows_.vertices().nodes(v);
    const auto weights = rows_.vertices().weights(v);
    for (std::size_t i = 0; i < nodes.size(); ++i) add(nodes[i], weights[i] * c);
  }
  void add_squares(double volume, const LameConstants& lame);

  const mesh::Mesh& mesh_;
  const ElasticOperator& rows_;
  VolumeStrain without_;
  std::vector<Vec3> gradient_;  // of each local node: G = sum u b^T on the current face
  std::vector<Index> nodes_;    // nodes with nonzero gradient_
  std::vector<double> cells_, boundary_;
};

void Sum::add_face(Index f) {
  const FaceRows face = symmetric_rows(mesh_, rows_, f);
  const Index first_point = n_node_places(mesh_);
  const bool mirrored = rows_.mirrored(f);
  for (const FaceRows::Row& row : face.all())
    if (row.place >= first_point)
      add_vertex(row.place - first_point, row.b);
    else if (!mirrored)
      add(row.place, row.b);
  if (mirrored) {
    // The mirror image moves like the cell except across the plane: G = -2 n (n . u) s^T.
    const LameConstants lame = part_of_faces(rows_.lame(mesh_.owner[f]), without_);
    const Vec3& s = face.row[1].b;
    for (int a = 0; a < 3; ++a)
      cells_[std::size_t(mesh_.owner[f]) * diagonal_size + a] +=
          4 * face.volume * (lame.lambda + 2 * lame.mu) * s[a] * s[a];
  }
  add_squares(face.volume, part_of_faces(face_lame(mesh_, rows_, f), without_));
}

/// Adds V [(lambda + mu) b b^T + mu b.b I] of each node.
void Sum::add_squares(double volume, const LameConstants& lame) {
  const double mu = volume * lame.mu, both = volume * (lame.lambda + lame.mu);
  for (const Index node : nodes_) {
    const Vec3 b = gradient_[node];
    gradient_[node].setZero();
    const double even = mu * b.squaredNorm();
    const bool is_cell = node < mesh_.cells.n_local();
    double* to = is_cell ? cells_.data() + std::size_t(node) * diagonal_size
                         : boundary_.data() + std::size_t(node - mesh_.cells.n_local()) * block_size;
    for (int a = 0; a < 3; ++a) to[a] += even + both * b[a] * b[a];
    if (is_cell) continue;
    for (int a = 0; a < 3; ++a) to[3 + a] += both * b[a == 1 ? 1 : 0] * b[a == 0 ? 1 : 2];
  }
  nodes_.clear();
}

SymmetricDiagonal Sum::finish() {
  mesh_.cells.add_to_owners(cells_, diagonal_size);
  mesh_.boundary.add_to_owners(boundary_, block_size);
  mesh_.boundary.update_ghosts(boundary_, block_size);  // other sides of bonded faces
  SymmetricDiagonal result;
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
    for (int a = 0; a < mesh_.dim; ++a) result.cells.push_back(cells_[std::size_t(c) * diagonal_size + a]);
  for (const Index f : rows_.unknown_faces()) {
    const auto block_of = [&](Index b) {
      const double* v = boundary_.data() + std::size_t(b) * block_size;
      Tensor3 block;
      block << v[0], v[3], v[5], v[3], v[1], v[4], v[5], v[4], v[2];
      return block;
    };
    const Index b = f - mesh_.n_interior;
    result.faces.push_back(block_of(b));
    if (rows_.at(f).shared) result.faces.back() += block_of(mesh_.twin[b]);
  }
  return result;
}

}  // namespace

SymmetricDiagonal symmetric_diagonal(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                     VolumeStrain without) {
  Sum sum(mesh, rows, without);
  for (Index f = 0; f < mesh.n_flux_faces(); ++f)
    if (mesh.owner[f] < mesh.cells.n_owned()) sum.add_face(f);  // otherwise another rank adds it
  return sum.finish();
}

}  // namespace couplet::elastic
