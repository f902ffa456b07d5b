// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/symmetric_kernel.hpp"

#include <algorithm>

#include "common/parallel/collective.hpp"

namespace couplet {

template <int D>
SymmetricKernel<D>::SymmetricKernel(const Mesh& mesh, const ElasticOperator& rows)
    : mesh_(mesh),
      rows_(rows),
      nodes_(mesh, rows),
      vertices_(mesh, rows),
      points_(std::size_t(mesh.points.n_local()) * stride, 0.0),
      force_(std::size_t(mesh.cells.n_local() + mesh.boundary.n_local()) * stride, 0.0),
      point_force_(points_.size(), 0.0) {
  for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f)
    if (rows.condition(f) == ElasticCondition::symmetry)
      symmetry_.emplace_back(f, mesh.reference.face_area[f].normalized());
  make_faces();
  // Warped faces: the pyramids fill the cell only nearly.
  volume_.assign(mesh.cells.n_owned(), 0);
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    const auto [here, there] = pyramids(mesh, f);
    if (mesh.owner[f] < mesh.cells.n_owned()) volume_[mesh.owner[f]] += here;
    if (f < mesh.n_interior && mesh.neighbour[f] < mesh.cells.n_owned()) volume_[mesh.neighbour[f]] += there;
  }
  if (!rows.volume_by_cells()) return;
  volumes_ = make_volumes(mine_);
  shared_volumes_ = make_volumes(shared_mine_);
  pressure_.assign(force_.size() / stride, 0);
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) bulk_.push_back(bulk_modulus(rows.lame(c)) / volume_[c]);
}

template <int D>
std::vector<typename SymmetricKernel<D>::VolumeBlock> SymmetricKernel<D>::make_volumes(
    std::span<const Index> faces) const {
  std::vector<VolumeBlock> result((faces.size() + 3) / 4);
  for (std::size_t i = 0; i < result.size() * 4; ++i) {
    VolumeBlock& block = result[i / 4];
    block.from[i % 4] = block.to[i % 4] = 0;
    if (i >= faces.size()) continue;
    const auto [here, there] = pyramids(mesh_, faces[i]);
    const double inverse = symmetric_face<D>(mesh_, rows_, faces[i]).inverse;
    block.from[i % 4] = here * inverse;
    block.to[i % 4] = there * inverse;
  }
  return result;
}

template <int D>
void SymmetricKernel<D>::make_faces() {
  std::vector<Index> shared_elsewhere;
  shared_index_.assign(D == 3 ? mesh_.n_flux_faces() : 0, -1);
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
    const bool is_mine = mesh_.owner[f] < mesh_.cells.n_owned();
    if (D == 3 && mesh_.face_points[f].size() == 3)
      (is_mine ? shared_mine_ : shared_elsewhere).push_back(f);
    else if (is_mine)
      mine_.push_back(f);
  }
  if (!mine_.empty()) blocks_ = make_blocks<D>(mesh_, rows_, mine_);
  const bool shares = D == 3 && any(mesh_.comm, !shared_mine_.empty());
  if (!shares) return;
  if (!shared_mine_.empty()) shared_blocks_ = make_blocks<D>(mesh_, rows_, shared_mine_);
  std::vector<Index> all = shared_mine_;
  all.insert(all.end(), shared_elsewhere.begin(), shared_elsewhere.end());
  std::vector<double> volume(all.size(), 0);
  shared_.resize(shared_blocks_.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    shared_index_[all[i]] = static_cast<Index>(i);
    if (i >= shared_mine_.size()) continue;
    const SymmetricFace<D> face = symmetric_face<D>(mesh_, rows_, all[i]);
    volume[i] = face.volume;
    SharedBlock& block = shared_[i / 4];
    block.inverse[i % 4] = face.inverse;
    block.part[i % 4] = SharedEdges::share * face.volume / 3;
    block.weight[i % 4] = SharedEdges::share * face.volume * face.inverse / 3;
  }
  edges_ = std::make_unique<SharedEdges>(mesh_, rows_, all, volume);
  for (std::size_t i = 0; i < shared_.size() * 4; ++i) {
    const bool is_filling = i >= shared_mine_.size();
    if (is_filling)
      shared_[i / 4].inverse[i % 4] = shared_[i / 4].part[i % 4] = shared_[i / 4].weight[i % 4] = 0;
    shared_[i / 4].edges[i % 4] = edges_->edges_of(is_filling ? 0 : i);
  }
}

