// SPDX-License-Identifier: Apache-2.0

#include "common/elasticity/symmetric/face_groups.hpp"

#include <algorithm>
#include <map>
#include <tuple>

#include "common/elasticity/elastic_nodes.hpp"
#include "common/elasticity/symmetric/symmetric_faces.hpp"
#include "common/mesh/periodic_points.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::elastic {

/// Identifies an edge on every rank, together with the rank that owns it.
struct SharedEdges::EdgeKey {
  GlobalIndex material, a, b;
  int rank = 0;
  Index local = -1;
  auto same() const { return std::tuple(material, a, b); }
};

namespace {

/// Names of points in the keys of edges. On periodic patches all copies have one name.
std::vector<GlobalIndex> names_of_points(const mesh::Mesh& mesh, const mesh::Geometry& geometry) {
  std::vector<GlobalIndex> names = mesh.point_id;
  const mesh::PeriodicPoints periodic(mesh, geometry);
  for (std::size_t i = 0; i < periodic.points().size(); ++i)
    names[periodic.points()[i]] = -1 - GlobalIndex(periodic.group(i));
  return names;
}

}  // namespace

SharedEdges::SharedEdges(const mesh::Mesh& mesh, const ElasticOperator& rows, const SharedFaces& shared)
    : edges_of_(shared.faces.size()),
      parallel_(parallel::comm_size(mesh.comm) > 1),
      names_(names_of_points(mesh, rows.geometry())) {
  number(mesh, shared.faces);
  const std::size_t n = end_points_.size();
  value_.assign(n * stride, 0);
  std::vector<double> sums(n * 3, 0);  // V_E, and mu and lambda times volume
  for (std::size_t i = 0; i < shared.n_mine; ++i) {
    const LameConstants whole = face_lame(mesh, rows, shared.faces[i]);
    const LameConstants lame = part_of_faces(whole, rows.volume_strain());
    const double part = shared.part[i];
    for (const Index e : edges_of_[i]) {
      sums[std::size_t(e) * 3] += part;
      sums[std::size_t(e) * 3 + 1] += part * lame.mu;
      sums[std::size_t(e) * 3 + 2] += part * lame.lambda;
    }
  }
  if (parallel_) {
    map_.add_to_owners(sums, 3);
    map_.update_ghosts(sums, 3);
  }
  for (std::size_t e = 0; e < n; ++e) {
    inverse_volume_.push_back(1 / sums[3 * e]);
    if (!rows.is_uniform())
      lame_.push_back({sums[3 * e + 1] * inverse_volume_[e], sums[3 * e + 2] * inverse_volume_[e]});
  }
  if (rows.is_uniform()) lame_.push_back(part_of_faces(rows.lame(0), rows.volume_strain()));
  if (rows.is_anisotropic()) find_matrices(mesh, rows, shared);
  find_mirrors(mesh, rows);
  end_points_ = {};
  names_ = {};
}

/// Averages the matrices of the faces by volume.
void SharedEdges::find_matrices(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                const SharedFaces& shared) {
  constexpr int entries = 36;
  std::vector<double> sums(inverse_volume_.size() * entries, 0);
  for (std::size_t i = 0; i < shared.n_mine; ++i) {
    const ElasticMatrix part = shared.part[i] * face_matrix(mesh, rows, shared.faces[i]);
    for (const Index e : edges_of_[i])
      for (int k = 0; k < entries; ++k) sums[std::size_t(e) * entries + k] += part.data()[k];
  }
  if (parallel_) {
    map_.add_to_owners(sums, entries);
    map_.update_ghosts(sums, entries);
  }
  for (std::size_t e = 0; e < inverse_volume_.size(); ++e)
    matrix_.push_back(inverse_volume_[e] * Eigen::Map<const ElasticMatrix>(sums.data() + e * entries));
}

