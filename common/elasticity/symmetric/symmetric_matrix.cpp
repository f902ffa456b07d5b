// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/symmetric/symmetric_matrix.hpp"

#include <algorithm>
#include <cmath>

#include "common/elasticity/elastic_nodes.hpp"
#include "common/elasticity/symmetric/face_groups.hpp"
#include "common/elasticity/symmetric/symmetric_faces.hpp"
#include "common/elasticity/symmetric/symmetric_space.hpp"
#include "common/fv/vertex_interpolation.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::elastic {
namespace {

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
  GradientStiffness c;
  for (std::size_t i = 0; i < 81; ++i)
    c(int(i / 9), int(i % 9)) = matrix(SharedEdges::of_strain[i / 9], SharedEdges::of_strain[i % 9]);
  return c;
}

/// I (x) sigma: work of an initial stress on the square of the displacement gradient.
GradientStiffness stiffness_of_stress(const Tensor3& stress) {
  GradientStiffness c = GradientStiffness::Zero();
  for (int k = 0; k < 3; ++k) c.block<3, 3>(3 * k, 3 * k) = stress;
  return c;
}

/// Term sent to the rank that owns the edge.
struct Sent {
  GlobalIndex edge, block;
  double b[3], turn[9];
};

/// Mean gradients of the owned edges, one list per edge (empty for another rank's). Collective.
std::vector<FaceTermList> edge_terms(const mesh::Mesh& mesh, FaceTerms& terms, const SharedFaces& shared,
                                     const SharedEdges& edges) {
  std::vector<FaceTermList> result(edges.n_edges());
  for (std::size_t i = 0; i < shared.n_mine; ++i) {
    const FaceTermList& of_face = terms.of_face(shared.faces[i]);
    for (const Index e : edges.edges_of(i)) {
      const double part = shared.part[i] / edges.volume(e);
      for (const FaceTerm& t : of_face) add_term(result[std::size_t(e)], {t.block, part * t.b, t.turn});
    }
  }
  std::vector<Sent> away;
  for (Index e = 0; e < Index(edges.n_edges()); ++e) {
    if (edges.is_owned(e)) continue;
    for (const FaceTerm& t : result[std::size_t(e)]) {
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
    add_term(result[std::size_t(e)], {s.block, Vec3(s.b[0], s.b[1], s.b[2]), turn});
  }
  // On a symmetry plane the mean includes the mirror images.
  for (const auto& [e, n] : edges.mirrors()) {
    FaceTermList& of_edge = result[std::size_t(e)];
    const Tensor3 mirror = Tensor3::Identity() - 2 * n * n.transpose();
    const std::size_t before = of_edge.size();
    for (std::size_t i = 0; i < before; ++i) {
      of_edge[i].b *= 0.5;
      of_edge.push_back({of_edge[i].block, mirror * of_edge[i].b, mirror * of_edge[i].turn});
    }
  }
  return result;
}

}  // namespace

Assembly::Assembly(const mesh::Mesh& mesh, const ElasticOperator& rows, const Numbering& number)
    : mesh_(mesh), geometry_(rows.geometry()), rows_(rows), number_(number), terms_(mesh, rows, number) {
  if (!number.point.empty()) slot_of_.reserve(std::size_t(mesh.n_flux_faces()) * (mesh.dim == 2 ? 8 : 40));
}

void Assembly::add(GlobalIndex i, GlobalIndex j, const Tensor3& block) {
  const auto [at, is_new] = slot_of_.try_emplace(std::uint64_t(i) << 32 | std::uint32_t(j), pairs_.size());
  if (is_new) {
    pairs_.push_back({i, j});
    blocks_.push_back(block);
  } else {
    blocks_[at->second] += block;
  }
}