template <int D>
Vec3 SymmetricKernel<D>::vector(const double* at) const {
  Vec3 v = Vec3::Zero();
  for (int a = 0; a < D; ++a) v[a] = at[a];
  return v;
}

template <int D>
inline void SymmetricKernel<D>::interpolate_free() {
  using lanes::Lane;
  const double* nodes = nodes_[0];
  double* points = points_.data();
  for (const Index v : vertices_.free) {
    const auto index = rows_.vertices().nodes(v);
    const auto weight = rows_.vertices().weights(v);
    Lane<D> sum = {};
    for (std::size_t i = 0; i < index.size(); ++i)
      sum += weight[i] * lanes::load<D>(nodes + std::size_t(index[i]) * stride);
    lanes::store<D>(points + std::size_t(v) * stride, sum);
  }
}

// V / (S . d) sigma of four faces, and what it does to their nodes and points.
template <int D>
inline void SymmetricKernel<D>::faces_loop() {
  const double *nodes = nodes_[0], *points = points_.data();
  double *force = force_.data(), *point_force = point_force_.data();
  for (const FaceBlock<D>& block : blocks_) {
    V h[D][D], stress[D][D];
    blocks::stretch<D>(block, nodes, points, h);
    blocks::hooke<D>(block, h, stress);
    if (!volumes_.empty()) {
      const V pressure = pressure_on(block, volumes_[std::size_t(&block - blocks_.data())]);
      for (int a = 0; a < D; ++a) stress[a][a] += pressure;
    }
    blocks::push<D>(block, stress, force, point_force);
  }
}

/// (V_fP p_P + V_fQ p_Q) / (S . d), p being the mean stress of the cells.
template <int D>
inline typename SymmetricKernel<D>::V SymmetricKernel<D>::pressure_on(const FaceBlock<D>& block,
                                                                      const VolumeBlock& volume) const {
  double here[4], there[4];
  for (int k = 0; k < 4; ++k) {
    here[k] = pressure_[std::size_t(block.from[k])];
    there[k] = pressure_[std::size_t(block.to[k])];
  }
  return blocks::wide(volume.from) * blocks::wide(here) + blocks::wide(volume.to) * blocks::wide(there);
}

/// V_fP tr e_f to the cells.
template <int D>
inline void SymmetricKernel<D>::add_volumes(const std::vector<FaceBlock<D>>& blocks,
                                            const std::vector<VolumeBlock>& volumes) {
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    V h[D][D];
    blocks::stretch<D>(blocks[i], nodes_[0], points_.data(), h);
    V trace = h[0][0];
    for (int a = 1; a < D; ++a) trace += h[a][a];
    for (int k = 0; k < 4; ++k) {
      pressure_[std::size_t(blocks[i].from[k])] += volumes[i].from[k] * trace[k];
      pressure_[std::size_t(blocks[i].to[k])] += volumes[i].to[k] * trace[k];
    }
  }
}

template <int D>
inline void SymmetricKernel<D>::volumes_loop() {
  add_volumes(blocks_, volumes_);
  add_volumes(shared_blocks_, shared_volumes_);
}

// The faces' own part, kept, and t V / 3 e to the edges.
template <int D>
inline void SymmetricKernel<D>::shared_first_loop() {
  if constexpr (D == 3) {
    const double *nodes = nodes_[0], *points = points_.data();
    constexpr int first[6] = {0, 1, 2, 0, 1, 0}, second[6] = {0, 1, 2, 1, 2, 2};
    const double own = 1 - SharedEdges::share;
    for (std::size_t i = 0; i < shared_blocks_.size(); ++i) {
      SharedBlock& shared = shared_[i];
      V h[D][D], stress[D][D];
      blocks::stretch<D>(shared_blocks_[i], nodes, points, h);
      blocks::hooke<D>(shared_blocks_[i], h, stress);
      const V scale = blocks::wide(shared.inverse) * blocks::wide(shared.part) * 0.5;
      V strain[6];
      for (int k = 0; k < 6; ++k) {
        lanes::store<3>(shared.stress[k], own * stress[first[k]][second[k]]);
        strain[k] = scale * (h[first[k]][second[k]] + h[second[k]][first[k]]);
      }
      const V xyz[3] = {strain[0], strain[1], strain[2]}, rest[3] = {strain[3], strain[4], strain[5]};
      V low[4], high[4];
      blocks::transpose(xyz, low);
      blocks::transpose(rest, high);
      for (int k = 0; k < 4; ++k)
        for (const Index e : shared.edges[k]) {
          double* at = edges_->at(e);
          for (int c = 0; c < 3; ++c) at[c] += low[k][c], at[3 + c] += high[k][c];
        }
    }
  }
}

