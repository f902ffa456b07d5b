// SPDX-License-Identifier: Apache-2.0
#include "common/coupling/interface_map.hpp"

#include <algorithm>
#include <cassert>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::coupling {
namespace {

std::vector<const mesh::Patch*> find_patches(const mesh::Mesh& mesh, const std::vector<std::string>& names) {
  std::vector<const mesh::Patch*> patches;
  for (const std::string& name : names) {
    const mesh::Patch* patch = mesh.find_patch(name);
    if (patch == nullptr) {
      std::vector<std::string> known;
      for (const mesh::Patch& p : mesh.patches) known.push_back("'" + p.name + "'");
      throw Error("The mesh has no patch '{}'. Its patches are {}.", name, base::join(known));
    }
    patches.push_back(patch);
  }
  return patches;
}

/// Checks sizes collectively, so that a problem of one rank leaves no other rank in a collective call.
void check_size(MPI_Comm comm, std::size_t got, std::size_t entries, int components) {
  if (!parallel::any(comm, got != 0 && got != entries * std::size_t(components))) return;
  throw Error(
      "The interface data received have {} values; expected {} entries of {} components. Check that both "
      "participants describe the interface they use.",
      got, entries, components);
}

}  // namespace

InterfaceMap::InterfaceMap(const mesh::Mesh& mesh, const std::vector<std::string>& patches)
    : mesh_(&mesh), patches_(patches) {
  // Only the owner of a ghost point knows if it lies on the patches, because the faces at it may be on other
  // ranks.
  std::vector<double> on_patch(mesh.points.n_local(), 0);
  for (const mesh::Patch* p : find_patches(mesh, patches)) {
    for (Index f = p->first; f < p->first + p->count; ++f) faces_.push_back(f);
    for (Index i = 0; i < p->count + p->ghost_count; ++i)
      for (const Index point : mesh.face_points[i < p->count ? p->first + i : p->ghost_first + i - p->count])
        on_patch[point] = 1;
  }
  mesh.points.update_ghosts(std::span<double>(on_patch));
  std::sort(faces_.begin(), faces_.end());
  faces_.erase(std::unique(faces_.begin(), faces_.end()), faces_.end());

  // Position of each point among its owner's interface points.
  std::vector<double> place(mesh.points.n_local(), 0);
  Index n_owned = 0;
  for (Index p = 0; p < mesh.points.n_local(); ++p) {
    if (on_patch[p] == 0) continue;
    if (p < mesh.points.n_owned()) place[p] = n_owned++;
    points_.push_back(p);
  }
  mesh.points.update_ghosts(std::span<double>(place));
  const std::vector<GlobalIndex> first =
      parallel::all_gather(mesh.comm, std::vector<GlobalIndex>{mesh.points.first()});
  std::vector<int> ghost_owner;
  std::vector<Index> ghost_place;
  for (std::size_t i = std::size_t(n_owned); i < points_.size(); ++i) {
    const GlobalIndex number = mesh.points.global(points_[i]);
    ghost_owner.push_back(int(std::upper_bound(first.begin(), first.end(), number) - first.begin()) - 1);
    ghost_place.push_back(Index(place[points_[i]]));
  }
  vertices_ = parallel::IndexMap(mesh.comm, n_owned, ghost_owner, ghost_place);
}

std::vector<double> InterfaceMap::scatter_vertices(const std::vector<double>& owned, int components) const {
  const auto n = std::size_t(components);
  check_size(mesh_->comm, owned.size(), std::size_t(vertices_.n_owned()), components);
  std::vector<double> values(owned);
  values.resize(points_.size() * n, 0.);
  vertices_.update_ghosts(std::span<double>(values), components);
  return values;
}

std::vector<double> InterfaceMap::scatter_faces(const std::vector<double>& owned, int components) const {
  check_size(mesh_->comm, owned.size(), faces_.size(), components);
  std::vector<double> values(owned);
  values.resize(faces_.size() * std::size_t(components), 0.);
  return values;
}

std::vector<double> InterfaceMap::gather_vertices(std::span<const double> local, int components) const {
  assert(local.size() == points_.size() * std::size_t(components));
  const auto owned = std::size_t(vertices_.n_owned()) * std::size_t(components);
  return {local.begin(), local.begin() + std::ptrdiff_t(owned)};
}

std::vector<double> InterfaceMap::gather_faces(std::span<const double> local, int components) const {
  assert(local.size() == faces_.size() * std::size_t(components));
  (void)components;
  return {local.begin(), local.end()};
}

Interface InterfaceMap::describe(const mesh::Geometry& geometry) const {
  Interface interface;
  interface.dim = mesh_->dim;
  for (Index i = 0; i < vertices_.n_owned(); ++i) {
    interface.vertices.push_back(geometry.points[points_[i]]);
    interface.vertex_ids.push_back(mesh_->point_id[points_[i]]);
  }
  interface.face_offset.push_back(0);
  for (const Index f : faces_) {
    interface.face_centres.push_back(geometry.face_centre[f]);
    interface.face_areas.push_back(geometry.face_area[f]);
    interface.face_ids.push_back(mesh_->boundary_id[f - mesh_->n_interior]);
    for (const Index point : mesh_->face_points[f]) {
      const auto here = std::lower_bound(points_.begin(), points_.end(), point) - points_.begin();
      interface.face_vertices.push_back(Index(vertices_.global(Index(here))));
    }
    interface.face_offset.push_back(Index(interface.face_vertices.size()));
  }
  return interface;
}

}  // namespace couplet::coupling
