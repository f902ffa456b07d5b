// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "common/elasticity/finite/finite_places.hpp"
#include "common/elasticity/symmetric/face_groups.hpp"

/// Loops of FiniteKernel over faces of one material, four at a time.
namespace couplet::elastic::finite {

struct FaceSet : FaceGroup, Places {
  int dim = 3;
};

/// Input and output arrays of the loops.
struct Values {
  const double* values;
  double* forces;
  double* of_cells;  ///< nullptr if each face has its own volume ratio
};

/// F, or its change.
template <int D>
[[gnu::always_inline]] inline void deformation(const FaceBlock& block, const double* values, bool is_change,
                                               Tensor4& f) {
  Four g[D][D];
  blocks::gradient<D>(block, values, g);
  const Four one = Four{1, 1, 1, 1}, zero{};
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      f[a][b] = a == b && !is_change ? one : zero;
      if (a < D && b < D) f[a][b] += g[a < D ? a : 0][b < D ? b : 0];
    }
}

template <int D>
[[gnu::always_inline]] inline void push_stress(const FaceSet& group, std::size_t i, const Tensor4& p,
                                               const Four& share, double* forces) {
  const Four weight = share * blocks::wide(group.volumes[i].whole);
  Four scaled[D][D];
  for (int a = 0; a < D; ++a)
    for (int b = 0; b < D; ++b) scaled[a][b] = weight * p[a][b];
  blocks::push<D>(group.blocks[i], scaled, forces);
}

inline void push_stress(const FaceSet& group, std::size_t i, const Tensor4& p, const Four& share,
                        double* forces) {
  group.dim == 2 ? push_stress<2>(group, i, p, share, forces) : push_stress<3>(group, i, p, share, forces);
}

inline Four between(const FaceSet& group, std::size_t i, const double* of_nodes) {
  return blocks::between(group.blocks[i], group.volumes[i], of_nodes);
}

/// Computes F and the invariants of some blocks. Adds V_fP J to the cells.
template <int D>
[[gnu::always_inline]] inline void deform_loop(FaceSet& group, std::size_t first, const Values& at,
                                               std::span<Invariants> found) {
  for (std::size_t i = 0; i < found.size(); ++i) {
    StrainState& state = group.states[first + i];
    deformation<D>(group.blocks[first + i], at.values, false, state.f);
    found[i] = invariants(state.f);
    if (at.of_cells)
      blocks::add_to_cells(group.blocks[first + i], group.volumes[first + i], found[i].j, at.of_cells);
  }
}

template <int D, bool HasSecond>
[[gnu::always_inline]] inline void stress_loop(FaceSet& group, const Values& at) {
  for (std::size_t i = 0; i < group.blocks.size(); ++i) {
    const Four own = blocks::wide(group.volumes[i].own);
    Four p[3][3];
    if (at.of_cells)
      group.states[i].wj += blocks::between(group.blocks[i], group.volumes[i], at.of_cells) / own;
    stress<HasSecond>(group.states[i], p);
    push_stress<D>(group, i, p, own, at.forces);
  }
}

/// Adds the forces p H of the cell pressures.
inline void pressure_loop(const FaceSet& group, const Values& at) {
  for (std::size_t i = 0; i < group.blocks.size(); ++i) {
    Four h[3][3];
    cofactors(group.states[i].f, h);
    const Four p = between(group, i, at.of_cells);
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) h[a][b] *= p;
    push_stress(group, i, h, Four{1, 1, 1, 1}, at.forces);
  }
}

/// Adds V_fP dJ to the cells.
template <int D>
[[gnu::always_inline]] inline void volume_loop(const FaceSet& group, const Values& at) {
  for (std::size_t i = 0; i < group.blocks.size(); ++i) {
    Four df[3][3], h[3][3];
    deformation<D>(group.blocks[i], at.values, true, df);
    cofactors(group.states[i].f, h);
    blocks::add_to_cells(group.blocks[i], group.volumes[i], product(h, df), at.of_cells);
  }
}

