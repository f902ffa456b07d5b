// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/finite/finite_kernel_of.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "common/base/processor_clones.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::elastic {
namespace {

// Blocks that a law evaluates in one call: their numbers stay in the first cache.
constexpr std::size_t chunk = 16;

// The loops for several generations of processors; the right one is picked when the program starts.
COUPLET_PROCESSOR_CLONES void deform_pass(std::span<const finite::FiniteBlock<3>> blocks,
                                          const finite::Values<3>& at, finite::State* states,
                                          Invariants* found) {
  finite::deform_loop<3>(blocks, at, states, found);
}
COUPLET_PROCESSOR_CLONES void deform_pass(std::span<const finite::FiniteBlock<2>> blocks,
                                          const finite::Values<2>& at, finite::State* states,
                                          Invariants* found) {
  finite::deform_loop<2>(blocks, at, states, found);
}
COUPLET_PROCESSOR_CLONES void stress_pass(finite::Group<3>& group, const finite::Values<3>& at) {
  group.law->has_second_invariant() ? finite::stress_loop<3, true>(group, at)
                                    : finite::stress_loop<3, false>(group, at);
}
COUPLET_PROCESSOR_CLONES void stress_pass(finite::Group<2>& group, const finite::Values<2>& at) {
  group.law->has_second_invariant() ? finite::stress_loop<2, true>(group, at)
                                    : finite::stress_loop<2, false>(group, at);
}
COUPLET_PROCESSOR_CLONES void tangent_pass(const finite::Group<3>& group, const finite::Values<3>& at) {
  group.law->has_second_invariant() ? finite::tangent_loop<3, true>(group, at)
                                    : finite::tangent_loop<3, false>(group, at);
}
COUPLET_PROCESSOR_CLONES void tangent_pass(const finite::Group<2>& group, const finite::Values<2>& at) {
  group.law->has_second_invariant() ? finite::tangent_loop<2, true>(group, at)
                                    : finite::tangent_loop<2, false>(group, at);
}

template <int D>
finite::FiniteBlock<D>& place(std::vector<finite::FiniteBlock<D>>& blocks, std::size_t i) {
  if (i % 4 == 0) blocks.emplace_back();
  return blocks.back();
}

template <int D>
void add_face(const mesh::Mesh& mesh, const ElasticOperator& rows, Index f, std::size_t k, bool is_filling,
              finite::FiniteBlock<D>& block) {
  const mesh::Geometry& geometry = rows.geometry();
  const SymmetricFace<D> face = symmetric_face<D>(mesh, rows, f);
  set_geometry<D>(mesh, face, f, k, is_filling, block);
  const auto [here, there] = pyramids(mesh, geometry, f);
  block.inverse[k] = is_filling ? 0 : face.inverse;
  block.volume[k] = is_filling ? 0 : face.volume;
  block.weight[k] = is_filling ? 0 : face.volume * face.inverse;
  block.here[k] = is_filling ? 0 : here / face.volume;
  block.there[k] = is_filling ? 0 : there / face.volume;
  block.face[k] = is_filling ? -1 : f;
}

/// dW/dJ of a sheet from P_33 = 0: without the rounding of det F times the bulk modulus.
void balance(finite::State& state) {
  const finite::Tensor4& f = state.f;
  const Four square = f[0][0] * f[0][0] + f[0][1] * f[0][1] + f[1][0] * f[1][0] + f[1][1] * f[1][1];
  const Four area = f[0][0] * f[1][1] - f[0][1] * f[1][0];
  state.wj = -2.0 * f[2][2] * (state.w1 + square * state.w2) / area;
}

}  // namespace

template <int D>
FiniteKernelOf<D>::FiniteKernelOf(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                  std::vector<const FiniteLaw*> laws, bool plane_stress)
    : mesh_(mesh), rows_(rows), space_(mesh, rows), laws_(std::move(laws)), is_sheet_(plane_stress) {
  const mesh::Geometry& geometry = rows.geometry();
  std::vector<Index> edge_index;
  make_edges(edge_index);
  for (std::size_t m = 0; m < laws_.size(); ++m) {
    make_group(m, false, edge_index);
    if (edges_) make_group(m, true, edge_index);
  }
  if (!rows.volume_by_cells()) return;
  of_cells_.assign(space_.n_nodes(), 0);
  volume_ = pyramid_volumes(mesh, geometry);
  modulus_.assign(volume_.size(), 0);
  bulk_pressure_ = modulus_;
  make_elsewhere();
}

