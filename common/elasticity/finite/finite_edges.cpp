// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/finite/finite_edges.hpp"

#include <algorithm>

namespace couplet::elastic {
namespace {

/// Gathers the tensors of four edges as components.
void gather(const double* values, const std::array<Index, 4>& at, bool is_change, Four (&t)[3][3]) {
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      for (int k = 0; k < 4; ++k)
        t[a][b][k] = values[std::size_t(at[k]) * SharedEdges::gradient_stride + std::size_t(a * 3 + b)] +
                     (a == b && !is_change ? 1 : 0);
}

void scatter(const Four (&t)[3][3], const std::array<Index, 4>& at, double* values) {
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      for (int k = 0; k < 4; ++k)
        values[std::size_t(at[k]) * SharedEdges::gradient_stride + std::size_t(a * 3 + b)] = t[a][b][k];
}

}  // namespace

FiniteEdges::FiniteEdges(const mesh::Mesh& mesh, const ElasticOperator& rows, std::span<const Index> faces,
                         std::span<const double> volume, std::span<const FiniteLaw* const> laws)
    : edges_(mesh, rows, faces, volume),
      value_(edges_.n_edges() * SharedEdges::gradient_stride, 0),
      kept_(value_) {
  std::vector<int> material(edges_.n_edges(), 0);
  if (laws.size() > 1)
    for (std::size_t i = 0; i < faces.size(); ++i)
      for (const Index e : edges_.edges_of(i)) material[e] = mesh.material_of(mesh.owner[faces[i]]);
  for (std::size_t m = 0; m < laws.size(); ++m) {
    Group group;
    group.law = laws[m];
    Index last = -1;  // padding uses the last edge of the block
    std::size_t n = 0;
    const auto add = [&](Index e, double of_edge) {
      if (n % 4 == 0) group.edges.emplace_back(), group.volume.emplace_back();
      group.edges.back()[n % 4] = e;
      group.volume.back()[n % 4] = of_edge;
      ++n;
    };
    for (Index e = 0; e < Index(material.size()); ++e) {
      if (material[e] != int(m)) continue;
      last = e;
      add(e, edges_.is_owned(e) ? edges_.volume(e) : 0);
    }
    while (n % 4 != 0) add(last, 0);
    group.states.resize(group.edges.size());
    groups_.push_back(std::move(group));
  }
}

void FiniteEdges::take_stretch() {
  for (Group& group : groups_) {
    group.stretch.resize(group.edges.size());
    for (std::size_t i = 0; i < group.edges.size(); ++i)
      for (int k = 0; k < 4; ++k) group.stretch[i][k] = 1 + at(group.edges[i][std::size_t(k)])[0];
  }
}

void FiniteEdges::forget_stretch() {
  for (Group& group : groups_) group.stretch.clear();
}

double FiniteEdges::to_stress(bool with_bulk, double& energy) {
  double least = 1;
  std::ranges::copy(value_, kept_.begin());
  for (Group& group : groups_)
    for (std::size_t i = 0; i < group.edges.size(); ++i) {
      finite::State& state = group.states[i];
      gather(kept_.data(), group.edges[i], false, state.f);
      Invariants at = finite::invariants(state.f);
      for (int k = 0; k < 4; ++k)
        if (!(at.j[k] >= least)) least = at.j[k];
      if (!(least > 0)) return least;
      Energy e;
      group.evaluate(i, {&at, 1}, with_bulk, {&e, 1});
      for (int k = 0; k < 4; ++k) energy += group.volume[i][k] * e.w[k];
      Four p[3][3];
      group.law->has_second_invariant() ? finite::stress<true>(state, p) : finite::stress<false>(state, p);
      scatter(p, group.edges[i], value_.data());
    }
  return least;
}

void FiniteEdges::set_start(bool with_bulk) {
  for (Group& group : groups_) group.set_start(with_bulk);
}

void FiniteEdges::to_conserving(bool with_bulk) {
  for (const Group& group : groups_)
    for (std::size_t i = 0; i < group.edges.size(); ++i) {
      Four p[3][3];
      finite::conserving_stress(*group.law, group.states[i].f, group.start[i].f, group.start[i].energy,
                                with_bulk, Four{}, p);
      scatter(p, group.edges[i], value_.data());
    }
}

void FiniteEdges::to_tangent() {
  for (const Group& group : groups_)
    for (std::size_t i = 0; i < group.edges.size(); ++i) {
      Four df[3][3], dp[3][3];
      gather(value_.data(), group.edges[i], true, df);
      group.law->has_second_invariant() ? finite::tangent<true>(group.states[i], df, Four{}, dp)
                                        : finite::tangent<false>(group.states[i], df, Four{}, dp);
      scatter(dp, group.edges[i], value_.data());
    }
}

}  // namespace couplet::elastic
