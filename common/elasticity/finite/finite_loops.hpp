// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "common/elasticity/finite/finite_edges.hpp"
#include "common/elasticity/finite/finite_sheet.hpp"
#include "common/elasticity/finite/finite_strain.hpp"
#include "common/elasticity/symmetric/shared_edges.hpp"
#include "common/elasticity/symmetric/symmetric_blocks.hpp"

/// Loops of FiniteKernel over faces of one material, four side by side.
namespace couplet::elastic::finite {

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
  const FiniteLaw* law = nullptr;
  std::vector<FiniteBlock<D>> blocks;
  std::vector<State> states;
  std::vector<Start> start;   ///< of the step; empty: its stress is that of the states
  std::vector<Four> stretch;  ///< thermal, of each block; empty: none
  std::vector<Sheet> sheet;   ///< plane stress; empty: none
  double thinning = 0;        ///< of the law, plane stress
  double own = 1;             ///< share of their energy that is not the edges'
  std::vector<std::array<std::array<Index, 3>, 4>> edges;  ///< of each block; empty: they share nothing
};

template <int D>
std::vector<FiniteBlock<D>> make_finite_blocks(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                               std::span<const Index> faces) {
  std::vector<FiniteBlock<D>> blocks((faces.size() + 3) / 4);
  for (std::size_t i = 0; i < blocks.size() * 4; ++i) {
    const bool is_filling = i >= faces.size();
    const Index f = is_filling ? faces.back() : faces[i];
    const std::size_t k = i % 4;
    FiniteBlock<D>& block = blocks[i / 4];
    const SymmetricFace<D> face = symmetric_face<D>(mesh, rows, f);
    set_geometry<D>(mesh, face, f, k, is_filling, block);
    const auto [here, there] = pyramids(mesh, rows.geometry(), f);
    block.inverse[k] = is_filling ? 0 : face.inverse;
    block.volume[k] = is_filling ? 0 : face.volume;
    block.weight[k] = is_filling ? 0 : face.volume * face.inverse;
    block.here[k] = is_filling ? 0 : here / face.volume;
    block.there[k] = is_filling ? 0 : there / face.volume;
    block.face[k] = is_filling ? -1 : f;
  }
  return blocks;
}

/// Collects this rank's flux faces with takes(f): those that share with `edges`, or the others if none are given.
template <int D, class Takes>
Group<D> make_group(const mesh::Mesh& mesh, const ElasticOperator& rows, const SharedFaces& shared,
                    const SharedEdges* edges, const Takes& takes) {
  Group<D> group;
  const auto end = shared.faces.begin() + std::ptrdiff_t(shared.n_mine);
  std::vector<Index> faces;
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    if (mesh.owner[f] >= mesh.cells.n_owned() || !takes(f)) continue;
    if ((D == 3 && mesh.face_points[f].size() == 3) == (edges != nullptr)) faces.push_back(f);
  }
  group.blocks = make_finite_blocks<D>(mesh, rows, faces);
  if (!edges) return group;
  group.own = 1 - SharedEdges::share;
  group.edges.resize(group.blocks.size());
  for (std::size_t i = 0; i < group.edges.size() * 4; ++i) {
    const Index f = faces[std::min(i, faces.size() - 1)];
    const auto at = std::lower_bound(shared.faces.begin(), end, f) - shared.faces.begin();
    group.edges[i / 4][i % 4] = edges->edges_of(std::size_t(at));
  }
  return group;
}

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
                                               State* states, Invariants* found) {
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    deformation<D>(blocks[i], blocks[i].inverse, at.nodes, at.points, false, states[i].f);
    found[i] = invariants(states[i].f);
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
    stress<HasSecond>(group.states[i], p);
    push_stress<D>(group.blocks[i], p, group.own, at.forces, at.point_forces);
  }
}

/// The forces of a pressure of the cells alone: p H.
template <int D>
void pressure_loop(const Group<D>& group, const Values<D>& at) {
  for (std::size_t i = 0; i < group.blocks.size(); ++i) {
    Four h[3][3];
    cofactors(group.states[i].f, h);
    const Four p = between<D>(group.blocks[i], at.of_cells);
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) h[a][b] *= p;
    push_stress<D>(group.blocks[i], h, 1, at.forces, at.point_forces);
  }
}

