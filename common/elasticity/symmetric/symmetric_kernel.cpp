// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/symmetric/symmetric_kernel.hpp"

#include "common/base/processor_clones.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::elastic {

template <int D>
SymmetricKernel<D>::SymmetricKernel(const mesh::Mesh& mesh, const ElasticOperator& rows)
    : SpaceKernel<D>(mesh, rows), mesh_(mesh), geometry_(rows.geometry()), rows_(rows) {
  const SharedFaces shared = shared_faces(mesh, rows);
  std::vector<Index> others;
  for (Index f = 0; f < mesh.n_flux_faces(); ++f)
    if (mesh.owner[f] < mesh.cells.n_owned() && (D == 2 || mesh.face_points[f].size() != 3))
      others.push_back(f);
  plain_ = make_group(std::move(others));
  sharing_ = make_group({shared.faces.begin(), shared.faces.begin() + std::ptrdiff_t(shared.n_mine)});
  if (parallel::any(mesh.comm, shared.n_mine > 0)) make_edges(shared);
  if (!rows.volume_by_cells()) return;
  pressure_.assign(space_.n_nodes(), 0);
  const std::vector<double> volume = pyramid_volumes(mesh, geometry_);
  for (Index c = 0; c < mesh.cells.n_owned(); ++c)
    bulk_.push_back(bulk_of_cells(rows.lame(c), rows.volume_strain()) / volume[c]);
}

template <int D>
typename SymmetricKernel<D>::Group SymmetricKernel<D>::make_group(std::vector<Index> faces) const {
  Group group{std::move(faces), {}, {}, {}};
  if (!group.faces.empty()) group.blocks = make_blocks<D>(mesh_, rows_, group.faces);
  group.elastic = make_elastic_blocks<D>(mesh_, rows_, group.faces);
  if (!rows_.volume_by_cells()) return group;
  group.volumes.resize(group.blocks.size());
  for (std::size_t i = 0; i < group.volumes.size() * 4; ++i) {
    VolumeBlock& block = group.volumes[i / 4];
    block.from[i % 4] = block.to[i % 4] = 0;
    if (i >= group.faces.size()) continue;
    const auto [here, there] = pyramids(mesh_, geometry_, group.faces[i]);
    const double inverse = symmetric_face<D>(mesh_, rows_, group.faces[i]).inverse;
    block.from[i % 4] = here * inverse;
    block.to[i % 4] = there * inverse;
  }
  return group;
}

template <int D>
void SymmetricKernel<D>::make_edges(const SharedFaces& shared) {
  edges_ = std::make_unique<SharedEdges>(mesh_, rows_, shared.faces, shared.volume);
  shared_index_.assign(mesh_.n_flux_faces(), -1);
  for (std::size_t i = 0; i < shared.faces.size(); ++i) shared_index_[shared.faces[i]] = Index(i);
  shared_.resize(sharing_.blocks.size());
  for (std::size_t i = 0; i < shared_.size() * 4; ++i) {
    SharedBlock& block = shared_[i / 4];
    const bool is_filling = i >= shared.n_mine;
    block.edges[i % 4] = edges_->edges_of(is_filling ? 0 : i);
    block.inverse[i % 4] = block.part[i % 4] = block.weight[i % 4] = 0;
    if (is_filling) continue;
    const SymmetricFace<D> face = symmetric_face<D>(mesh_, rows_, shared.faces[i]);
    block.inverse[i % 4] = face.inverse;
    block.part[i % 4] = SharedEdges::share * face.volume / 3;
    block.weight[i % 4] = SharedEdges::share * face.volume * face.inverse / 3;
  }
}

/// V / (S . d) sigma of a block of the group without the pressure of cells.
template <int D>
inline void SymmetricKernel<D>::stress_of(const Group& group, const FaceBlock<D>& block, const V (&h)[D][D],
                                          V (&stress)[D][D]) const {
  if (group.elastic.empty())
    blocks::hooke<D>(block, h, stress);
  else
    blocks::elastic<D>(group.elastic[std::size_t(&block - group.blocks.data())], h, stress);
}

/// Adds (V_fP p_P + V_fQ p_Q) / (S . d), p being the mean stress of the cells.
template <int D>
inline void SymmetricKernel<D>::add_pressure_of_cells(const Group& group, const FaceBlock<D>& block,
                                                      V (&stress)[D][D]) const {
  if (group.volumes.empty()) return;
  const VolumeBlock& volume = group.volumes[std::size_t(&block - group.blocks.data())];
  double here[4], there[4];
  for (int k = 0; k < 4; ++k) {
    here[k] = pressure_[std::size_t(block.from[k])];
    there[k] = pressure_[std::size_t(block.to[k])];
  }
  const V pressure =
      blocks::wide(volume.from) * blocks::wide(here) + blocks::wide(volume.to) * blocks::wide(there);
  for (int a = 0; a < D; ++a) stress[a][a] += pressure;
}