void Assembly::add(const FaceTermList& terms, const GradientStiffness& stiffness) {
  const auto ends = [&](std::size_t i) {
    return i + 1 == terms.size() || terms[i + 1].block != terms[i].block;
  };
  using Left = Eigen::Matrix<double, 3, 9>;
  Left left = Left::Zero();
  for (std::size_t i = 0; i < terms.size(); ++i) {
    Left here;
    for (int k = 0; k < 3; ++k) here.row(k) = terms[i].b.transpose() * stiffness.middleRows<3>(3 * k);
    left += terms[i].turn.transpose() * here;
    if (!ends(i)) continue;
    Tensor3 block = Tensor3::Zero();
    for (std::size_t j = 0; j < terms.size(); ++j) {
      Tensor3 part;
      for (int m = 0; m < 3; ++m) part.col(m) = left.middleCols<3>(3 * m) * terms[j].b;
      block += part * terms[j].turn;
      if (!ends(j)) continue;
      add(terms[i].block, terms[j].block, block);
      block.setZero();
    }
    left.setZero();
  }
}

void Assembly::add_faces(const EnergyParts& parts, bool shares) {
  const SharedFaces shared = shares ? shared_faces(mesh_, rows_) : SharedFaces{};
  std::size_t next = 0;
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
    if (mesh_.owner[f] >= mesh_.cells.n_owned()) continue;  // its owner's rank adds it
    const FaceRows face = face_rows(mesh_, rows_, f);
    GradientStiffness c = GradientStiffness::Zero();
    if (parts.stiffness != 0)
      c = parts.stiffness *
          (rows_.is_anisotropic()
               ? stiffness_of(face_matrix(mesh_, rows_, f))
               : stiffness_of(part_of_faces(face_lame(mesh_, rows_, f), rows_.volume_strain())));
    if (parts.stress != 0) c += parts.stress * stiffness_of_stress(parts.prestress->stress[std::size_t(f)]);
    const double own = next < shared.n_mine && shared.faces[next] == f ? 1 - shared.share[next++] : 1;
    add(terms_.of_face(face), own * face.volume * c);
  }
}

void Assembly::add_edges(const EnergyParts& parts) {
  const SharedFaces shared = shared_faces(mesh_, rows_);
  if (!parallel::any(mesh_.comm, shared.n_mine > 0)) return;
  SharedEdges edges(mesh_, rows_, shared);
  if (parts.stress != 0) find_edge_stresses(shared, parts.prestress->stress, edges);
  const std::vector<FaceTermList> terms = edge_terms(mesh_, terms_, shared, edges);
  for (Index e = 0; e < Index(edges.n_edges()); ++e) {
    if (terms[std::size_t(e)].empty()) continue;
    GradientStiffness c = GradientStiffness::Zero();
    if (parts.stiffness != 0)
      c = parts.stiffness *
          (rows_.is_anisotropic() ? stiffness_of(edges.matrix(e)) : stiffness_of(edges.lame(e)));
    if (parts.stress != 0) c += parts.stress * stiffness_of_stress(edge_tensor(edges, e));
    add(terms[std::size_t(e)], edges.volume(e) * c);
  }
}

void Assembly::add_volumes(const EnergyParts& parts) {
  if (!rows_.volume_by_cells() || parts.stiffness == 0) return;
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f)
    add_volume_terms(f, terms_.of_face(f), Tensor3::Identity());
  const std::vector<double> volume = pyramid_volumes(mesh_, geometry_);
  finish_volumes([&](Index c) {
    return parts.stiffness * bulk_of_cells(rows_.lame(c), rows_.volume_strain()) / volume[std::size_t(c)];
  });
}

void Assembly::add_volume_terms(Index f, const FaceTermList& terms, const Tensor3& cofactors) {
  const auto [here, there] = pyramids(mesh_, geometry_, f);
  const auto take = [&](Index cell, GlobalIndex block, const Vec3& g) {
    if (cell < mesh_.cells.n_owned()) volume_of_[cell].push_back({block, g});
  };
  for (const FaceTerm& t : terms) {
    const Vec3 g = t.turn.transpose() * (cofactors * t.b);
    take(mesh_.owner[f], t.block, here * g);
    if (f < mesh_.n_interior) take(mesh_.neighbour[f], t.block, there * g);
  }
}

