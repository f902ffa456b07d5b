// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/finite_kernel.hpp"

#include <algorithm>
#include <array>

#include "common/elasticity/finite_edges.hpp"
#include "common/elasticity/finite_strain.hpp"
#include "common/elasticity/follower_pressure.hpp"
#include "common/elasticity/symmetric_blocks.hpp"
#include "common/elasticity/symmetric_space.hpp"
#include "common/parallel/collective.hpp"

namespace couplet {
namespace {

// Blocks that a law evaluates in one call: their numbers stay in the first cache.
constexpr std::size_t chunk = 16;

template <int D>
struct FiniteBlock : BlockGeometry<D> {
  double inverse[4];         ///< 1 / (S . d)
  double weight[4];          ///< V / (S . d)
  double volume[4];          ///< V
  double here[4], there[4];  ///< V_fP of both sides over V; of one volume ratio a cell
  Index face[4];             ///< -1: filling
};

/// Faces of one material.
template <int D>
struct Group {
  const FiniteLaw* law;
  std::vector<FiniteBlock<D>> blocks;
  std::vector<finite::State> states;
  double own = 1;                                          ///< share of their energy that is not the edges'
  std::vector<std::array<std::array<Index, 3>, 4>> edges;  ///< of each block; empty: they share nothing
};

template <int D>
[[gnu::always_inline]] inline void deformation(const BlockGeometry<D>& block, const double* inverse,
                                               const double* nodes, const double* points, bool is_change,
                                               Four (&f)[3][3]) {
  Four h[D][D];
  blocks::stretch<D>(block, nodes, points, h);
  const Four scale = blocks::wide(inverse), one = Four{1, 1, 1, 1}, zero{};
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      f[a][b] = a == b && !is_change ? one : zero;
      if (a < D && b < D) f[a][b] += scale * h[a < D ? a : 0][b < D ? b : 0];
    }
}

template <int D>
[[gnu::always_inline]] inline void push_stress(const FiniteBlock<D>& block, const Four (&p)[3][3],
                                               double share, double* forces, double* point_forces) {
  const Four weight = share * blocks::wide(block.weight);
  Four scaled[D][D];
  for (int a = 0; a < D; ++a)
    for (int b = 0; b < D; ++b) scaled[a][b] = weight * p[a][b];
  blocks::push<D>(block, scaled, forces, point_forces);
}

/// (V_fP p_P + V_fQ p_Q) / V of values of cells.
template <int D>
[[gnu::always_inline]] inline Four between(const FiniteBlock<D>& block, const double* of_nodes) {
  double here[4], there[4];
  for (int k = 0; k < 4; ++k) {
    here[k] = of_nodes[std::size_t(block.from[k])];
    there[k] = of_nodes[std::size_t(block.to[k])];
  }
  return blocks::wide(block.here) * blocks::wide(here) + blocks::wide(block.there) * blocks::wide(there);
}

template <int D>
struct Values {
  const double *nodes, *points;
  double *forces, *point_forces;
  double* of_cells;  ///< null: the volume ratio is the faces'
};

/// F and the invariants of some blocks; adds V_fP J to the cells.
template <int D>
[[gnu::always_inline]] inline void deform_loop(std::span<const FiniteBlock<D>> blocks, const Values<D>& at,
                                               finite::State* states, Invariants* found) {
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    deformation<D>(blocks[i], blocks[i].inverse, at.nodes, at.points, false, states[i].f);
    found[i] = finite::invariants(states[i].f);
    if (!at.of_cells) continue;
    for (int k = 0; k < 4; ++k) {
      const double whole = blocks[i].volume[k] * found[i].j[k];
      at.of_cells[std::size_t(blocks[i].from[k])] += blocks[i].here[k] * whole;
      at.of_cells[std::size_t(blocks[i].to[k])] += blocks[i].there[k] * whole;
    }
  }
}

template <int D, bool HasSecond>
[[gnu::always_inline]] inline void stress_loop(Group<D>& group, const Values<D>& at) {
  for (std::size_t i = 0; i < group.blocks.size(); ++i) {
    Four p[3][3];
    if (at.of_cells) group.states[i].wj += between<D>(group.blocks[i], at.of_cells) / group.own;
    finite::stress<HasSecond>(group.states[i], p);
    push_stress<D>(group.blocks[i], p, group.own, at.forces, at.point_forces);
  }
}

/// V_fP dJ to the cells.
template <int D>
[[gnu::always_inline]] inline void volume_loop(const Group<D>& group, const Values<D>& at) {
  for (std::size_t i = 0; i < group.blocks.size(); ++i) {
    const FiniteBlock<D>& block = group.blocks[i];
    Four df[3][3], h[3][3];
    deformation<D>(block, block.inverse, at.nodes, at.points, true, df);
    finite::cofactors(group.states[i].f, h);
    const Four dj = finite::product(h, df) * blocks::wide(block.volume);
    for (int k = 0; k < 4; ++k) {
      at.of_cells[std::size_t(block.from[k])] += block.here[k] * dj[k];
      at.of_cells[std::size_t(block.to[k])] += block.there[k] * dj[k];
    }
  }
}