// With the stress of the edges.
template <int D>
inline void SymmetricKernel<D>::shared_second_loop() {
  if constexpr (D == 3) {
    double *force = force_.data(), *point_force = point_force_.data();
    constexpr int first[6] = {0, 1, 2, 0, 1, 0}, second[6] = {0, 1, 2, 1, 2, 2};
    for (std::size_t i = 0; i < shared_blocks_.size(); ++i) {
      const SharedBlock& shared = shared_[i];
      V stress[D][D];
      const V weight = blocks::wide(shared.weight);
      for (int k = 0; k < 6; ++k) {
        V of_edges{};
        for (int j = 0; j < 4; ++j)
          of_edges[j] = edges_->at(shared.edges[j][0])[k] + edges_->at(shared.edges[j][1])[k] +
                        edges_->at(shared.edges[j][2])[k];
        stress[first[k]][second[k]] = blocks::wide(shared.stress[k]) + weight * of_edges;
        stress[second[k]][first[k]] = stress[first[k]][second[k]];
      }
      if (!shared_volumes_.empty()) {
        const V pressure = pressure_on(shared_blocks_[i], shared_volumes_[i]);
        for (int a = 0; a < D; ++a) stress[a][a] += pressure;
      }
      blocks::push<D>(shared_blocks_[i], stress, force, point_force);
    }
  }
}

// The weights' transpose.
template <int D>
inline void SymmetricKernel<D>::to_nodes_loop() {
  using lanes::Lane;
  double* force = force_.data();
  for (const Index v : vertices_.free) {
    const auto index = rows_.vertices().nodes(v);
    const auto weight = rows_.vertices().weights(v);
    const Lane<D> here = lanes::load<D>(point_force_.data() + std::size_t(v) * stride);
    for (std::size_t i = 0; i < index.size(); ++i)
      lanes::add<D>(force + std::size_t(index[i]) * stride, weight[i] * here);
  }
}

namespace {

// The loops for several generations of processors; the right one is picked when the program starts.
[[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]] void vertices_pass(
    SymmetricKernel<3>& kernel) {
  kernel.interpolate_free();
}
[[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]] void vertices_pass(
    SymmetricKernel<2>& kernel) {
  kernel.interpolate_free();
}
[[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]] void faces_pass(
    SymmetricKernel<3>& kernel) {
  kernel.faces_loop();
}
[[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]] void faces_pass(
    SymmetricKernel<2>& kernel) {
  kernel.faces_loop();
}
[[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]] void shared_first_pass(
    SymmetricKernel<3>& kernel) {
  kernel.shared_first_loop();
}
[[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]] void shared_second_pass(
    SymmetricKernel<3>& kernel) {
  kernel.shared_second_loop();
}
[[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]] void to_nodes_pass(
    SymmetricKernel<3>& kernel) {
  kernel.to_nodes_loop();
}
[[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]] void to_nodes_pass(
    SymmetricKernel<2>& kernel) {
  kernel.to_nodes_loop();
}
[[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]] void volumes_pass(
    SymmetricKernel<3>& kernel) {
  kernel.volumes_loop();
}
[[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]] void volumes_pass(
    SymmetricKernel<2>& kernel) {
  kernel.volumes_loop();
}
void shared_first_pass(SymmetricKernel<2>&) {}
void shared_second_pass(SymmetricKernel<2>&) {}

}  // namespace