/// Adds squares of terms. A block may occur several times.
void Assembly::add_squares(VolumeTerms& terms, double modulus) {
  std::ranges::sort(terms, {}, &VolumeTerms::value_type::first);
  VolumeTerms merged;
  for (const auto& t : terms)
    if (!merged.empty() && merged.back().first == t.first)
      merged.back().second += t.second;
    else
      merged.push_back(t);
  for (const auto& [i, g] : merged)
    for (const auto& [j, h] : merged) add(i, j, modulus * g * h.transpose());
}

Tensor3 Assembly::open_part(Index node) const {
  if (node < mesh_.cells.n_local()) return Tensor3::Identity();
  return Tensor3::Identity() - rows_.at(node - mesh_.cells.n_local() + mesh_.n_interior).known;
}

void Assembly::add_supports() {
  for (const Index f : rows_.known_faces()) {
    const BoundaryRow& s = rows_.at(f);
    if (s.fixed) continue;
    const LameConstants lame = rows_.lame(mesh_.owner[f]);
    const fv::FaceLine line = fv::face_line(mesh_, geometry_, f);
    const GlobalIndex node = number_.node[node_of(f)];
    add(node, node, (2 * lame.mu + lame.lambda) * line.area * line.inverse_dn * s.known);
    if (s.spring.isZero(0)) continue;
    const Tensor3 open = Tensor3::Identity() - s.known,
                  spring = geometry_.face_area[f].norm() * (open * s.spring * open);
    add_mean(terms_.of_mean(f), spring);
  }
}

void Assembly::add_mass(double factor, std::span<const double> density) {
  SymmetricSpace space(mesh_, rows_);
  space.set_density(density);
  for (Index i = 0; i < Index(number_.node.size()); ++i) {
    const double mass = factor * space.mass()[std::size_t(i)];
    if (number_.node[i] >= 0 && mass != 0) add(number_.node[i], number_.node[i], mass * open_part(i));
  }
  for (Index v = 0; v < mesh_.points.n_local(); ++v) {
    const double mass = factor * space.mass()[std::size_t(space.place_of_point(v))];
    if (mass != 0) add_mean(terms_.of_point(v), mass * Tensor3::Identity());
  }
}

/// Adds the stiffness of a displacement that is a sum of terms.
void Assembly::add_mean(const FaceTermList& terms, const Tensor3& stiffness) {
  for (const FaceTerm& i : terms)
    for (const FaceTerm& j : terms)
      add(i.block, j.block, i.b[0] * j.b[0] * (i.turn.transpose() * stiffness * j.turn));
}

void Assembly::add_diagonals(std::span<const double> of_nodes) {
  const Index n_cells = mesh_.cells.n_owned();
  for (std::size_t i = 0; i < of_nodes.size(); ++i) {
    const bool is_cell = Index(i) < n_cells;
    const Index node = is_cell ? Index(i) : node_of(rows_.unknown_faces()[i - std::size_t(n_cells)]);
    add(number_.node[node], number_.node[node], of_nodes[i] * Tensor3::Identity());
  }
}

void Assembly::add_places(double factor, std::span<const PlaceBlock> blocks) {
  const Index n_nodes = n_node_places(mesh_);
  const auto number = [&](Index place) {
    return place < n_nodes ? number_.node[place] : number_.point[place - n_nodes];
  };
  const auto open = [&](Index place) {
    return place < n_nodes ? open_part(place) : Tensor3(Tensor3::Identity());
  };
  for (const PlaceBlock& b : blocks)
    if (number(b.i) >= 0 && number(b.j) >= 0)
      add(number(b.i), number(b.j), factor * (open(b.i) * b.block * open(b.j)));
}

