// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/large_strain/updated_frame.hpp"

#include <algorithm>
#include <utility>

#include "common/elasticity/finite/finite_strain.hpp"
#include "solid_solver/method/segregated.hpp"

namespace couplet::solid {
namespace {

// Of a first guess.
constexpr double loose = 1e-3;

}  // namespace

UpdatedFrame::UpdatedFrame(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows,
                           std::vector<Vec3> points)
    : mesh_(mesh),
      geometry_(mesh::compute_geometry(mesh, std::move(points))),
      rows_(mesh, geometry_, rows.boundary(), elastic::ElasticBody{{rows.lame(0)}, {}}),
      kernel_(mesh, rows_, elastic::FaceGradientScheme::thesis) {}

ScalarSystems& UpdatedFrame::systems(double mass_factor, std::span<const double> inertia) {
  if (!systems_ || mass_factor != mass_factor_)
    systems_ = std::make_unique<ScalarSystems>(mesh_, rows_, inertia);
  mass_factor_ = mass_factor;
  return *systems_;
}

std::vector<double> UpdatedFrame::linear_answer(std::span<const double> change, MethodParameters method) {
  method.relative_tolerance = loose;
  std::vector<double> still(rows_.n_unknowns(), 0), b(still), u(still);
  kernel_.apply(still, change, b);
  for (double& x : b) x = -x;
  Segregated({mesh_, rows_, {}, kernel_}, method).solve(b, u);
  return u;
}

// Four places at a time, the last ones filled up with their neighbour.
void first_piola(const elastic::FiniteLaw& law, std::span<const Tensor3> deformation,
                 std::span<Tensor3> stress, std::span<double> energy) {
  using namespace elastic::finite;
  const std::size_t n = deformation.size();
  for (std::size_t first = 0; first < n; first += 4) {
    const auto at = [&](int k) { return std::min(first + std::size_t(k), n - 1); };
    elastic::finite::State s;
    for (int k = 0; k < 4; ++k)
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) s.f[i][j][k] = deformation[at(k)](i, j);
    const elastic::Invariants place[1] = {elastic::finite::invariants(s.f)};
    elastic::Energy e[1];
    law.evaluate(place, true, e);
    elastic::finite::keep(e[0], s);
    elastic::finite::Tensor4 p;
    elastic::finite::stress<true>(s, p);
    for (int k = 0; k < 4; ++k) {
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) stress[at(k)](i, j) = p[i][j][k];
      energy[at(k)] = e[0].w[k];
    }
  }
}

Tensor3 cofactors_of(const Tensor3& f) {
  Tensor3 h;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      h(i, j) = f((i + 1) % 3, (j + 1) % 3) * f((i + 2) % 3, (j + 2) % 3) -
                f((i + 1) % 3, (j + 2) % 3) * f((i + 2) % 3, (j + 1) % 3);
  return h;
}

}  // namespace couplet::solid