/// V_fP dJ to the cells.
template <int D>
[[gnu::always_inline]] inline void volume_loop(const Group<D>& group, const Values<D>& at) {
  for (std::size_t i = 0; i < group.blocks.size(); ++i) {
    const FiniteBlock<D>& block = group.blocks[i];
    Four df[3][3], h[3][3];
    deformation<D>(block, block.inverse, at.nodes, at.points, true, df);
    cofactors(group.states[i].f, h);
    const Four dj = product(h, df) * blocks::wide(block.volume);
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
    tangent<HasSecond>(group.states[i], df, dpressure, dp);
    if (D == 2 && !group.sheet.empty()) condense(group.sheet[i], df, dp);
    push_stress<D>(block, dp, group.own, at.forces, at.point_forces);
  }
}

/// t V / 3 (F - I), or its change, to the edges, gradient_stride numbers each.
template <int D>
void to_edges(const Group<D>& group, const Values<D>& at, bool is_change, double* edges) {
  if constexpr (D == 3)
    for (std::size_t i = 0; i < group.edges.size(); ++i) {
      Four df[3][3];
      deformation<D>(group.blocks[i], group.blocks[i].inverse, at.nodes, at.points, is_change, df);
      const double one = is_change ? 0 : 1;
      for (int k = 0; k < 4; ++k) {
        const double part = SharedEdges::share / 3 * group.blocks[i].volume[k];
        for (const Index e : group.edges[i][k])
          for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b)
              edges[std::size_t(e) * SharedEdges::gradient_stride + a * 3 + b] +=
                  part * (df[a][b][k] - (a == b ? one : 0));
      }
    }
}

/// What the edges' stress does to the nodes.
template <int D>
void from_edges(const Group<D>& group, const Values<D>& at, const double* edges) {
  for (std::size_t i = 0; i < group.edges.size(); ++i) {
    Four p[3][3] = {};
    for (int k = 0; k < 4; ++k)
      for (const Index e : group.edges[i][k])
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b)
            p[a][b][k] += edges[std::size_t(e) * SharedEdges::gradient_stride + a * 3 + b];
    push_stress<D>(group.blocks[i], p, SharedEdges::share / 3, at.forces, at.point_forces);
  }
}

/// V_fP J to the cells, at the start of a step or at its end 2 F - F_0.
template <int D>
void end_volumes(const Group<D>& group, bool at_end, std::vector<double>& of_cells) {
  for (std::size_t i = 0; i < group.blocks.size(); ++i) {
    const FiniteBlock<D>& block = group.blocks[i];
    Four f[3][3];
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        f[a][b] = at_end ? 2.0 * group.states[i].f[a][b] - group.start[i].f[a][b] : group.start[i].f[a][b];
    const Four whole = invariants(f).j * blocks::wide(block.volume);
    for (int k = 0; k < 4; ++k) {
      of_cells[std::size_t(block.from[k])] += block.here[k] * whole[k];
      of_cells[std::size_t(block.to[k])] += block.there[k] * whole[k];
    }
  }
}

/// The smallest det F at the end of a step.
template <int D>
double least_end_ratio(const Group<D>& group) {
  double least = 1;
  for (std::size_t i = 0; i < group.blocks.size(); ++i) {
    Four f[3][3];
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) f[a][b] = 2.0 * group.states[i].f[a][b] - group.start[i].f[a][b];
    const Four j = invariants(f).j;
    for (int k = 0; k < 4; ++k)
      if (!(j[k] >= least)) least = j[k];
  }
  return least;
}

template <int D>
void add_pressures(Group<D>& group, const double* of_cells) {
  for (std::size_t i = 0; i < group.blocks.size(); ++i)
    group.states[i].wj += between<D>(group.blocks[i], of_cells) / group.own;
}

/// The forces of a step that conserves energy: in place of those of the states in its middle. `change`: p* of the
/// cells in `at.of_cells`.
template <int D>
void conserving_loop(const Group<D>& group, const Values<D>& at) {
  for (std::size_t i = 0; i < group.blocks.size(); ++i) {
    Four p[3][3];
    const Four pressure = at.of_cells ? between<D>(group.blocks[i], at.of_cells) / group.own : Four{};
    conserving_stress(*group.law, group.states[i].f, group.start[i].f, group.start[i].energy, !at.of_cells,
                      pressure, p);
    push_stress<D>(group.blocks[i], p, group.own, at.forces, at.point_forces);
  }
}

}  // namespace couplet::elastic::finite