double Assembly::mean_diagonal() const {
  double total = 0, count = 0;
  for (std::size_t k = 0; k < pairs_.size(); ++k)
    if (pairs_[k].first == pairs_[k].second) total += std::abs(blocks_[k](0, 0)), count += 1;
  return parallel::sum(mesh_.comm, total) / std::max(1.0, parallel::sum(mesh_.comm, count));
}

linalg::SparseMatrix Assembly::matrix(std::size_t n_blocks) const {
  const int dim = mesh_.dim;
  std::vector<GlobalIndex> row, column;
  std::vector<double> value;
  for (auto* list : {&row, &column}) list->reserve(pairs_.size() * std::size_t(dim * dim));
  value.reserve(pairs_.size() * std::size_t(dim * dim));
  for (std::size_t k = 0; k < pairs_.size(); ++k)
    for (int a = 0; a < dim; ++a)
      for (int b = 0; b < dim; ++b) {
        row.push_back(pairs_[k].first * dim + a);
        column.push_back(pairs_[k].second * dim + b);
        value.push_back(blocks_[k](a, b));
      }
  linalg::SparseMatrix result(mesh_.comm, GlobalIndex(n_blocks) * dim, std::move(row), std::move(column),
                              dim);
  result.fill(value);
  return result;
}

linalg::SparseMatrix symmetric_matrix(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                      std::span<const double> inertia) {
  const Numbering number{fv::number_nodes(mesh, rows.unknown_faces()), {}};
  Assembly assembly(mesh, rows, number);
  assembly.add_faces({}, false);
  assembly.add_volumes({});
  assembly.add_supports();
  if (!inertia.empty()) assembly.add_mass(1, inertia);
  return assembly.matrix(rows.n_unknowns() / std::size_t(mesh.dim));
}

