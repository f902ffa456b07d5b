// SPDX-License-Identifier: Apache-2.0
#include "common/diagnostics/atmosphere.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace couplet::diagnostics {

std::optional<Finding> atmosphere_on_one_side(MPI_Comm comm, int dim, std::span<const double> force,
                                              std::span<const Vec3> area, std::span<const Vec3> centre) {
  constexpr double atmosphere = 101325, weather = 0.1;  // [Pa], and its changes with weather and altitude
  enum {
    size,
    push,
    volume,
    spread,
    facing,
    of_size = facing + 3,
    of_push = of_size + 3,
    n_sums = of_push + 3
  };
  std::array<double, n_sums> sums{};
  for (std::size_t f = 0; f < area.size(); ++f) {
    Vec3 load = Vec3::Zero();
    for (int k = 0; k < dim; ++k) load[k] = force[std::size_t(dim) * f + std::size_t(k)];
    if (load.isZero(0)) continue;
    const double a = area[f].norm(), into = std::copysign(load.norm(), -load.dot(area[f]));
    sums[size] += a, sums[push] += into;
    sums[volume] += area[f].dot(centre[f]), sums[spread] += a * centre[f].squaredNorm();
    for (int k = 0; k < 3; ++k) {
      sums[facing + k] += area[f][k];
      sums[of_size + k] += a * centre[f][k], sums[of_push + k] += into * centre[f][k];
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), int(sums.size()), MPI_DOUBLE, MPI_SUM, comm);
  const double pressure = sums[push] / sums[size];
  if (!(std::abs(pressure / atmosphere - 1) < weather)) return {};
  // The forces of maps between meshes are even on the whole, not face by face.
  const Vec3 middle = Vec3(&sums[of_size]) / sums[size], open(&sums[facing]);
  const double radius = std::sqrt(sums[spread] / sums[size] - middle.squaredNorm());
  if ((Vec3(&sums[of_push]) / sums[push] - middle).norm() > 0.01 * radius) return {};
  // Times the dimension: the volume of a body that the faces enclose, negative of a cavity.
  const double enclosed = sums[volume] - open.dot(middle);
  if (open.norm() < 0.5 * sums[size] && !(enclosed < 0)) return {};
  return Finding{
      .id = "atmosphere-on-one-side",
      .number = pressure,
      .limit = atmosphere,
      .sentence = fmt::format(
          "load of the interface: a uniform pressure of {:.5g} Pa, about atmospheric pressure, acts on only one side of the "
          "structure: questionable",
          pressure),
      .advice =
          "if the fluid's pressures are absolute, subtract atmospheric pressure ('pressure: 0' at the outlets), or apply this "
          "pressure to the other side of the structure as well"};
}

}  // namespace couplet::diagnostics
