// SPDX-License-Identifier: Apache-2.0
#include "common/io/probes/mesh_scale.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/diagnostics/finding.hpp"
#include "common/io/probes/place_search.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::io {

void doubt_mesh_scale(const mesh::Mesh& mesh, std::span<const Vec3> points, std::span<const Vec3> places) {
  constexpr double smallest = 1e-6, largest = 2e3;  // [m]
  constexpr double corner = 1.0 / 300;  // between sizes that occur in one scene and millimetres for metres
  const double size = mesh_size(mesh, points);
  if (size < smallest || size > largest)
    diagnostics::finding(parallel::comm_rank(mesh.comm),
                         {.id = "questionable-mesh-scale",
                          .number = size,
                          .limit = size < smallest ? smallest : largest,
                          .sentence = fmt::format("mesh size: {:.3g} m (usual: {:g} to {:g} m): implausible",
                                                  size, smallest, largest),
                          .advice = "check 'mesh-scale' (0.001 for a mesh in millimetres)"});
  double farthest = 0;
  for (const Vec3& place : places) farthest = std::max(farthest, place.norm());
  if (farthest > 0 && farthest < corner * size)
    diagnostics::finding(
        parallel::comm_rank(mesh.comm),
        {.id = "questionable-mesh-scale",
         .number = farthest,
         .limit = corner * size,
         .sentence =
             fmt::format("probe positions: all within {:.3g} m of the origin in a mesh of {:.3g} m (usual: "
                         "over {:.3g} m): implausible",
                         farthest, size, corner * size),
         .advice = "is the mesh in millimetres? Then set 'mesh-scale: 0.001'"});
}

}  // namespace couplet::io