/// Numbers the edges locally, owned ones first. The owner is the smallest rank that has the edge.
void SharedEdges::number(const mesh::Mesh& mesh, std::span<const Index> faces) {
  std::vector<std::uint8_t> is_near(mesh.points.n_local(), 0);  // may be known to other ranks
  for (Index c = mesh.cells.n_owned(); c < mesh.cells.n_local(); ++c)
    for (const Index v : mesh.cell_points[c]) is_near[v] = 1;
  for (std::size_t v = 0; v < names_.size(); ++v)
    if (names_[v] < 0) is_near[v] = 1;
  std::map<std::tuple<GlobalIndex, GlobalIndex, GlobalIndex>, Index> found;
  const int rank = parallel::comm_rank(mesh.comm);
  const auto key_of = [&](Index f, std::size_t i) {
    const auto p = mesh.face_points[f];
    const GlobalIndex a = names_[p[i]], b = names_[p[(i + 1) % 3]];
    return EdgeKey{mesh.material_of(mesh.owner[f]), std::min(a, b), std::max(a, b), rank, -1};
  };
  std::vector<EdgeKey> mine;
  for (const Index f : faces)
    for (std::size_t i = 0; i < 3; ++i) {
      const EdgeKey key = key_of(f, i);
      if (!found.emplace(key.same(), -1).second || !parallel_) continue;
      const auto p = mesh.face_points[f];
      if (is_near[p[i]] && is_near[p[(i + 1) % 3]]) mine.push_back(key);
    }
  std::map<std::tuple<GlobalIndex, GlobalIndex, GlobalIndex>, int> owner;
  if (parallel_) {
    for (const EdgeKey& k : parallel::all_gather(mesh.comm, mine)) {
      const auto [at, is_new] = owner.emplace(k.same(), k.rank);
      if (!is_new) at->second = std::min(at->second, k.rank);
    }
  }
  const auto owner_of = [&](const auto& key) {
    const auto at = owner.find(key);
    return at == owner.end() ? rank : at->second;
  };
  Index next = 0;
  for (auto& [key, local] : found)
    if (owner_of(key) == rank) local = next++;
  const Index n_owned = next;
  for (auto& [key, local] : found)
    if (local < 0) local = next++;
  end_points_.resize(next);
  for (const auto& [key, local] : found) end_points_[local] = {std::get<1>(key), std::get<2>(key)};
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) edges_of_[i][k] = found.at(key_of(faces[i], k).same());
  if (!parallel_) return;
  // Positions at the owners.
  std::erase_if(mine, [&](const EdgeKey& k) { return owner_of(k.same()) != rank; });
  for (EdgeKey& k : mine) k.local = found.at(k.same());
  std::map<std::tuple<GlobalIndex, GlobalIndex, GlobalIndex>, Index> remote;
  for (const EdgeKey& k : parallel::all_gather(mesh.comm, mine)) remote[k.same()] = k.local;
  std::vector<int> ghost_owner(next - n_owned);
  std::vector<Index> ghost_remote(next - n_owned);
  for (const auto& [key, local] : found) {
    if (local < n_owned) continue;
    ghost_owner[local - n_owned] = owner.at(key);
    ghost_remote[local - n_owned] = remote.at(key);
  }
  map_ = parallel::IndexMap(mesh.comm, n_owned, ghost_owner, ghost_remote);
}

void SharedEdges::find_mirrors(const mesh::Mesh& mesh, const ElasticOperator& rows) {
  const mesh::Geometry& geometry = rows.geometry();
  // Symmetry faces of ghosts are included, because an edge of the plane may have its faces on another rank.
  std::map<std::array<GlobalIndex, 2>, std::vector<Index>> by_ends;
  for (std::size_t e = 0; e < end_points_.size(); ++e)
    by_ends[end_points_[e]].push_back(static_cast<Index>(e));
  std::map<Index, std::vector<Vec3>> normals;
  for (Index f = mesh.n_interior; f < mesh.n_faces(); ++f) {
    if (!rows.mirrored(f)) continue;
    const Vec3 n = geometry.face_area[f].normalized();
    const auto p = mesh.face_points[f];
    for (std::size_t i = 0; i < p.size(); ++i) {
      const GlobalIndex a = names_[p[i]], b = names_[p[(i + 1) % p.size()]];
      const auto at = by_ends.find({std::min(a, b), std::max(a, b)});
      if (at == by_ends.end()) continue;
      for (const Index e : at->second) {
        auto& known = normals[e];
        const auto same = [&](const Vec3& other) { return std::abs(other.dot(n)) > 0.9994; };
        if (std::ranges::none_of(known, same)) known.push_back(n);
      }
    }
  }
  for (const auto& [e, list] : normals)
    for (const Vec3& n : list) mirrors_.emplace_back(e, n);
}

/// Completes the sums. Entry (a, b) of the tensor at an edge is at place[3 a + b].
void SharedEdges::finish(std::span<double> values, int step, std::span<const int, 9> place) const {
  if (parallel_) {
    map_.add_to_owners(values, step);
    map_.update_ghosts(values, step);
  }
  const int n = 1 + std::ranges::max(place);
  for (std::size_t e = 0; e < inverse_volume_.size(); ++e)
    for (int i = 0; i < n; ++i) values[e * step + i] *= inverse_volume_[e];
  for (const auto& [e, n_plane] : mirrors_) {
    double* v = values.data() + std::size_t(e) * step;
    Tensor3 g;
    for (int i = 0; i < 9; ++i) g(i / 3, i % 3) = v[place[i]];
    const Tensor3 turn = Tensor3::Identity() - 2 * n_plane * n_plane.transpose();
    g = (0.5 * (g + turn * g * turn)).eval();
    for (int i = 0; i < 9; ++i) v[place[i]] = g(i / 3, i % 3);
  }
}

void SharedEdges::finish_means() { finish(value_, stride, of_strain); }

void SharedEdges::finish_gradients(std::span<double> values) const {
  constexpr std::array<int, 9> in_order{0, 1, 2, 3, 4, 5, 6, 7, 8};
  finish(values, gradient_stride, in_order);
}