template <int D, bool HasSecond>
[[gnu::always_inline]] inline void tangent_loop(const Group<D>& group, const Values<D>& at) {
  for (std::size_t i = 0; i < group.blocks.size(); ++i) {
    const FiniteBlock<D>& block = group.blocks[i];
    Four df[3][3], dp[3][3];
    deformation<D>(block, block.inverse, at.nodes, at.points, true, df);
    const Four dpressure = at.of_cells ? between<D>(block, at.of_cells) / group.own : Four{};
    finite::tangent<HasSecond>(group.states[i], df, dpressure, dp);
    push_stress<D>(block, dp, group.own, at.forces, at.point_forces);
  }
}

/// t V / 3 (F - I), or its change, to the edges. `nodes` null: from the states.
template <int D>
void to_edges(const Group<D>& group, const Values<D>& at, bool is_change, FiniteEdges& edges) {
  if constexpr (D == 3)
    for (std::size_t i = 0; i < group.edges.size(); ++i) {
      Four df[3][3];
      deformation<D>(group.blocks[i], group.blocks[i].inverse, at.nodes, at.points, is_change, df);
      const double one = is_change ? 0 : 1;
      for (int k = 0; k < 4; ++k) {
        const double part = SharedEdges::share / 3 * group.blocks[i].volume[k];
        for (const Index e : group.edges[i][k])
          for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b) edges.at(e)[a * 3 + b] += part * (df[a][b][k] - (a == b ? one : 0));
      }
    }
}

/// What the edges' stress does to the nodes.
template <int D>
void from_edges(const Group<D>& group, const Values<D>& at, FiniteEdges& edges) {
  for (std::size_t i = 0; i < group.edges.size(); ++i) {
    Four p[3][3] = {};
    for (int k = 0; k < 4; ++k)
      for (const Index e : group.edges[i][k])
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b) p[a][b][k] += edges.at(e)[a * 3 + b];
    push_stress<D>(group.blocks[i], p, SharedEdges::share / 3, at.forces, at.point_forces);
  }
}

// The loops for several generations of processors; the right one is picked when the program starts.
[[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]] void deform_pass(
    std::span<const FiniteBlock<3>> blocks, const Values<3>& at, finite::State* states, Invariants* found) {
  deform_loop<3>(blocks, at, states, found);
}
[[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]] void deform_pass(
    std::span<const FiniteBlock<2>> blocks, const Values<2>& at, finite::State* states, Invariants* found) {
  deform_loop<2>(blocks, at, states, found);
}
[[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]] void stress_pass(Group<3>& group,
                                                                                       const Values<3>& at) {
  group.law->has_second_invariant() ? stress_loop<3, true>(group, at) : stress_loop<3, false>(group, at);
}
[[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]] void stress_pass(Group<2>& group,
                                                                                       const Values<2>& at) {
  group.law->has_second_invariant() ? stress_loop<2, true>(group, at) : stress_loop<2, false>(group, at);
}
[[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]] void volume_pass(const Group<3>& group,
                                                                                       const Values<3>& at) {
  volume_loop<3>(group, at);
}
[[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]] void volume_pass(const Group<2>& group,
                                                                                       const Values<2>& at) {
  volume_loop<2>(group, at);
}
[[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]] void tangent_pass(const Group<3>& group,
                                                                                        const Values<3>& at) {
  group.law->has_second_invariant() ? tangent_loop<3, true>(group, at) : tangent_loop<3, false>(group, at);
}
[[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]] void tangent_pass(const Group<2>& group,
                                                                                        const Values<2>& at) {
  group.law->has_second_invariant() ? tangent_loop<2, true>(group, at) : tangent_loop<2, false>(group, at);
}

template <int D>
class Implementation final : public FiniteKernel {
 public:
  Implementation(const Mesh& mesh, const ElasticOperator& rows, std::vector<const FiniteLaw*> laws);

  void set_pressure(std::span<const double> of_faces) override { pressure_.set(mesh_, of_faces); }
  bool has_pressure() const override { return !pressure_.empty(); }
  Vec3 pressure_force() const override { return pressure_force_; }
  void set_density(std::span<const double> of_cells) override {
    space_.set_density(of_cells), massive_ = true;
  }
  void linearise(std::span<const double> unknowns, std::span<const double> known, double mass_factor,
                 std::span<double> result) override;
  void apply_tangent(std::span<const double> v, std::span<const double> known, double mass_factor,
                     std::span<double> result) override;
  double energy() const override { return energy_; }
  Worst worst() const override { return worst_; }
  void visit(const Take& take) override;
  Vec3 displacement(Index node) const override {
    Vec3 u = Vec3::Zero();
    for (int a = 0; a < D; ++a) u[a] = space_.nodes()[std::size_t(node) * SymmetricSpace<D>::stride + a];
    return u;
  }
  std::vector<Vec3> holding_forces(std::span<const double> unknowns, std::span<const double> known,
                                   const ElasticLoads& loads) override;

