// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/motion/seat_check.hpp"

#include <cmath>

#include "common/base/error.hpp"
#include "common/fv/expression.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::fluid {
namespace {

constexpr double near_enough = 0.1;  // of the opening

Vec3 direction_of(const GapParameters& gap, int dimension) {
  const std::vector<double>& d = gap.direction;
  if (d.empty()) return dimension == 2 ? Vec3::UnitY() : Vec3::UnitZ();
  return Vec3(d[0], d[1], d.size() > 2 ? d[2] : 0).normalized();
}

}  // namespace

void check_seats(const mesh::Mesh& mesh, const FluidParameters& parameters, std::span<const Vec3> points) {
  for (const auto& [name, gap] : parameters.gaps) {
    const mesh::Patch* seat = gap.height ? mesh.find_patch(gap.between[1]) : nullptr;
    if (seat == nullptr) continue;
    const fv::Expression height(*gap.height, "gaps." + name + ".height");
    const Vec3 direction = direction_of(gap, mesh.dim);
    std::vector<double> worst{0, 0, 0, 0, 0};  // off by, place, height given there
    for (Index f = seat->first; f < seat->first + seat->count; ++f)
      for (const Index p : mesh.face_points[f]) {
        const Vec3& x = points[p];
        const double given = height(x, 0), off = x.dot(direction) - given;
        if (std::abs(off) > std::abs(worst[0])) worst = {off, x.x(), x.y(), x.z(), given};
      }
    const std::vector<double> all = parallel::all_gather(mesh.comm, worst);
    for (std::size_t i = 0; i < all.size(); i += 5)
      if (std::abs(all[i]) > std::abs(worst[0])) worst.assign(all.begin() + i, all.begin() + i + 5);
    if (std::abs(worst[0]) <= near_enough * gap.opening) continue;
    throw Error(
        "gaps.{0}.height: the seat is stated at {1:.4g} m, but the mesh has its wall '{2}' {3:.3g} m {4} at ({5:.4g}, {6:.4g}, "
        "{7:.4g}), more than {8:g} % of the opening ({9:g} m). Correct 'height', or the mesh.",
        name, worst[4], gap.between[1], std::abs(worst[0]), worst[0] > 0 ? "above it" : "below it", worst[1],
        worst[2], worst[3], 100 * near_enough, gap.opening);
  }
}

}  // namespace couplet::fluid
