// SPDX-License-Identifier: Apache-2.0
#include "common/coupling/interface_map.hpp"

#include <algorithm>
#include <cassert>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/parallel/collective.hpp"

namespace couplet {
namespace {

std::vector<const Patch*> find_patches(const Mesh& mesh, const std::vector<std::string>& names) {
  std::vector<const Patch*> patches;
  for (const std::string& name : names) {
    const Patch* patch = mesh.find_patch(name);
    if (patch == nullptr) {
      std::vector<std::string> known;
      for (const Patch& p : mesh.patches) known.push_back("'" + p.name + "'");
      throw Error("The mesh has no patch '{}'. Its patches are {}.", name, join(known));
    }
    patches.push_back(patch);
  }
  return patches;
}

/// Positions of these ids in the ascending list of all ids that any rank owns.
std::vector<Index> positions_of(const std::vector<GlobalIndex>& ids, const std::vector<GlobalIndex>& all) {
  std::vector<Index> positions;
  for (const GlobalIndex id : ids)
    positions.push_back(static_cast<Index>(std::lower_bound(all.begin(), all.end(), id) - all.begin()));
  return positions;
}

std::vector<int> first_of(const std::vector<int>& counts) {
  std::vector<int> first;
  int at = 0;
  for (const int n : counts) {
    first.push_back(at);
    at += n;
  }
  return first;
}

}  // namespace

InterfaceMap::Layout::Layout(MPI_Comm comm, const std::vector<Index>& local)
    : counts(couplet::gather(comm, std::vector<int>{static_cast<int>(local.size())})),
      positions(couplet::gather(comm, local)) {}

InterfaceMap::InterfaceMap(const Mesh& mesh, const std::vector<std::string>& patches) : mesh_(&mesh) {
  // Whether a ghost point lies on the patches only its owner can tell: the faces that touch it may not be
  // here.
  std::vector<double> on_patch(mesh.points.n_local(), 0);
  for (const Patch* p : find_patches(mesh, patches)) {
    for (Index f = p->first; f < p->first + p->count; ++f) faces_.push_back(f);
    for (Index i = 0; i < p->count + p->ghost_count; ++i)
      for (const Index point : mesh.face_points[i < p->count ? p->first + i : p->ghost_first + i - p->count])
        on_patch[point] = 1;
  }
  mesh.points.update_ghosts(std::span<double>(on_patch));
  std::sort(faces_.begin(), faces_.end());
  faces_.erase(std::unique(faces_.begin(), faces_.end()), faces_.end());

  std::vector<GlobalIndex> point_ids, owned_ids, face_ids;
  for (Index p = 0; p < mesh.points.n_local(); ++p) {
    if (on_patch[p] == 0) continue;
    if (p < mesh.points.n_owned()) {
      owned_points_.push_back(static_cast<Index>(points_.size()));
      owned_ids.push_back(mesh.point_id[p]);
    }
    points_.push_back(p);
    point_ids.push_back(mesh.point_id[p]);
  }
  for (const Index f : faces_) face_ids.push_back(mesh.boundary_id[f - mesh.n_interior]);

  std::vector<GlobalIndex> all_points = all_gather(mesh.comm, owned_ids),
                           all_faces = all_gather(mesh.comm, face_ids);
  std::sort(all_points.begin(), all_points.end());
  std::sort(all_faces.begin(), all_faces.end());
  n_vertices_ = all_points.size();
  n_faces_ = all_faces.size();
  vertex_of_ = positions_of(point_ids, all_points);
  point_layout_ = Layout(mesh.comm, vertex_of_);
  owned_point_layout_ = Layout(mesh.comm, positions_of(owned_ids, all_points));
  face_layout_ = Layout(mesh.comm, positions_of(face_ids, all_faces));
}

std::vector<double> InterfaceMap::scatter(const Layout& layout, std::size_t n_here, std::size_t n_all,
                                          const std::vector<double>& on_root, int components) const {
  if (comm_rank(mesh_->comm) == 0 && !on_root.empty() && on_root.size() != n_all * components)
    throw Error(
        "The interface data that arrived has {} values; {} entries of {} components were expected. Check "
        "that both participants describe the interface that they use.",
        on_root.size(), n_all, components);
  std::vector<double> packed(layout.positions.size() * components, 0.0);
  if (!on_root.empty())
    for (std::size_t i = 0; i < layout.positions.size(); ++i)
      for (int c = 0; c < components; ++c)
        packed[i * components + c] = on_root[std::size_t(layout.positions[i]) * components + c];
  std::vector<int> counts(layout.counts);
  for (int& n : counts) n *= components;
  const std::vector<int> first = first_of(counts);
  std::vector<double> here(n_here * components);
  MPI_Scatterv(packed.data(), counts.data(), first.data(), MPI_DOUBLE, here.data(),
               static_cast<int>(here.size()), MPI_DOUBLE, 0, mesh_->comm);
  return here;
}

std::vector<double> InterfaceMap::gather(const Layout& layout, std::size_t n_all,
                                         std::span<const double> local, int components) const {
  std::vector<int> counts(layout.counts);
  for (int& n : counts) n *= components;
  const std::vector<int> first = first_of(counts);
  std::vector<double> packed(layout.positions.size() * components);
  MPI_Gatherv(local.data(), static_cast<int>(local.size()), MPI_DOUBLE, packed.data(), counts.data(),
              first.data(), MPI_DOUBLE, 0, mesh_->comm);
  if (comm_rank(mesh_->comm) != 0) return {};
  std::vector<double> on_root(n_all * components);
  for (std::size_t i = 0; i < layout.positions.size(); ++i)
    for (int c = 0; c < components; ++c)
      on_root[std::size_t(layout.positions[i]) * components + c] = packed[i * components + c];
  return on_root;
}

std::vector<double> InterfaceMap::scatter_vertices(const std::vector<double>& on_root, int components) const {
  return scatter(point_layout_, points_.size(), n_vertices_, on_root, components);
}

std::vector<double> InterfaceMap::scatter_faces(const std::vector<double>& on_root, int components) const {
  return scatter(face_layout_, faces_.size(), n_faces_, on_root, components);
}

std::vector<double> InterfaceMap::gather_vertices(std::span<const double> local, int components) const {
  assert(local.size() == points_.size() * components);
  std::vector<double> owned;
  owned.reserve(owned_points_.size() * components);
  for (const Index i : owned_points_)
    for (int c = 0; c < components; ++c) owned.push_back(local[std::size_t(i) * components + c]);
  return gather(owned_point_layout_, n_vertices_, owned, components);
}

std::vector<double> InterfaceMap::gather_faces(std::span<const double> local, int components) const {
  assert(local.size() == faces_.size() * components);
  return gather(face_layout_, n_faces_, local, components);
}

/// As many values a face as the largest face has corners; -1 where a face has fewer.
void InterfaceMap::describe_corners(Interface& interface) const {
  double most = 0;
  for (const Index f : faces_) most = std::max(most, double(mesh_->face_points[f].size()));
  const auto width = static_cast<std::size_t>(max(mesh_->comm, most));
  std::vector<double> local(faces_.size() * width, -1);
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    const auto points = mesh_->face_points[faces_[i]];
    for (std::size_t c = 0; c < points.size(); ++c)
      local[i * width + c] =
          vertex_of_[std::lower_bound(points_.begin(), points_.end(), points[c]) - points_.begin()];
  }
  const std::vector<double> corners = gather_faces(local, static_cast<int>(width));
  if (comm_rank(mesh_->comm) != 0) return;
  interface.face_offset.push_back(0);
  for (std::size_t f = 0; f < n_faces_; ++f) {
    for (std::size_t c = 0; c < width; ++c)
      if (corners[f * width + c] >= 0)
        interface.face_vertices.push_back(static_cast<Index>(corners[f * width + c]));
    interface.face_offset.push_back(static_cast<Index>(interface.face_vertices.size()));
  }
}

Interface InterfaceMap::describe() const {
  const auto flat = [](const std::vector<Index>& entries, const std::vector<Vec3>& values) {
    std::vector<double> result;
    for (const Index i : entries) result.insert(result.end(), values[i].begin(), values[i].end());
    return result;
  };
  const auto vectors = [](const std::vector<double>& values) {
    std::vector<Vec3> result;
    for (std::size_t i = 0; i + 2 < values.size(); i += 3)
      result.emplace_back(values[i], values[i + 1], values[i + 2]);
    return result;
  };
  Interface interface;
  interface.dim = mesh_->dim;
  interface.vertices = vectors(gather_vertices(flat(points_, mesh_->reference_points), 3));
  interface.face_centres = vectors(gather_faces(flat(faces_, mesh_->reference.face_centre), 3));
  interface.face_areas = vectors(gather_faces(flat(faces_, mesh_->reference.face_area), 3));
  describe_corners(interface);
  return interface;
}

}  // namespace couplet
