// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/symmetric/symmetric_kernel.hpp"

#include "common/base/processor_clones.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::elastic {

// V / (S . d) sigma of four faces, and what it does to their nodes and points.
template <int D>
inline void SymmetricKernel<D>::faces_loop() {
  const double *nodes = space_.nodes(), *points = space_.points();
  double *force = space_.forces(), *point_force = space_.point_forces();
  for (const FaceBlock<D>& block : blocks_) {
    V h[D][D], stress[D][D];
    blocks::stretch<D>(block, nodes, points, h);
    if (elastic_.empty())
      blocks::hooke<D>(block, h, stress);
    else
      blocks::elastic<D>(elastic_[std::size_t(&block - blocks_.data())], h, stress);
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
    blocks::stretch<D>(blocks[i], space_.nodes(), space_.points(), h);
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
    const double *nodes = space_.nodes(), *points = space_.points();
    constexpr int first[6] = {0, 1, 2, 0, 1, 0}, second[6] = {0, 1, 2, 1, 2, 2};
    const double own = 1 - SharedEdges::share;
    for (std::size_t i = 0; i < shared_blocks_.size(); ++i) {
      SharedBlock& shared = shared_[i];
      V h[D][D], stress[D][D];
      blocks::stretch<D>(shared_blocks_[i], nodes, points, h);
      if (shared_elastic_.empty())
        blocks::hooke<D>(shared_blocks_[i], h, stress);
      else
        blocks::elastic<D>(shared_elastic_[i], h, stress);
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

template class SymmetricKernel<2>;
template class SymmetricKernel<3>;

std::unique_ptr<ElasticKernel::Implementation> make_symmetric_kernel(const mesh::Mesh& mesh,
                                                                     const ElasticOperator& rows) {
  if (mesh.dim == 2) return std::make_unique<SymmetricKernel<2>>(mesh, rows);
  return std::make_unique<SymmetricKernel<3>>(mesh, rows);
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

template void SymmetricKernel<2>::apply_mixed(std::span<const double>, std::span<const double>, double,
                                              std::span<double>, std::span<double>);

template void SymmetricKernel<3>::apply_mixed(std::span<const double>, std::span<const double>, double,
                                              std::span<double>, std::span<double>);

}  // namespace couplet::elastic
