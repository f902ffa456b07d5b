// SPDX-License-Identifier: Apache-2.0
// Outlets that the mean outflow carries the flow through.
#include <algorithm>

#include "fluid_solver/boundary/boundary.hpp"

namespace couplet::fluid {

template <int D>
void Boundary<D>::convect(const mesh::Mesh& mesh, const Placement<D>& at, const Vectors<D>& u,
                          const Vectors<D>& w_begin, double dt, Vectors<D>& w) const {
  for (const auto& [first, count] : convective_patches_) {
    double sums[2] = {0, 0};
    for (Index b = first; b < first + count; ++b) {
      const Vec<D>& area = at.area[mesh.n_interior + b];
      sums[0] += w_begin[b].dot(area);
      sums[1] += area.norm();
    }
    MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, comm_);
    const double speed = std::max(0.0, sums[0] / sums[1]);
    for (Index b = first; b < first + count; ++b) {
      const Index f = mesh.n_interior + b;
      const double courant = dt * speed * at.conductance[f] / at.area[f].norm();
      w[b] = (w_begin[b] + courant * u[mesh.owner[f]]) / (1 + courant);
    }
  }
}

template void Boundary<2>::convect(const mesh::Mesh&, const Placement<2>&, const Vectors<2>&,
                                   const Vectors<2>&, double, Vectors<2>&) const;
template void Boundary<3>::convect(const mesh::Mesh&, const Placement<3>&, const Vectors<3>&,
                                   const Vectors<3>&, double, Vectors<3>&) const;

}  // namespace couplet::fluid
