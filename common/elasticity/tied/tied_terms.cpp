// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/tied/tied_terms.hpp"

#include "common/parallel/collective.hpp"

namespace couplet::elastic {
namespace {

void take(std::vector<TiedTerm>& terms, GlobalIndex block, const Vec3& b, const Tensor3& turn) {
  if (block < 0) return;  // known
  for (TiedTerm& t : terms)
    if (t.block == block && t.turn == turn) {
      t.b += b;
      return;
    }
  terms.push_back({block, b, turn});
}

Index node_of(const mesh::Mesh& mesh, Index f) { return mesh.cells.n_local() + f - mesh.n_interior; }

/// What of a boundary face's node is not known.
Tensor3 open_part(const ElasticOperator& rows, Index f) { return Tensor3::Identity() - rows.at(f).known; }

template <int D>
std::vector<TiedTerm> terms_of(const mesh::Mesh& mesh, const ElasticOperator& rows,
                               const TiedUnknowns& unknowns, Index f) {
  const mesh::Geometry& geometry = rows.geometry();
  const SymmetricFace<D> face = symmetric_face<D>(mesh, rows, f);
  const auto scaled = [&](const std::array<double, D>& from) {
    Vec3 b = Vec3::Zero();
    for (int a = 0; a < D; ++a) b[a] = from[a] * face.inverse;
    return b;
  };
  std::vector<TiedTerm> terms;
  const Vec3 s = scaled(face.area);
  const Tensor3 identity = Tensor3::Identity();
  take(terms, unknowns.node(mesh.owner[f]), -s, identity);
  if (f < mesh.n_interior) {
    take(terms, unknowns.node(mesh.neighbour[f]), s, identity);
  } else if (rows.mirrored(f)) {
    const Vec3 n = geometry.face_area[f].normalized();
    take(terms, unknowns.node(mesh.owner[f]), s, identity - 2 * n * n.transpose());
  } else {
    take(terms, unknowns.node(node_of(mesh, f)), s, open_part(rows, f));
  }
  for (int i = 0; i < D - 1; ++i) {
    take(terms, unknowns.point(face.plus[i]), scaled(face.across[i]), identity);
    take(terms, unknowns.point(face.minus[i]), -scaled(face.across[i]), identity);
  }
  return terms;
}

/// A term on its way to the rank that owns the edge.
struct Sent {
  GlobalIndex edge, block;
  double b[3], turn[9];
};

}  // namespace

std::vector<TiedTerm> face_terms(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                 const TiedUnknowns& unknowns, Index f) {
  return mesh.dim == 2 ? terms_of<2>(mesh, rows, unknowns, f) : terms_of<3>(mesh, rows, unknowns, f);
}

std::vector<TiedTerm> mean_terms(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                 const TiedUnknowns& unknowns, Index f) {
  const mesh::Geometry& geometry = rows.geometry();
  const double of_node = 1.0 / mesh.dim;
  std::vector<TiedTerm> terms;
  take(terms, unknowns.node(node_of(mesh, f)), Vec3(of_node, 0, 0), open_part(rows, f));
  const auto shares = point_shares(mesh, geometry, f);
  const auto points = mesh.face_points[f];
  for (std::size_t i = 0; i < points.size(); ++i)
    take(terms, unknowns.point(points[i]), Vec3((1 - of_node) * shares[i], 0, 0), Tensor3::Identity());
  return terms;
}

std::vector<std::vector<TiedTerm>> edge_terms(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                              const TiedUnknowns& unknowns, const SharedFaces& shared,
                                              const SharedEdges& edges) {
  std::vector<std::vector<TiedTerm>> result(edges.n_edges());
  for (std::size_t i = 0; i < shared.n_mine; ++i) {
    const std::vector<TiedTerm> of_face = face_terms(mesh, rows, unknowns, shared.faces[i]);
    for (const Index e : edges.edges_of(i)) {
      const double part = SharedEdges::share * shared.volume[i] / 3 / edges.volume(e);
      for (const TiedTerm& t : of_face) take(result[std::size_t(e)], t.block, part * t.b, t.turn);
    }
  }
  std::vector<Sent> away;
  for (Index e = 0; e < Index(edges.n_edges()); ++e) {
    if (edges.is_owned(e)) continue;
    for (const TiedTerm& t : result[std::size_t(e)]) {
      Sent& s = away.emplace_back(Sent{edges.global(e), t.block, {}, {}});
      for (int a = 0; a < 3; ++a) s.b[a] = t.b[a];
      for (int a = 0; a < 9; ++a) s.turn[a] = t.turn(a / 3, a % 3);
    }
    result[std::size_t(e)].clear();
  }
  for (const Sent& s : parallel::all_gather(mesh.comm, away)) {
    const Index e = edges.owned_of(s.edge);
    if (e < 0) continue;
    Tensor3 turn;
    for (int a = 0; a < 9; ++a) turn(a / 3, a % 3) = s.turn[a];
    take(result[std::size_t(e)], s.block, Vec3(s.b[0], s.b[1], s.b[2]), turn);
  }
  // On a symmetry plane the mean holds the mirror images, too.
  for (const auto& [e, n] : edges.mirrors()) {
    std::vector<TiedTerm>& terms = result[std::size_t(e)];
    const Tensor3 mirror = Tensor3::Identity() - 2 * n * n.transpose();
    const std::size_t before = terms.size();
    for (std::size_t i = 0; i < before; ++i) {
      terms[i].b *= 0.5;
      terms.push_back({terms[i].block, mirror * terms[i].b, mirror * terms[i].turn});
    }
  }
  return result;
}

}  // namespace couplet::elastic