/// Faces of one material, those that share with edges or the others.
template <int D>
void FiniteKernelOf<D>::make_group(std::size_t material, bool shares, std::span<const Index> edge_index) {
  finite::Group<D> group{laws_[material], {}, {}, {}, {}, {}, 0, shares ? 1 - SharedEdges::share : 1, {}};
  Index last = -1;
  std::size_t n = 0;
  const auto add = [&](Index f, bool is_filling) {
    if (shares && n % 4 == 0) group.edges.emplace_back();
    add_face<D>(mesh_, rows_, f, n % 4, is_filling, place(group.blocks, n));
    if (shares) group.edges.back()[n % 4] = edges_->edges_of(std::size_t(edge_index[f]));
    ++n;
  };
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
    if (mesh_.owner[f] >= mesh_.cells.n_owned()) continue;  // another rank's
    if (laws_.size() > 1 && std::size_t(mesh_.material_of(mesh_.owner[f])) != material) continue;
    if ((edges_ && edge_index[f] >= 0) != shares) continue;
    add(f, false);
    last = f;
  }
  while (n % 4 != 0) add(last, true);
  group.states.resize(group.blocks.size());
  if (is_sheet_) {
    group.sheet.resize(group.blocks.size());
    group.thinning = finite::thinning(*group.law);
  }
  groups_.push_back(std::move(group));
}

template <int D>
void FiniteKernelOf<D>::make_elsewhere() {
  std::size_t n = 0;
  Index last = -1;
  for (Index f = 0; f < mesh_.n_interior; ++f)
    if (mesh_.owner[f] >= mesh_.cells.n_owned() && mesh_.neighbour[f] < mesh_.cells.n_owned()) {
      add_face<D>(mesh_, rows_, f, n % 4, false, place(elsewhere_.blocks, n));
      last = f;
      ++n;
    }
  for (; n % 4 != 0; ++n) add_face<D>(mesh_, rows_, last, n % 4, true, place(elsewhere_.blocks, n));
  elsewhere_.states.resize(elsewhere_.blocks.size());
}

/// `edge_index`: of each flux face among those that share, -1: it does not. Collective.
template <int D>
void FiniteKernelOf<D>::make_edges(std::vector<Index>& edge_index) {
  if (D == 2) return;
  std::vector<Index> faces, elsewhere;
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f)
    if (mesh_.face_points[f].size() == 3)
      (mesh_.owner[f] < mesh_.cells.n_owned() ? faces : elsewhere).push_back(f);
  if (!parallel::any(mesh_.comm, !faces.empty())) return;
  const std::size_t n_mine = faces.size();
  faces.insert(faces.end(), elsewhere.begin(), elsewhere.end());
  std::vector<double> volume(faces.size(), 0);
  edge_index.assign(mesh_.n_flux_faces(), -1);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    edge_index[faces[i]] = Index(i);
    if (i < n_mine) volume[i] = symmetric_face<D>(mesh_, rows_, faces[i]).volume;
  }
  edges_ = std::make_unique<FiniteEdges>(mesh_, rows_, faces, volume, laws_);
}

template <int D>
finite::Values<D> FiniteKernelOf<D>::values() {
  return {space_.nodes(), space_.points(), space_.forces(), space_.point_forces(),
          of_cells_.empty() ? nullptr : of_cells_.data()};
}

/// States, energy and the worst volume ratio of one material's faces.
template <int D>
void FiniteKernelOf<D>::deform(finite::Group<D>& group) {
  std::array<Invariants, chunk> found;
  std::array<Energy, chunk> energy;
  for (std::size_t first = 0; first < group.blocks.size(); first += chunk) {
    const std::size_t n = std::min(chunk, group.blocks.size() - first);
    const std::span<const finite::FiniteBlock<D>> here(group.blocks.data() + first, n);
    const std::span<const Four> stretch(group.stretch.data() + (group.stretch.empty() ? 0 : first),
                                        group.stretch.empty() ? 0 : n);
    deform_pass(here, values(), group.states.data() + first, found.data());
    if (!group.sheet.empty())
      finite::relax(*group.law, group.thinning, stretch, {found.data(), n}, group.states.data() + first);
    for (std::size_t i = 0; i < n; ++i)
      for (int k = 0; k < 4; ++k)
        if (!(found[i].j[k] >= worst_.ratio)) worst_ = {found[i].j[k], here[i].face[k]};
    if (!(worst_.ratio > 0)) continue;  // laws know logarithms and roots
    finite::evaluate(*group.law, {found.data(), n}, stretch, of_cells_.empty(), {energy.data(), n});
    for (std::size_t i = 0; i < n; ++i) {
      finite::keep(energy[i], group.states[first + i]);
      if (!group.sheet.empty()) {
        balance(group.states[first + i]);
        group.sheet[first + i] = finite::sheet_of(group.states[first + i]);
      }
      for (int k = 0; k < 4; ++k) energy_ += group.own * here[i].volume[k] * energy[i].w[k];
    }
  }
}