void SharedEdges::to_stress() {
  for (std::size_t e = 0; e < matrix_.size(); ++e) {
    Eigen::Map<StrainVector> v(value_.data() + e * stride);
    v.tail<3>() *= 2;
    v = (matrix_[e] * v).eval();
  }
  if (!matrix_.empty()) return;
  const std::size_t step = lame_.size() == 1 ? 0 : 1;
  for (std::size_t e = 0; e < inverse_volume_.size(); ++e) {
    const auto [mu, lambda] = lame_[e * step];
    double* v = value_.data() + e * stride;
    const double bulk = lambda * (v[0] + v[1] + v[2]);
    for (int i = 0; i < size; ++i) v[i] *= 2 * mu;
    for (int i = 0; i < 3; ++i) v[i] += bulk;
  }
}

SharedFaces shared_faces(const mesh::Mesh& mesh, const ElasticOperator& rows) {
  SharedFaces result;
  if (mesh.dim == 2) return result;
  std::vector<std::uint8_t> at_surface(mesh.points.n_local(), 0);
  for (Index f = mesh.n_interior; f < mesh.n_faces(); ++f)
    if (!rows.mirrored(f))
      for (const Index v : mesh.face_points[f]) at_surface[v] = 1;
  const auto share_of = [&](Index f) {
    constexpr double near_surface[4] = {0, 0, 1. / 3, 1};
    const auto p = mesh.face_points[f];
    const std::vector<Vec3>& x = rows.geometry().points;
    const auto [least, most] =
        std::minmax({(x[p[1]] - x[p[0]]).norm(), (x[p[2]] - x[p[1]]).norm(), (x[p[0]] - x[p[2]]).norm()});
    const double stretched = std::clamp((most / least - 1.7) / 1.3, 0., 1.);
    const auto n = std::ranges::count_if(p, [&](Index v) { return at_surface[v] != 0; });
    return 0.8 + 0.15 * std::max(near_surface[n], stretched);
  };
  std::vector<Index> elsewhere;
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    if (mesh.face_points[f].size() != 3) continue;
    if (mesh.owner[f] >= mesh.cells.n_owned()) {
      elsewhere.push_back(f);
      continue;
    }
    result.faces.push_back(f);
    result.part.push_back(share_of(f) * symmetric_rows(mesh, rows, f).volume / 3);
  }
  result.n_mine = result.faces.size();
  result.faces.insert(result.faces.end(), elsewhere.begin(), elsewhere.end());
  result.part.resize(result.faces.size(), 0);
  for (const Index f : result.faces) result.share.push_back(share_of(f));
  return result;
}

void find_edge_stresses(const SharedFaces& shared, std::span<const Tensor3> stress, SharedEdges& edges) {
  edges.clear();
  for (std::size_t i = 0; i < shared.n_mine; ++i) {
    const Tensor3& s = stress[std::size_t(shared.faces[i])];
    const double part = shared.part[i];
    const double entries[6] = {s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(0, 2)};
    for (const Index e : edges.edges_of(i))
      for (int k = 0; k < 6; ++k) edges.at(e)[k] += part * entries[k];
  }
  edges.finish_means();
}

Tensor3 edge_tensor(SharedEdges& edges, Index e) {
  Tensor3 s;
  for (int i = 0; i < 9; ++i) s(i / 3, i % 3) = edges.at(e)[SharedEdges::of_strain[std::size_t(i)]];
  return s;
}

FaceGroup make_group(const mesh::Mesh& mesh, const ElasticOperator& rows, std::vector<Index> faces) {
  FaceGroup group{.faces = std::move(faces), .blocks = {}, .volumes = {}, .edges = {}};
  group.blocks.resize((group.faces.size() + 3) / 4, FaceBlock{});
  group.volumes.resize(group.blocks.size(), FaceVolumes{});
  for (std::size_t i = 0; i < group.blocks.size() * 4; ++i) {
    FaceBlock& block = group.blocks[i / 4];
    FaceVolumes& volumes = group.volumes[i / 4];
    const std::size_t k = i % 4;
    const bool is_filling = i >= group.faces.size();
    const Index f = is_filling ? group.faces.back() : group.faces[i];
    const FaceRows face = symmetric_rows(mesh, rows, f);
    for (std::size_t j = 0; 2 * j < std::size_t(face.n); ++j) {
      block.plus[j][k] = face.row[j == 0 ? 1 : 2 * j].place;
      block.minus[j][k] = face.row[j == 0 ? 0 : 2 * j + 1].place;
    }
    volumes.face[k] = is_filling ? -1 : f;
    volumes.own[k] = 1;
    if (is_filling) continue;
    for (std::size_t j = 0; j < std::size_t(mesh.dim); ++j)
      for (int a = 0; a < mesh.dim; ++a) block.b[j][a][k] = face.row[j == 0 ? 1 : 2 * j].b[a];
    const auto [here, there] = pyramids(mesh, rows.geometry(), f);
    volumes.whole[k] = face.volume;
    volumes.here[k] = here / face.volume;
    volumes.there[k] = there / face.volume;
  }
  return group;
}

}  // namespace couplet::elastic