/// All that stands before the faces. At symmetry planes the face's node is the mirror image of its cell.
template <int D>
void SymmetricKernel<D>::fill(std::span<const double> unknowns, std::span<const double> known) {
  nodes_.fill(unknowns, known, true);
  for (const auto& [f, n] : symmetry_) {
    const Vec3 u = vector(nodes_[mesh_.owner[f]]), image = u - 2 * n.dot(u) * n;
    double* at = nodes_.value(node_of_face(f));
    for (int a = 0; a < D; ++a) at[a] = image[a];
  }
  vertices_pass(*this);
  vertices_.constrain<D>(points_, stride, known);
}

template <int D>
void SymmetricKernel<D>::clear_forces() {
  std::ranges::fill(force_, 0.0);
  std::ranges::fill(point_force_, 0.0);
}

template <int D>
void SymmetricKernel<D>::find_pressures() {
  std::ranges::fill(pressure_, 0.0);
  volumes_pass(*this);
  const std::span<double> cells = std::span(pressure_).first(std::size_t(mesh_.cells.n_local()));
  mesh_.cells.add_to_owners(cells);
  for (std::size_t c = 0; c < bulk_.size(); ++c) cells[c] *= bulk_[c];
  mesh_.cells.update_ghosts(cells);
}

template <int D>
void SymmetricKernel<D>::internal_forces() {
  if (!pressure_.empty()) find_pressures();
  faces_pass(*this);
  if (!edges_) return;
  edges_->clear();
  shared_first_pass(*this);
  edges_->finish_means();
  edges_->to_stress();
  shared_second_pass(*this);
}

/// F_V takes what the constraints hold.
template <int D>
void SymmetricKernel<D>::constrain_point_forces() {
  for (const Index v : vertices_.constrained) {
    Eigen::Map<Vec<D>> f(point_force(v));
    f = (rows_.constraints().free_part(v).template topLeftCorner<D, D>() * f).eval();
  }
}

template <int D>
void SymmetricKernel<D>::points_to_nodes() {
  constrain_point_forces();
  to_nodes_pass(*this);
}

/// From points and mirror images to the nodes, over the ranks, and both sides of bonded faces into one.
template <int D>
void SymmetricKernel<D>::collect() {
  points_to_nodes();
  for (const auto& [f, n] : symmetry_) {
    double* image = force(node_of_face(f));
    const Vec3 there = vector(image);
    add(force(mesh_.owner[f]), there - 2 * n.dot(there) * n);
    std::fill_n(image, D, 0.0);
  }
  const std::size_t n_cells = std::size_t(mesh_.cells.n_local()) * stride;
  const std::span<double> all(force_);
  mesh_.cells.add_to_owners(all.first(n_cells), stride);
  const std::span<double> faces = all.subspan(n_cells);
  mesh_.boundary.add_to_owners(faces, stride);
  if (mesh_.twin.empty()) return;
  std::fill(faces.begin() + std::ptrdiff_t(mesh_.boundary.n_owned()) * stride, faces.end(), 0.0);
  for (Index b = 0; b < mesh_.boundary.n_owned(); ++b) {
    const Index first = mesh_.twin[b];
    if (first < 0 || mesh_.boundary_id[first] > mesh_.boundary_id[b]) continue;
    for (int a = 0; a < D; ++a) faces[std::size_t(first) * stride + a] += faces[std::size_t(b) * stride + a];
  }
  mesh_.boundary.add_to_owners(faces, stride);
}

/// The rows that ElasticOperator defines. `unknowns` empty: of loads, to which supports add no rows of their
/// own.
template <int D>
void SymmetricKernel<D>::take_rows(std::span<const double> unknowns, std::span<const double> known,
                                   std::span<double> result) {
  const Index n_owned = mesh_.cells.n_owned();
  for (Index c = 0; c < n_owned; ++c) std::copy_n(force(c), D, result.data() + std::size_t(c) * D);
  const auto& open = rows_.unknown_faces();
  for (std::size_t i = 0; i < open.size(); ++i) {
    const Index f = open[i];
    const std::size_t row = (std::size_t(n_owned) + i) * D;
    Vec3 own = vector(force(node_of_face(f)));
    if (rows_.condition(f) == ElasticCondition::support) {
      const ElasticSupport& s = rows_.support(f);
      own -= (s.known * own).eval();
      if (!unknowns.empty()) {
        Vec3 jump = Vec3::Zero();
        for (int a = 0; a < D; ++a)
          jump[a] =
              unknowns[row + a] - (known.empty() ? 0 : known[std::size_t(rows_.known_of_face(f)) * D + a]);
        const LameConstants lame = rows_.lame(mesh_.owner[f]);
        const FaceLine line = face_line(mesh_, mesh_.reference, f);
        own += (2 * lame.mu + lame.lambda) * line.area * line.inverse_dn * (s.known * jump);
      }
    }
    for (int a = 0; a < D; ++a) result[row + a] = own[a];
  }
}