 private:
  void make_group(std::size_t material, bool shares, std::span<const Index> edge_index);
  void make_edges(std::vector<Index>& edge_index);
  void internal_forces();
  void deform(Group<D>& group);
  void find_pressures();
  Values<D> values();
  const FiniteLaw& law_of(Index cell) const {
    return *laws_[laws_.size() == 1 ? 0 : std::size_t(mesh_.material_of(cell))];
  }

  const Mesh& mesh_;
  const ElasticOperator& rows_;
  SymmetricSpace<D> space_;
  std::vector<const FiniteLaw*> laws_;
  std::vector<Group<D>> groups_;
  std::unique_ptr<FiniteEdges> edges_;  // none: no three-cornered faces in space
  FollowerPressure<D> pressure_;
  Vec3 pressure_force_ = Vec3::Zero();
  bool massive_ = false;
  double energy_ = 0;
  Worst worst_;
  std::vector<double> of_cells_, volume_;  // of nodes: sums, then pressures; of owned cells; empty: faces'
  std::vector<double> modulus_;            // U'' / V of owned cells at the last linearise()
};

template <int D>
FiniteBlock<D>& place(std::vector<FiniteBlock<D>>& blocks, std::size_t i) {
  if (i % 4 == 0) blocks.emplace_back();
  return blocks.back();
}

template <int D>
void add_face(const Mesh& mesh, const ElasticOperator& rows, Index f, std::size_t k, bool is_filling,
              FiniteBlock<D>& block) {
  const SymmetricFace<D> face = symmetric_face<D>(mesh, rows, f);
  set_geometry<D>(mesh, face, f, k, is_filling, block);
  const auto [here, there] = pyramids(mesh, f);
  block.inverse[k] = is_filling ? 0 : face.inverse;
  block.volume[k] = is_filling ? 0 : face.volume;
  block.weight[k] = is_filling ? 0 : face.volume * face.inverse;
  block.here[k] = is_filling ? 0 : here / face.volume;
  block.there[k] = is_filling ? 0 : there / face.volume;
  block.face[k] = is_filling ? -1 : f;
}

template <int D>
Implementation<D>::Implementation(const Mesh& mesh, const ElasticOperator& rows,
                                  std::vector<const FiniteLaw*> laws)
    : mesh_(mesh), rows_(rows), space_(mesh, rows), laws_(std::move(laws)) {
  std::vector<Index> edge_index;
  make_edges(edge_index);
  for (std::size_t m = 0; m < laws_.size(); ++m) {
    make_group(m, false, edge_index);
    if (edges_) make_group(m, true, edge_index);
  }
  if (!rows.volume_by_cells()) return;
  of_cells_.assign(space_.n_nodes(), 0);
  volume_ = pyramid_volumes(mesh);
  modulus_.assign(volume_.size(), 0);
}

/// Faces of one material, those that share with edges or the others.
template <int D>
void Implementation<D>::make_group(std::size_t material, bool shares, std::span<const Index> edge_index) {
  Group<D> group{laws_[material], {}, {}, shares ? 1 - SharedEdges::share : 1, {}};
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
  groups_.push_back(std::move(group));
}

/// `edge_index`: of each flux face among those that share, -1: it does not. Collective.
template <int D>
void Implementation<D>::make_edges(std::vector<Index>& edge_index) {
  if (D == 2) return;
  std::vector<Index> faces, elsewhere;
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f)
    if (mesh_.face_points[f].size() == 3)
      (mesh_.owner[f] < mesh_.cells.n_owned() ? faces : elsewhere).push_back(f);
  if (!any(mesh_.comm, !faces.empty())) return;
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
Values<D> Implementation<D>::values() {
  return {space_.nodes(), space_.points(), space_.forces(), space_.point_forces(),
          of_cells_.empty() ? nullptr : of_cells_.data()};
}

