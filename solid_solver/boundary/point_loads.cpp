// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/boundary/point_loads.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::solid {
namespace {

/// A point further from the nearest face than so many of its widths lies beside the body.
constexpr double widths = 2;

/// The nearest boundary face of all ranks: of several the first of the file.
struct Nearest {
  double distance = std::numeric_limits<double>::infinity();
  GlobalIndex id = std::numeric_limits<GlobalIndex>::max();
  double width = 0;
  Index face = -1;  // on the rank that has it
  int is_open = 0, patch = -1;
};

Nearest nearest_face(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const Vec3& point,
                     std::span<const std::uint8_t> open) {
  Nearest mine;
  for (std::size_t p = 0; p < mesh.patches.size(); ++p) {
    const mesh::Patch& patch = mesh.patches[p];
    if (patch.bonded) continue;
    for (Index f = patch.first; f < patch.first + patch.count; ++f) {
      const double distance = (geometry.face_centre[f] - point).norm();
      const GlobalIndex id = mesh.boundary_id[f - mesh.n_interior];
      if (distance > mine.distance || (distance == mine.distance && id > mine.id)) continue;
      const double area = geometry.face_area[f].norm();
      mine = {distance,
              id,
              mesh.dim == 3 ? std::sqrt(area) : area,
              f,
              open[std::size_t(f - mesh.n_interior)],
              static_cast<int>(p)};
    }
  }
  Nearest best;
  for (const Nearest& other : parallel::all_gather(mesh.comm, std::vector<Nearest>{mine}))
    if (std::pair(other.distance, other.id) < std::pair(best.distance, best.id)) best = other;
  if (best.id != mine.id) best.face = -1;
  return best;
}

std::string place_of(const Vec3& x, int dim) {
  return dim == 3 ? fmt::format("({:g}, {:g}, {:g})", x[0], x[1], x[2])
                  : fmt::format("({:g}, {:g})", x[0], x[1]);
}

}  // namespace

std::vector<Index> faces_of_point_load(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                       const PointLoad& load, std::span<const std::uint8_t> open,
                                       const std::string& where) {
  std::vector<Index> faces;
  const Nearest nearest = nearest_face(mesh, geometry, load.point, open);
  if (load.radius == 0) {
    if (nearest.distance > widths * nearest.width)
      throw Error(
          "{}.point: {} m is off the surface: the nearest face is {:g} m away and {:.2g} m wide. Check the "
          "unit, or give a 'radius'.",
          where, place_of(load.point, mesh.dim), nearest.distance, nearest.width);
    if (nearest.is_open == 0)
      throw Error(
          "{}.point: the face nearest to {} m belongs to patch '{}' and is held there, so a force on it has "
          "no effect. Move the point, or give a 'radius' that reaches unsupported faces.",
          where, place_of(load.point, mesh.dim), mesh.patches[std::size_t(nearest.patch)].name);
    if (nearest.face >= 0) faces.push_back(nearest.face);
    return faces;
  }
  for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f)
    if (open[std::size_t(f - mesh.n_interior)] &&
        (geometry.face_centre[f] - load.point).norm() <= load.radius)
      faces.push_back(f);
  if (!parallel::any(mesh.comm, !faces.empty()))
    throw Error(
        "{}.radius: no unsupported face has its centre within {:g} m of {} m; the nearest face is {:g} m "
        "away{}.",
        where, load.radius, place_of(load.point, mesh.dim), nearest.distance,
        nearest.is_open ? "" : " and is held");
  return faces;
}

}  // namespace couplet::solid