template <int D>
void SymmetricKernel<D>::add_springs(std::span<const double> known) {
  for (const Index f : rows_.known_faces())
    if (rows_.condition(f) == ElasticCondition::support)
      visit_spring(f, known, [&](double* at, const Vec3& pull) { add(at, pull); });
}

template <int D>
void SymmetricKernel<D>::apply(std::span<const double> unknowns, std::span<const double> known,
                               std::span<double> result) {
  fill(unknowns, known);
  clear_forces();
  internal_forces();
  add_springs(known);
  collect();
  take_rows(unknowns, known, result);
}

template <int D>
void SymmetricKernel<D>::face_gradients(std::span<const double> unknowns, std::span<const double> known,
                                        const ElasticKernel::TakeGradient& take, Index first, Index end) {
  fill(unknowns, known);
  if (edges_) {
    edges_->clear();
    shared_first_pass(*this);
    edges_->finish_means();
  }
  if (!pressure_.empty()) find_pressures();
  for (Index f = first; f < end; ++f) {
    const SymmetricFace<D> face = symmetric_face<D>(mesh_, rows_, f);
    const double* across = nodes_[f < mesh_.n_interior ? mesh_.neighbour[f] : node_of_face(f)];
    const double* here = nodes_[mesh_.owner[f]];
    Tensor3 gradient = Tensor3::Zero();
    for (int j = 0; j < D; ++j)
      for (int k = 0; k < D; ++k) {
        double h = (across[k] - here[k]) * face.area[j];
        for (int i = 0; i < D - 1; ++i)
          h += (points_[std::size_t(face.plus[i]) * stride + k] -
                points_[std::size_t(face.minus[i]) * stride + k]) *
               face.across[i][j];
        gradient(j, k) = h * face.inverse;
      }
    if (edges_ && shared_index_[f] >= 0) {
      const Tensor3 own = 0.5 * (gradient + gradient.transpose());
      Tensor3 of_edges = Tensor3::Zero();
      for (const Index e : edges_->edges_of(shared_index_[f])) {
        const double* v = edges_->at(e);
        Tensor3 mean;
        mean << v[0], v[3], v[5], v[3], v[1], v[4], v[5], v[4], v[2];
        of_edges += mean / 3;
      }
      gradient += SharedEdges::share * (of_edges - own);
    }
    if (!pressure_.empty()) {
      // What Hooke's law then makes of it is 2 mu dev(e) + p I.
      const auto [here, there] = pyramids(mesh_, f);
      const LameConstants lame = face_lame(mesh_, rows_, f);
      double mean = here * pressure_[std::size_t(mesh_.owner[f])];
      if (f < mesh_.n_interior) mean += there * pressure_[std::size_t(mesh_.neighbour[f])];
      mean /= here + there;
      const double gap = mean - bulk_modulus(lame) * gradient.trace();
      for (int a = 0; a < D; ++a) gradient(a, a) += gap / (2 * lame.mu + D * lame.lambda);
    }
    take(f, gradient);
  }
}

template <int D>
void SymmetricKernel<D>::point_values(std::span<const double> unknowns, std::span<const double> known,
                                      std::span<double> points) {
  fill(unknowns, known);
  vertices_.visit([&](Index v) {
    std::copy_n(points_.data() + std::size_t(v) * stride, D, points.data() + std::size_t(v) * D);
  });
}

template class SymmetricKernel<2>;
template class SymmetricKernel<3>;

std::unique_ptr<ElasticKernel::Implementation> make_symmetric_kernel(const Mesh& mesh,
                                                                     const ElasticOperator& rows) {
  if (mesh.dim == 2) return std::make_unique<SymmetricKernel<2>>(mesh, rows);
  return std::make_unique<SymmetricKernel<3>>(mesh, rows);
}

}  // namespace couplet