/// States, energy and the worst volume ratio of one material's faces.
template <int D>
void Implementation<D>::deform(Group<D>& group) {
  std::array<Invariants, chunk> found;
  std::array<Energy, chunk> energy;
  for (std::size_t first = 0; first < group.blocks.size(); first += chunk) {
    const std::size_t n = std::min(chunk, group.blocks.size() - first);
    const std::span<const FiniteBlock<D>> here(group.blocks.data() + first, n);
    deform_pass(here, values(), group.states.data() + first, found.data());
    for (std::size_t i = 0; i < n; ++i)
      for (int k = 0; k < 4; ++k)
        if (!(found[i].j[k] >= worst_.ratio)) worst_ = {found[i].j[k], here[i].face[k]};
    if (!(worst_.ratio > 0)) continue;  // laws know logarithms and roots
    group.law->evaluate({found.data(), n}, of_cells_.empty(), {energy.data(), n});
    for (std::size_t i = 0; i < n; ++i) {
      finite::keep(energy[i], group.states[first + i]);
      for (int k = 0; k < 4; ++k) energy_ += group.own * here[i].volume[k] * energy[i].w[k];
    }
  }
}

/// From V J of the cells to U'(J).
template <int D>
void Implementation<D>::find_pressures() {
  const std::span<double> cells = std::span(of_cells_).first(std::size_t(mesh_.cells.n_local()));
  mesh_.cells.add_to_owners(cells);
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    const BulkOf<double> bulk = law_of(c).bulk(cells[c] / volume_[c]);
    cells[c] = bulk.pressure;
    modulus_[c] = bulk.modulus / volume_[c];
    energy_ += volume_[c] * bulk.u;
  }
  mesh_.cells.update_ghosts(cells);
}

template <int D>
void Implementation<D>::internal_forces() {
  energy_ = 0;
  worst_ = {};
  std::ranges::fill(of_cells_, 0.0);
  for (Group<D>& group : groups_) deform(group);
  if (edges_) {
    edges_->clear();
    for (const Group<D>& group : groups_) to_edges<D>(group, values(), false, *edges_);
    edges_->finish_means();
    if (worst_.ratio > 0) {
      const double least = edges_->to_stress(of_cells_.empty(), energy_);
      if (!(least >= worst_.ratio)) worst_.ratio = least;
    }
  }
  // Inside out somewhere: the forces are not used, but the other ranks wait.
  if (!of_cells_.empty()) find_pressures();
  if (!(worst_.ratio > 0)) return;
  for (Group<D>& group : groups_) {
    stress_pass(group, values());
    if (edges_) from_edges<D>(group, values(), *edges_);
  }
}

template <int D>
void Implementation<D>::linearise(std::span<const double> unknowns, std::span<const double> known,
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
void Implementation<D>::apply_tangent(std::span<const double> v, std::span<const double> known,
                                      double mass_factor, std::span<double> result) {
  space_.fill(v, known);
  space_.clear_forces();
  if (!of_cells_.empty()) {
    std::ranges::fill(of_cells_, 0.0);
    for (const Group<D>& group : groups_) volume_pass(group, values());
    const std::span<double> cells = std::span(of_cells_).first(std::size_t(mesh_.cells.n_local()));
    mesh_.cells.add_to_owners(cells);
    for (std::size_t c = 0; c < modulus_.size(); ++c) cells[c] *= modulus_[c];
    mesh_.cells.update_ghosts(cells);
  }
  for (const Group<D>& group : groups_) tangent_pass(group, values());
  if (edges_) {
    edges_->clear();
    for (const Group<D>& group : groups_) to_edges<D>(group, values(), true, *edges_);
    edges_->finish_means();
    edges_->to_tangent();
    for (const Group<D>& group : groups_) from_edges<D>(group, values(), *edges_);
  }
  pressure_.add_tangent(space_, 1);
  space_.add_springs(known);
  if (massive_ && mass_factor > 0) space_.add_mass_forces(mass_factor);
  space_.collect();
  space_.take_rows(v, known, result);
}

/// With edges: what the face's share of them makes of both.
template <int D>
void Implementation<D>::visit(const Take& take) {
  for (const Group<D>& group : groups_)
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

template <int D>
std::vector<Vec3> Implementation<D>::holding_forces(std::span<const double> unknowns,
                                                    std::span<const double> known,
                                                    const ElasticLoads& loads) {
  space_.clear_forces();
  if (!loads.faces.empty()) space_.spread_face_forces(loads.faces);
  if (!loads.cells.empty()) space_.spread_cell_forces(loads.cells);
  space_.negate_forces();
  space_.fill(unknowns, known);
  internal_forces();
  pressure_force_ = pressure_.add_forces(space_, 1);
  space_.add_springs(known);
  return space_.held(known);
}

}  // namespace

std::unique_ptr<FiniteKernel> make_finite_kernel(const Mesh& mesh, const ElasticOperator& rows,
                                                 std::vector<const FiniteLaw*> of_materials) {
  if (mesh.dim == 2) return std::make_unique<Implementation<2>>(mesh, rows, std::move(of_materials));
  return std::make_unique<Implementation<3>>(mesh, rows, std::move(of_materials));
}

}  // namespace couplet
