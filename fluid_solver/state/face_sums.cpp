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

template <bool Corrects, int D>
[[gnu::always_inline]] inline void add_pressures(const mesh::Mesh& mesh, const Placement<D>& at,
                                                 const double* p, const FluxCorrection& correction,
                                                 Vectors<D>& sum) {
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
      const double less = own - p[n];
      if constexpr (Corrects) correction.phi[f] += correction.factor * correction.conductance[f] * less;
      const Vec<D> part = (p[n] + weight[f] * less) * area[f];
      all += part;
      of[n] -= part;
      ++f;
    } while (f < mesh.n_interior && owner[f] == o);
    of[o] += all;
  }
}

template <int D>
[[gnu::always_inline]] inline void choose(const mesh::Mesh& mesh, const Placement<D>& at,
                                          std::span<const double> p, const FluxCorrection* correction,
                                          Vectors<D>& sum) {
  if (correction)
    add_pressures<true>(mesh, at, p.data(), *correction, sum);
  else
    add_pressures<false>(mesh, at, p.data(), FluxCorrection{}, sum);
}

}  // namespace

COUPLET_PROCESSOR_CLONES void add_pressure(const mesh::Mesh& mesh, const Placement<2>& at,
                                           std::span<const double> p, const FluxCorrection* correction,
                                           Vectors<2>& sum) {
  choose(mesh, at, p, correction, sum);
}
COUPLET_PROCESSOR_CLONES void add_pressure(const mesh::Mesh& mesh, const Placement<3>& at,
                                           std::span<const double> p, const FluxCorrection* correction,
                                           Vectors<3>& sum) {
  choose(mesh, at, p, correction, sum);
}

}  // namespace couplet::fluid
