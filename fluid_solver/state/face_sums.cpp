// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/state/face_sums.hpp"

#include "common/base/processor_clones.hpp"

namespace couplet::fluid {

COUPLET_PROCESSOR_CLONES double subtract_outflow(const mesh::Mesh& mesh, double factor,
                                                 std::span<const double> phi, std::span<double> sum) {
  const Index *owner = mesh.owner.data(), *neighbour = mesh.neighbour.data();
  const double* flux = phi.data();
  double *of = sum.data(), size = 0;
  for (Index f = 0; f < mesh.n_interior; ++f) {
    const double out = factor * flux[f];
    of[owner[f]] -= out;
    of[neighbour[f]] += out;
    size += flux[f] * flux[f];
  }
  return size;
}

namespace {

template <int D>
[[gnu::always_inline]] inline void add_pressures(const mesh::Mesh& mesh, const Placement<D>& at,
                                                 const double* p, Vectors<D>& sum) {
  const Index *owner = mesh.owner.data(), *neighbour = mesh.neighbour.data();
  const double* weight = at.weight.data();
  const Vec<D>* area = at.area.data();
  Vec<D>* of = sum.data();
  // Faces stand owner by owner: what is the owner's is read and written once.
  for (Index f = 0; f < mesh.n_interior;) {
    const Index o = owner[f];
    const double own = p[o];
    Vec<D> all = Vec<D>::Zero();
    do {
      const Index n = neighbour[f];
      const Vec<D> part = (p[n] + weight[f] * (own - p[n])) * area[f];
      all += part;
      of[n] -= part;
      ++f;
    } while (f < mesh.n_interior && owner[f] == o);
    of[o] += all;
  }
}

}  // namespace

COUPLET_PROCESSOR_CLONES void add_pressure(const mesh::Mesh& mesh, const Placement<2>& at,
                                           std::span<const double> p, Vectors<2>& sum) {
  add_pressures<2>(mesh, at, p.data(), sum);
}
COUPLET_PROCESSOR_CLONES void add_pressure(const mesh::Mesh& mesh, const Placement<3>& at,
                                           std::span<const double> p, Vectors<3>& sum) {
  add_pressures<3>(mesh, at, p.data(), sum);
}

}  // namespace couplet::fluid