template <int D, bool HasSecond>
[[gnu::always_inline]] inline void tangent_loop(const FaceSet& group, const Values& at) {
  for (std::size_t i = 0; i < group.blocks.size(); ++i) {
    const Four own = blocks::wide(group.volumes[i].own);
    Four df[3][3], dp[3][3], dpressure{};
    deformation<D>(group.blocks[i], at.values, true, df);
    if (at.of_cells) dpressure = blocks::between(group.blocks[i], group.volumes[i], at.of_cells) / own;
    tangent<HasSecond>(group.states[i], df, dpressure, dp);
    if (D == 2 && !group.sheet.empty()) condense(group.sheet[i], df, dp);
    push_stress<D>(group, i, dp, own, at.forces);
  }
}

/// Adds t V / 3 (F - I), or its change, to the edges, gradient_stride numbers each.
[[gnu::always_inline]] inline void to_edges(const FaceGroup& group, const double* values, double* edges) {
  for (std::size_t i = 0; i < group.edges.size(); ++i) {
    Four g[3][3];
    blocks::gradient<3>(group.blocks[i], values, g);
    const Four part = blocks::part_of_edges(group.volumes[i]);
    for (int k = 0; k < 4; ++k)
      for (const Index e : group.edges[i][std::size_t(k)])
        for (int a = 0; a < 9; ++a)
          edges[std::size_t(e) * SharedEdges::gradient_stride + a] += part[k] * g[a / 3][a % 3][k];
  }
}

/// Adds the forces of the edges' stress to the nodes.
[[gnu::always_inline]] inline void from_edges(const FaceGroup& group, const double* edges, double* forces) {
  for (std::size_t i = 0; i < group.edges.size(); ++i) {
    Four p[3][3] = {};
    for (int k = 0; k < 4; ++k)
      for (const Index e : group.edges[i][std::size_t(k)])
        for (int a = 0; a < 9; ++a)
          p[a / 3][a % 3][k] += edges[std::size_t(e) * SharedEdges::gradient_stride + a];
    const Four weight = blocks::part_of_edges(group.volumes[i]);
    for (int a = 0; a < 9; ++a) p[a / 3][a % 3] *= weight;
    blocks::push<3>(group.blocks[i], p, forces);
  }
}

/// F at the end of a step.
inline void end_of(const FaceSet& group, std::size_t i, Tensor4& f) {
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) f[a][b] = 2.0 * group.states[i].f[a][b] - group.start[i].f[a][b];
}

/// Adds V_fP J at the start and end of a step to the cells.
inline void end_volumes(const FaceSet& group, double* at_start, double* at_end) {
  for (std::size_t i = 0; i < group.blocks.size(); ++i) {
    Four f[3][3];
    end_of(group, i, f);
    blocks::add_to_cells(group.blocks[i], group.volumes[i], invariants(group.start[i].f).j, at_start);
    blocks::add_to_cells(group.blocks[i], group.volumes[i], invariants(f).j, at_end);
  }
}

/// Smallest det F at the end of a step.
inline double least_end_ratio(const FaceSet& group) {
  double least = 1;
  for (std::size_t i = 0; i < group.blocks.size(); ++i) {
    Four f[3][3];
    end_of(group, i, f);
    const Four j = invariants(f).j;
    for (int k = 0; k < 4; ++k)
      if (!(j[k] >= least)) least = j[k];
  }
  return least;
}

/// Adds the forces of an energy-conserving step, which replace those of the midpoint states. `at.of_cells`
/// holds the conserving pressure p* of the cells.
inline void conserving_loop(const FaceSet& group, const Values& at) {
  for (std::size_t i = 0; i < group.blocks.size(); ++i) {
    Four p[3][3];
    const Four own = blocks::wide(group.volumes[i].own);
    const Four pressure = at.of_cells ? between(group, i, at.of_cells) / own : Four{};
    conserving_stress(*group.law, group.states[i].f, group.start[i].f, group.start[i].energy, !at.of_cells,
                      pressure, p);
    push_stress(group, i, p, own, at.forces);
  }
}

}  // namespace couplet::elastic::finite
