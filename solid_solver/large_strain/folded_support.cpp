// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/large_strain/folded_support.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "common/parallel/collective.hpp"

namespace couplet::solid {
namespace {

struct Fold {
  double height = 0;  // beyond the plane of the support [m]
  Index support = -1;
};

// Of free faces, from the rim of the support on: the first may be pressed flat while the next ones fold over it.
constexpr int rings = 3;

using FacesOfPoints = std::vector<std::vector<Index>>;

FacesOfPoints supports_of_points(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows) {
  FacesOfPoints supports(std::size_t(mesh.points.n_local()));
  for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f)
    if (rows.at(f).fixed)
      for (const Index v : mesh.face_points[f]) supports[std::size_t(v)].push_back(f);
  return supports;
}

Fold largest_fold(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows,
                  const std::function<Vec3(Index)>& displacement) {
  const mesh::Geometry& g = rows.geometry();
  const auto place = [&](Index f) {
    return Vec3(g.face_centre[f] + displacement(mesh.cells.n_local() + f - mesh.n_interior));
  };
  Fold most;
  FacesOfPoints supports = supports_of_points(mesh, rows);
  for (int ring = 0; ring < rings; ++ring) {
    FacesOfPoints next = supports;
    for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f) {
      if (!rows.at(f).is_free()) continue;
      for (const Index v : mesh.face_points[f])
        for (const Index support : supports[std::size_t(v)]) {
          const Vec3 normal = g.face_area[support].normalized();
          if (normal.dot(g.face_centre[f] - g.face_centre[support]) > 0) continue;  // a step from the start
          const double height = normal.dot(place(f) - place(support));
          if (height > most.height) most = {height, support};
          for (const Index w : mesh.face_points[f])
            if (auto& known = next[std::size_t(w)]; std::ranges::find(known, support) == known.end())
              known.push_back(support);
        }
    }
    supports = std::move(next);
  }
  return most;
}

}  // namespace

std::string folded_support(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows,
                           const std::function<Vec3(Index)>& displacement) {
  const Fold here = largest_fold(mesh, rows, displacement);
  struct Told {
    double height;
    int patch;
  };
  Told told{here.height, -1};
  for (std::size_t p = 0; p < mesh.patches.size(); ++p)
    if (here.support >= mesh.patches[p].first && here.support < mesh.patches[p].first + mesh.patches[p].count)
      told.patch = int(p);
  const std::vector<Told> all = parallel::all_gather(mesh.comm, std::vector<Told>{told});
  const Told& most = *std::ranges::max_element(all, {}, &Told::height);
  if (!(most.height > 0) || most.patch < 0) return "";
  return fmt::format(
      "Beside '{}' the free surface has folded beyond the plane of the support, by {:.2g} m: a wider support "
      "would touch it there, which is not modelled, and beyond this load equilibrium is lost cell by cell, on "
      "finer meshes earlier. End the load here, or let the sides widen towards the support.",
      mesh.patches[std::size_t(most.patch)].name, most.height);
}

}  // namespace couplet::solid