namespace {

// Block entries are xx, yy, zz, then xy, yz, xz.
constexpr int block_size = 6, diagonal_size = 3;

class MatrixSum {
 public:
  MatrixSum(const mesh::Mesh& mesh, const ElasticOperator& rows, VolumeStrain without)
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

void MatrixSum::add_face(Index f) {
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
void MatrixSum::add_squares(double volume, const LameConstants& lame) {
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

SymmetricDiagonal MatrixSum::finish() {
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
  MatrixSum sum(mesh, rows, without);
  for (Index f = 0; f < mesh.n_flux_faces(); ++f)
    if (mesh.owner[f] < mesh.cells.n_owned()) sum.add_face(f);  // otherwise another rank adds it
  return sum.finish();
}

bool TiedMatrix::suits(const mesh::Mesh& mesh) {
  return !parallel::any(mesh.comm, !mesh.neighbour_shift.empty());
}

TiedMatrix::TiedMatrix(const mesh::Mesh& mesh, const ElasticOperator& rows, const EnergyParts& parts)
    : mesh_(mesh),
      rows_(rows),
      n_nodes_(std::size_t(mesh.cells.n_owned()) + rows.unknown_faces().size()),
      matrix_(assemble(parts)) {
  const std::size_t n = (n_nodes_ + 2 * points_.size()) * std::size_t(mesh.dim);
  from_.resize(n);
  to_.resize(n);
  n_ties_ = parallel::sum(mesh.comm, GlobalIndex(points_.size()) * mesh.dim);
}

/// Numbers nodes, points and multipliers. Collective.
void TiedMatrix::number_all() {
  for (Index v = 0; v < mesh_.points.n_owned(); ++v)
    if (!rows_.constraints().is_fixed(v) && !rows_.vertices().nodes(v).empty()) points_.push_back(v);
  number_ = {fv::number_nodes(mesh_, rows_.unknown_faces()),
             std::vector<GlobalIndex>(std::size_t(mesh_.points.n_local()), -1)};
  // Points and multipliers of lower ranks shift the node numbers of each rank.
  struct Rank {
    GlobalIndex first_node, shift;
  };
  const auto n_points = GlobalIndex(points_.size());
  const Rank here{parallel::exclusive_scan(mesh_.comm, GlobalIndex(n_nodes_)),
                  2 * parallel::exclusive_scan(mesh_.comm, n_points)};
  const std::vector<Rank> ranks = parallel::all_gather(mesh_.comm, std::vector<Rank>{here});
  for (GlobalIndex& n : number_.node) {
    if (n < 0) continue;
    const auto after = std::ranges::upper_bound(ranks, n, {}, &Rank::first_node);
    n += std::prev(after)->shift;
  }
  const GlobalIndex first_point = here.first_node + here.shift + GlobalIndex(n_nodes_);
  for (std::size_t i = 0; i < points_.size(); ++i)
    number_.point[std::size_t(points_[i])] = first_point + GlobalIndex(i);
  mesh_.points.update_ghosts(std::span<GlobalIndex>(number_.point));
  first_multiplier_ = first_point + n_points;
}

/// Adds the ties u_V = F_V sum_i w_i u_i, times `tie_`.
void TiedMatrix::add_ties(Assembly& assembly) const {
  const auto both = [&](GlobalIndex i, GlobalIndex j, const Tensor3& block) {
    assembly.add(i, j, block);
    assembly.add(j, i, block.transpose());
  };
  const Numbering of_nodes{number_.node, {}};
  FaceTerms means(mesh_, rows_, of_nodes);
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const GlobalIndex multiplier = first_multiplier_ + GlobalIndex(k);
    both(multiplier, number_.point[points_[k]], tie_ * Tensor3::Identity());
    for (const FaceTerm& t : means.of_point(points_[k])) both(multiplier, t.block, -tie_ * t.b[0] * t.turn);
  }
}

linalg::SparseMatrix TiedMatrix::assemble(const EnergyParts& parts) {
  number_all();
  Assembly assembly(mesh_, rows_, number_);
  assembly.add_faces(parts, true);
  assembly.add_edges(parts);
  assembly.add_volumes(parts);
  if (parts.stiffness != 0) assembly.add_supports();
  if (parts.stress != 0) assembly.add_places(parts.stress, parts.prestress->loads);
  if (parts.mass != 0) assembly.add_mass(parts.mass, parts.density);
  tie_ = assembly.mean_diagonal();
  add_ties(assembly);
  return assembly.matrix(n_nodes_ + 2 * points_.size());
}

/// Multiplies by A. The ties give the vertices, and their transpose returns the forces.
void TiedMatrix::apply(std::span<const double> x, std::span<double> y) {
  const std::size_t dim = std::size_t(mesh_.dim), n = n_nodes_ * dim, m = points_.size() * dim;
  std::ranges::fill(from_, 0);
  std::ranges::copy(x, from_.begin());
  matrix_.multiply(from_, to_);
  for (std::size_t i = 0; i < m; ++i) from_[n + i] = -to_[n + m + i] / tie_;
  matrix_.multiply(from_, to_);
  std::ranges::copy(std::span(to_).first(n), y.begin());
  std::ranges::fill(from_, 0);
  for (std::size_t i = 0; i < m; ++i) from_[n + m + i] = -to_[n + i] / tie_;
  matrix_.multiply(from_, to_);
  for (std::size_t i = 0; i < n; ++i) y[i] += to_[i];
}

void TiedMatrix::factorise() { factors_ = std::make_unique<linalg::SymmetricFactors>(matrix_); }

void TiedMatrix::solve(std::span<const double> x, std::span<double> y) {
  std::ranges::fill(from_, 0);
  std::ranges::copy(x, from_.begin());
  factors_->solve(from_, to_);
  std::ranges::copy(std::span(to_).first(y.size()), y.begin());
}

}  // namespace couplet::elastic