// V / (S . d) sigma of four faces, and what it does to their nodes and points.
template <int D>
inline void SymmetricKernel<D>::faces_loop() {
  const double *nodes = space_.nodes(), *points = space_.points();
  double *force = space_.forces(), *point_force = space_.point_forces();
  for (const FaceBlock<D>& block : plain_.blocks) {
    V h[D][D], stress[D][D];
    blocks::stretch<D>(block, nodes, points, h);
    stress_of(plain_, block, h, stress);
    add_pressure_of_cells(plain_, block, stress);
    blocks::push<D>(block, stress, force, point_force);
  }
}

/// V_fP tr e_f to the cells.
template <int D>
inline void SymmetricKernel<D>::volumes_loop() {
  for (const Group* group : {&plain_, &sharing_})
    for (std::size_t i = 0; i < group->volumes.size(); ++i) {
      const FaceBlock<D>& block = group->blocks[i];
      V h[D][D];
      blocks::stretch<D>(block, space_.nodes(), space_.points(), h);
      V trace = h[0][0];
      for (int a = 1; a < D; ++a) trace += h[a][a];
      for (int k = 0; k < 4; ++k) {
        pressure_[std::size_t(block.from[k])] += group->volumes[i].from[k] * trace[k];
        pressure_[std::size_t(block.to[k])] += group->volumes[i].to[k] * trace[k];
      }
    }
}