template <int D>
void FiniteKernelOf<D>::internal_forces() {
  energy_ = 0;
  worst_ = {};
  std::ranges::fill(of_cells_, 0.0);
  for (finite::Group<D>& group : groups_) deform(group);
  for (std::size_t i = 0; i < elsewhere_.blocks.size(); ++i)
    finite::deformation<D>(elsewhere_.blocks[i], elsewhere_.blocks[i].inverse, space_.nodes(),
                           space_.points(), false, elsewhere_.states[i].f);
  if (edges_) {
    edges_->clear();
    for (const finite::Group<D>& group : groups_) finite::to_edges<D>(group, values(), false, *edges_);
    edges_->finish_means();
    if (worst_.ratio > 0) {
      const double least = edges_->to_stress(of_cells_.empty(), energy_);
      if (!(least >= worst_.ratio)) worst_.ratio = least;
    }
  }
  // Inside out somewhere: the forces are not used, but the other ranks wait.
  if (!of_cells_.empty()) find_pressures();
  if (has_start_) return conserving_forces();
  if (!(worst_.ratio > 0)) return;
  for (finite::Group<D>& group : groups_) {
    stress_pass(group, values());
    if (edges_) finite::from_edges<D>(group, values(), *edges_);
  }
}

template <int D>
void FiniteKernelOf<D>::linearise(std::span<const double> unknowns, std::span<const double> known,
                                  double mass_factor, std::span<double> result) {
  space_.fill(unknowns, known);
  space_.clear_forces();
  internal_forces();
  pressure_force_ = pressure_.add_forces(space_, 1);
  space_.add_springs(known);
  if (massive_ && mass_factor > 0) space_.add_mass_forces(mass_factor);
  space_.collect();
  space_.take_rows(unknowns, known, result);
}

template <int D>
void FiniteKernelOf<D>::apply_tangent(std::span<const double> v, std::span<const double> known,
                                      double mass_factor, std::span<double> result) {
  space_.fill(v, known);
  space_.clear_forces();
  if (!of_cells_.empty()) {
    sum_volume_changes();
    mesh_.cells.update_ghosts(std::span(of_cells_).first(std::size_t(mesh_.cells.n_local())));
  }
  for (const finite::Group<D>& group : groups_) tangent_pass(group, values());
  if (edges_) {
    edges_->clear();
    for (const finite::Group<D>& group : groups_) finite::to_edges<D>(group, values(), true, *edges_);
    edges_->finish_means();
    edges_->to_tangent();
    for (const finite::Group<D>& group : groups_) finite::from_edges<D>(group, values(), *edges_);
  }
  pressure_.add_tangent(space_, 1);
  space_.add_springs(known);
  if (massive_ && mass_factor > 0) space_.add_mass_forces(mass_factor);
  space_.collect();
  space_.take_rows(v, known, result);
}

/// With edges: what the face's share of them makes of both.
template <int D>
void FiniteKernelOf<D>::visit(const Take& take) {
  for (const finite::Group<D>& group : groups_)
    for (std::size_t i = 0; i < group.blocks.size(); ++i) {
      Four p[3][3];
      finite::stress<true>(group.states[i], p);
      for (int k = 0; k < 4; ++k) {
        if (group.blocks[i].face[k] < 0) continue;
        Tensor3 deformation, stress;
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b) {
            double f = group.states[i].f[a][b][k], s = group.own * p[a][b][k];
            if (!group.edges.empty()) {
              f = group.own * f + (a == b ? SharedEdges::share : 0);
              for (const Index edge : group.edges[i][std::size_t(k)]) {
                f += SharedEdges::share / 3 * edges_->gradient(edge)[a * 3 + b];
                s += SharedEdges::share / 3 * edges_->at(edge)[a * 3 + b];
              }
            }
            deformation(a, b) = f;
            stress(a, b) = s;
          }
        take(group.blocks[i].face[k], deformation, stress);
      }
    }
}

template class FiniteKernelOf<2>;
template class FiniteKernelOf<3>;

std::unique_ptr<FiniteKernel> make_finite_kernel(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                                 std::vector<const FiniteLaw*> of_materials,
                                                 bool plane_stress) {
  if (mesh.dim == 2)
    return std::make_unique<FiniteKernelOf<2>>(mesh, rows, std::move(of_materials), plane_stress);
  return std::make_unique<FiniteKernelOf<3>>(mesh, rows, std::move(of_materials), false);
}

}  // namespace couplet::elastic
