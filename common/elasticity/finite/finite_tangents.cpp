// SPDX-License-Identifier: Apache-2.0
// dP/dF of the faces, for an assembled tangent.
#include "common/elasticity/finite/finite_kernel_of.hpp"

namespace couplet::elastic {

/// By nine changes of F. What the edges see of a pressure they see through their own F: the face takes it whole here.
template <int D>
void FiniteKernelOf<D>::visit_tangents(const std::function<void(const FaceTangent&)>& take) {
  for (const finite::Group<D>& group : groups_)
    for (std::size_t i = 0; i < group.blocks.size(); ++i) {
      finite::State state = group.states[i];
      if (group.own < 1 && !of_cells_.empty())
        state.wj -= (1 - group.own) / group.own * finite::between<D>(group.blocks[i], pressures_.data());
      FaceTangent of[4];
      Four h[3][3], df[3][3] = {}, dp[3][3];
      finite::cofactors(state.f, h);
      for (int column = 0; column < 9; ++column) {
        df[column / 3][column % 3] = Four{1, 1, 1, 1};
        finite::tangent<true>(state, df, Four{}, dp);
        if (D == 2 && !group.sheet.empty()) finite::condense(group.sheet[i], df, dp);
        df[column / 3][column % 3] = Four{};
        for (int k = 0; k < 4; ++k)
          for (int row = 0; row < 9; ++row) of[k].stiffness(row, column) = dp[row / 3][row % 3][k];
      }
      for (int k = 0; k < 4; ++k) {
        if (group.blocks[i].face[k] < 0) continue;
        of[k].face = group.blocks[i].face[k];
        for (int a = 0; a < 9; ++a) of[k].cofactors(a / 3, a % 3) = h[a / 3][a % 3][k];
        take(of[k]);
      }
    }
  for (std::size_t i = 0; i < elsewhere_.blocks.size(); ++i) {
    Four h[3][3];
    finite::cofactors(elsewhere_.states[i].f, h);
    for (int k = 0; k < 4; ++k) {
      FaceTangent of{elsewhere_.blocks[i].face[k], {}, {}};
      if (of.face < 0) continue;
      for (int a = 0; a < 9; ++a) of.cofactors(a / 3, a % 3) = h[a / 3][a % 3][k];
      take(of);
    }
  }
}

template void FiniteKernelOf<2>::visit_tangents(const std::function<void(const FaceTangent&)>&);

template void FiniteKernelOf<3>::visit_tangents(const std::function<void(const FaceTangent&)>&);

}  // namespace couplet::elastic
