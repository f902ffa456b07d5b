// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/boundary/mesh_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "common/base/error.hpp"
#include "common/log/log.hpp"
#include "common/mesh/quality.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::solid {
namespace {

std::string text_of(const Vec3& x, int dim) {
  return dim == 2 ? fmt::format("({:.4g}, {:.4g})", x[0], x[1])
                  : fmt::format("({:.4g}, {:.4g}, {:.4g})", x[0], x[1], x[2]);
}

struct Found {
  GlobalIndex count;
  Vec3 first;  ///< place of the first one
};

/// Of points listed on each rank. Collective.
std::optional<Found> find_any(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                              const std::vector<Index>& points) {
  std::vector<double> first;
  if (!points.empty()) {
    const Vec3& x = geometry.points[points.front()];
    first.assign(x.data(), x.data() + 3);
  }
  const std::vector<double> all = parallel::all_gather(mesh.comm, first);
  if (all.empty()) return std::nullopt;
  return Found{parallel::sum(mesh.comm, GlobalIndex(points.size())), Vec3(all[0], all[1], all[2])};
}

}  // namespace

void check_mesh(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                const fv::VertexInterpolation& vertices) {
  if (const auto trouble = mesh::find_inverted(mesh, geometry))
    throw Error(
        "The mesh has an inverted cell: cell {} at {} has the volume {:.3g} m^3. Its faces intersect; "
        "remesh there, coarser or with another element size.",
        trouble->cell_id, text_of(trouble->centre, mesh.dim), trouble->volume);
  // Where a cell does not lie behind its face the operator is not elliptic.
  if (const auto fold = mesh::find_fold(mesh, geometry))
    throw Error(
        "The mesh is folded at {}: cell {} (counted from 0 in the file) is not behind its face there. A "
        "cell is inverted or bent over; remesh there.",
        text_of(fold->centre, mesh.dim), fold->cell_id);
  if (const auto bent = find_any(mesh, geometry, vertices.bent_points()))
    throw Error(
        "boundaries: a patch of 'type: symmetry' is not flat at {}. A symmetry plane must be a plane; 'type: "
        "frictionless' also slides along curved surfaces.",
        text_of(bent->first, mesh.dim));
  if (const auto inexact = find_any(mesh, geometry, vertices.inexact_points());
      inexact && parallel::comm_rank(mesh.comm) == 0)
    log::warn(
        "at {} vertices, the first at {}, the adjacent cells and faces do not span all directions: values "
        "there are plain means of the neighbours, exact for constant fields only",
        inexact->count, text_of(inexact->first, mesh.dim));
}

void check_axis(const mesh::Mesh& mesh, const elastic::ElasticOperator& elastic) {
  const mesh::Geometry& geometry = elastic.geometry();
  double size = 0;
  for (const Vec3& x : geometry.points) size = std::max(size, x.norm());
  const double none = 1e-9 * parallel::max(mesh.comm, size);
  std::vector<Index> behind, open, oblique;
  for (Index v = 0; v < mesh.points.n_local(); ++v)
    if (geometry.points[v][0] < -none) behind.push_back(v);
  for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f) {
    const bool on_axis = std::abs(geometry.face_centre[f][0]) <= none;
    if (on_axis && !elastic.mirrored(f)) open.push_back(mesh.face_points[f][0]);
    const Vec3 n = geometry.face_area[f].normalized();
    if (elastic.mirrored(f) && !on_axis && std::abs(n[0]) > 1e-6) oblique.push_back(mesh.face_points[f][0]);
  }
  if (const auto at = find_any(mesh, geometry, behind))
    throw Error("plane: axisymmetric: x is the radius and must not be negative; the mesh has a point at {}.",
                text_of(at->first, mesh.dim));
  if (const auto at = find_any(mesh, geometry, open))
    throw Error(
        "boundaries: plane: axisymmetric: the patch on the axis x = 0 needs 'type: symmetry' (at {}).",
        text_of(at->first, mesh.dim));
  if (const auto at = find_any(mesh, geometry, oblique))
    throw Error(
        "boundaries: plane: axisymmetric: a 'symmetry' must be the axis x = 0 or a plane y = constant; the "
        "patch at {} is neither. Use 'frictionless' to slide along a surface.",
        text_of(at->first, mesh.dim));
}

}  // namespace couplet::solid