// The faces' own part, kept, and t V / 3 e to the edges.
template <int D>
inline void SymmetricKernel<D>::shared_first_loop() {
  if constexpr (D == 3) {
    const double *nodes = space_.nodes(), *points = space_.points();
    constexpr int first[6] = {0, 1, 2, 0, 1, 0}, second[6] = {0, 1, 2, 1, 2, 2};
    const double own = 1 - SharedEdges::share;
    for (std::size_t i = 0; i < shared_.size(); ++i) {
      SharedBlock& shared = shared_[i];
      V h[D][D], stress[D][D];
      blocks::stretch<D>(sharing_.blocks[i], nodes, points, h);
      stress_of(sharing_, sharing_.blocks[i], h, stress);
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
    double *force = space_.forces(), *point_force = space_.point_forces();
    constexpr int first[6] = {0, 1, 2, 0, 1, 0}, second[6] = {0, 1, 2, 1, 2, 2};
    for (std::size_t i = 0; i < shared_.size(); ++i) {
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
      add_pressure_of_cells(sharing_, sharing_.blocks[i], stress);
      blocks::push<D>(sharing_.blocks[i], stress, force, point_force);
    }
  }
}

namespace {

// The loops for several generations of processors; the right one is picked when the program starts.
COUPLET_PROCESSOR_CLONES void faces_pass(SymmetricKernel<3>& kernel) { kernel.faces_loop(); }
COUPLET_PROCESSOR_CLONES void faces_pass(SymmetricKernel<2>& kernel) { kernel.faces_loop(); }
COUPLET_PROCESSOR_CLONES void shared_first_pass(SymmetricKernel<3>& kernel) { kernel.shared_first_loop(); }
COUPLET_PROCESSOR_CLONES void shared_second_pass(SymmetricKernel<3>& kernel) { kernel.shared_second_loop(); }
COUPLET_PROCESSOR_CLONES void volumes_pass(SymmetricKernel<3>& kernel) { kernel.volumes_loop(); }
COUPLET_PROCESSOR_CLONES void volumes_pass(SymmetricKernel<2>& kernel) { kernel.volumes_loop(); }
void shared_first_pass(SymmetricKernel<2>&) {}
void shared_second_pass(SymmetricKernel<2>&) {}

}  // namespace

/// V theta of the owned cells, in the places of their pressures.
template <int D>
std::span<double> SymmetricKernel<D>::sum_volumes() {
  std::ranges::fill(pressure_, 0.0);
  volumes_pass(*this);
  const std::span<double> cells = std::span(pressure_).first(std::size_t(mesh_.cells.n_local()));
  mesh_.cells.add_to_owners(cells);
  return cells;
}

template <int D>
void SymmetricKernel<D>::find_pressures() {
  const std::span<double> cells = sum_volumes();
  for (std::size_t c = 0; c < bulk_.size(); ++c) cells[c] *= bulk_[c];
  mesh_.cells.update_ghosts(cells);
}

template <int D>
void SymmetricKernel<D>::internal_forces() {
  if (!pressure_.empty()) find_pressures();
  forces_of_stress();
}

template <int D>
void SymmetricKernel<D>::forces_of_stress() {
  faces_pass(*this);
  if (!edges_) return;
  edges_->clear();
  shared_first_pass(*this);
  edges_->finish_means();
  edges_->to_stress();
  shared_second_pass(*this);
}

template <int D>
void SymmetricKernel<D>::face_gradients(std::span<const double> unknowns, std::span<const double> known,
                                        const ElasticKernel::TakeGradient& take, Index first, Index end) {
  space_.fill(unknowns, known);
  const auto node = [&](Index n) { return space_.nodes() + std::size_t(n) * stride; };
  if (edges_) {
    edges_->clear();
    shared_first_pass(*this);
    edges_->finish_means();
  }
  if (!pressure_.empty()) find_pressures();
  for (Index f = first; f < end; ++f) {
    const SymmetricFace<D> face = symmetric_face<D>(mesh_, rows_, f);
    const double *across = node(space_.node_across(f)), *here = node(mesh_.owner[f]);
    Tensor3 gradient = Tensor3::Zero();
    for (int j = 0; j < D; ++j)
      for (int k = 0; k < D; ++k) {
        double h = (across[k] - here[k]) * face.area[j];
        for (int i = 0; i < D - 1; ++i)
          h += (space_.points()[std::size_t(face.plus[i]) * stride + k] -
                space_.points()[std::size_t(face.minus[i]) * stride + k]) *
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
      const auto [here, there] = pyramids(mesh_, geometry_, f);
      const LameConstants lame = face_lame(mesh_, rows_, f);
      double mean = here * pressure_[std::size_t(mesh_.owner[f])];
      if (f < mesh_.n_interior) mean += there * pressure_[std::size_t(mesh_.neighbour[f])];
      mean /= here + there;
      const double gap = mean - bulk_of_cells(lame, rows_.volume_strain()) * gradient.trace();
      for (int a = 0; a < D; ++a) gradient(a, a) += gap / (2 * lame.mu + D * lame.lambda);
    }
    take(f, gradient);
  }
}

/// With the mean stresses of its cells as unknowns of their own.
template <int D>
void SymmetricKernel<D>::apply_mixed(std::span<const double> unknowns, std::span<const double> pressure,
                                     double mass_factor, std::span<double> result, std::span<double> defect) {
  space_.fill(unknowns, {});
  space_.clear_forces();
  const std::span<double> cells = sum_volumes();
  for (std::size_t c = 0; c < bulk_.size(); ++c) {
    defect[c] = cells[c] - pressure[c] / bulk_[c];
    cells[c] = pressure[c];
  }
  mesh_.cells.update_ghosts(cells);
  forces_of_stress();
  space_.add_springs({});
  if (mass_factor > 0) space_.add_mass_forces(mass_factor);
  space_.collect();
  space_.take_rows(unknowns, {}, result);
}

/// Where the volume strain is that of the cells it takes no part in the sharing, nor does the pressure that acts on it.
template <int D>
std::vector<double> SymmetricKernel<D>::shared_pressure(std::span<const double> pressure) {
  std::vector<double> result(pressure.begin(), pressure.end());
  if (!edges_ || rows_.volume_by_cells()) return result;
  edges_->clear();
  for (std::size_t i = 0; i < sharing_.faces.size(); ++i)
    for (const Index e : edges_->edges_of(i))
      for (int a = 0; a < 3; ++a)
        edges_->at(e)[a] += shared_[i / 4].part[i % 4] * pressure[sharing_.faces[i]];
  edges_->finish_means();
  for (std::size_t i = 0; i < sharing_.faces.size(); ++i) {
    double of_edges = 0;
    for (const Index e : edges_->edges_of(i)) of_edges += edges_->at(e)[0] / 3;
    double& here = result[sharing_.faces[i]];
    here = (1 - SharedEdges::share) * here + SharedEdges::share * of_edges;
  }
  return result;
}

template class SymmetricKernel<2>;
template class SymmetricKernel<3>;

std::unique_ptr<ElasticKernel::Implementation> make_symmetric_kernel(const mesh::Mesh& mesh,
                                                                     const ElasticOperator& rows) {
  if (mesh.dim == 2) return std::make_unique<SymmetricKernel<2>>(mesh, rows);
  return std::make_unique<SymmetricKernel<3>>(mesh, rows);
}

}  // namespace couplet::elastic
