// SPDX-License-Identifier: Apache-2.0
#include <malloc.h>

#include <algorithm>
#include <numeric>

#include "common/mesh/load.hpp"
#include "common/mesh/on_root.hpp"
#include "common/mesh/partition.hpp"
#include "common/mesh/topology.hpp"
#include "common/mesh/whole_mesh.hpp"

namespace couplet::mesh {
namespace {

/// The numbers in the mesh of entries of a piece of it; `numbers` is empty where the mesh is whole.
std::vector<GlobalIndex> in_mesh(std::vector<GlobalIndex> entries, const std::vector<GlobalIndex>& numbers) {
  if (!numbers.empty())
    for (GlobalIndex& entry : entries) entry = numbers[entry];
  return entries;
}

/// Cuts this rank's part out of the whole mesh, or out of a piece of it, whose numbers it has until the end.
class LocalPart {
 public:
  LocalPart(MPI_Comm comm, WholeMesh&& whole)
      : comm_(comm), rank_(parallel::comm_rank(comm)), whole_(std::move(whole)) {}

  /// The mesh and its points.
  std::pair<Mesh, std::vector<Vec3>> build() {
    mesh_.comm = comm_;
    mesh_.dim = raw_.dim;
    mesh_.zones = raw_.zones;
    choose_cells();
    choose_points();
    raw_.points = {};
    fill_cells();
    raw_.cell_points = {}, raw_.cell_type = {}, raw_.cell_zone = {};
    fill_interior_faces();
    fill_boundary_faces();
    mesh_.cell_id = in_mesh(std::move(mesh_.cell_id), whole_.cell_number);
    mesh_.point_id = in_mesh(std::move(mesh_.point_id), whole_.point_number);
    give_back();
    return {std::move(mesh_), std::move(points_)};
  }

 private:
  void choose_cells() {
    const Index n = raw_.cell_points.size();
    std::vector<Index> mine;
    std::vector<char> touched(raw_.points.size(), 0);
    cell_local_.assign(n, -1);
    for (Index c = 0; c < n; ++c) {
      if (part_[c] != rank_) continue;
      cell_local_[c] = static_cast<Index>(mine.size());
      mine.push_back(c);
      for (const Index p : raw_.cell_points[c]) touched[p] = 1;
    }
    std::vector<Index> first, second;
    const CellPairs pairs = connected_cells(faces_);
    for (std::size_t i = 0; i < pairs.first.size(); ++i) {
      const Index a = cell_local_[pairs.first[i]], b = cell_local_[pairs.second[i]];
      if (a < 0 || b < 0) continue;
      first.push_back(a);
      second.push_back(b);
    }
    for (const Index i : reverse_cuthill_mckee(make_graph(static_cast<Index>(mine.size()), first, second)))
      mesh_.cell_id.push_back(mine[i]);
    const auto n_owned = static_cast<Index>(mesh_.cell_id.size());

    touch_around_wide_points(touched);
    std::vector<char> across(faces_.shift.empty() ? 0 : n, 0);  // beyond a periodic face
    for (std::size_t f = 0; f < faces_.shift.size(); ++f) {
      if (faces_.shift[f].isZero()) continue;
      if (part_[faces_.owner[f]] == rank_) across[faces_.neighbour[f]] = 1;
      if (part_[faces_.neighbour[f]] == rank_) across[faces_.owner[f]] = 1;
    }
    for (Index c = 0; c < n; ++c) {
      const auto points = raw_.cell_points[c];
      if (part_[c] != rank_ && !across.empty() && across[c]) {
        mesh_.cell_id.push_back(c);
        continue;
      }
      if (part_[c] != rank_ &&
          std::any_of(points.begin(), points.end(), [&](Index p) { return touched[p] != 0; }))
        mesh_.cell_id.push_back(c);
    }
    std::stable_sort(mesh_.cell_id.begin() + n_owned, mesh_.cell_id.end(),
                     [&](GlobalIndex a, GlobalIndex b) { return part_[a] < part_[b]; });
    std::vector<int> ghost_owner;
    for (std::size_t i = 0; i < mesh_.cell_id.size(); ++i) {
      const GlobalIndex c = mesh_.cell_id[i];
      cell_local_[c] = static_cast<Index>(i);
      if (Index(i) >= n_owned) ghost_owner.push_back(part_[c]);
    }
    mesh_.cells = make_index_map(comm_, in_mesh(mesh_.cell_id, whole_.cell_number), n_owned, ghost_owner);
  }

  /// Two rings around a wide point: the points of all its cells count as touched.
  void touch_around_wide_points(std::vector<char>& touched) const {
    if (wide_points_.empty()) return;
    std::vector<char> wide(raw_.points.size(), 0);
    for (const Index p : wide_points_) wide[p] = touched[p];
    std::vector<Index> more;
    for (Index c = 0; c < raw_.cell_points.size(); ++c) {
      const auto points = raw_.cell_points[c];
      if (std::any_of(points.begin(), points.end(), [&](Index p) { return wide[p] != 0; }))
        more.insert(more.end(), points.begin(), points.end());
    }
    for (const Index p : more) touched[p] = 1;
  }

  /// The owner of a point is the smallest rank that owns a cell touching it.
  std::vector<int> owners_of_points() const {
    if (!whole_.point_owner.empty()) return whole_.point_owner;
    std::vector<int> owner(raw_.points.size(), parallel::comm_size(comm_));
    for (Index c = 0; c < raw_.cell_points.size(); ++c)
      for (const Index p : raw_.cell_points[c]) owner[p] = std::min(owner[p], part_[c]);
    return owner;
  }

  void choose_points() {
    const std::vector<int> point_owner = owners_of_points();
    std::vector<GlobalIndex> ghosts;
    std::vector<char> seen(raw_.points.size(), 0);
    for (const GlobalIndex c : mesh_.cell_id)
      for (const Index p : raw_.cell_points[static_cast<Index>(c)]) {
        if (seen[p]) continue;
        seen[p] = 1;
        (point_owner[p] == rank_ ? mesh_.point_id : ghosts).push_back(p);
      }
    const auto n_owned = static_cast<Index>(mesh_.point_id.size());
    mesh_.point_id.insert(mesh_.point_id.end(), ghosts.begin(), ghosts.end());
    std::vector<int> ghost_owner;
    for (const GlobalIndex p : ghosts) ghost_owner.push_back(point_owner[p]);
    mesh_.points = make_index_map(comm_, in_mesh(mesh_.point_id, whole_.point_number), n_owned, ghost_owner);

    point_local_.assign(raw_.points.size(), -1);
    points_.reserve(mesh_.point_id.size());
    for (std::size_t i = 0; i < mesh_.point_id.size(); ++i) {
      point_local_[mesh_.point_id[i]] = static_cast<Index>(i);
      points_.push_back(raw_.points[mesh_.point_id[i]]);
    }
    for (const Index p : wide_points_)
      if (point_local_[p] >= 0) mesh_.wide_points.push_back(point_local_[p]);
    std::ranges::sort(mesh_.wide_points);
  }

  void push_points(Csr& rows, std::span<const Index> whole) {
    for (const Index p : whole) rows.index.push_back(point_local_[p]);
    rows.offset.push_back(static_cast<Index>(rows.index.size()));
  }

  /// Room for the rows of `chosen` and as many entries.
  static void reserve(Csr& to, const Csr& from, const auto& chosen) {
    std::size_t n = 0;
    for (const auto row : chosen) n += from[static_cast<Index>(row)].size();
    to.offset.reserve(chosen.size() + 1);
    to.index.reserve(n);
  }

  void fill_cells() {
    reserve(mesh_.cell_points, raw_.cell_points, mesh_.cell_id);
    mesh_.cell_type.reserve(mesh_.cell_id.size());
    mesh_.cell_zone.reserve(mesh_.cell_id.size());
    for (const GlobalIndex c : mesh_.cell_id) {
      mesh_.cell_type.push_back(raw_.cell_type[c]);
      mesh_.cell_zone.push_back(raw_.cell_zone[c]);
      if (!cell_material_.empty()) mesh_.cell_material.push_back(cell_material_[c]);
      push_points(mesh_.cell_points, raw_.cell_points[static_cast<Index>(c)]);
    }
  }

  void fill_interior_faces() {
    const auto owned = [&](Index cell) { return cell >= 0 && cell < mesh_.cells.n_owned(); };
    std::vector<Index> chosen;
    for (Index f = 0; f < faces_.n_interior; ++f)
      if (owned(cell_local_[faces_.owner[f]]) || owned(cell_local_[faces_.neighbour[f]])) chosen.push_back(f);
    const auto key = [&](Index f) {
      return std::pair(cell_local_[faces_.owner[f]], cell_local_[faces_.neighbour[f]]);
    };
    std::stable_sort(chosen.begin(), chosen.end(), [&](Index a, Index b) { return key(a) < key(b); });
    const std::size_t all = chosen.size() + std::size_t(faces_.n_boundary());
    reserve(mesh_.face_points, faces_.points, chosen);
    mesh_.owner.reserve(all);
    mesh_.neighbour.reserve(chosen.size());
    for (const Index f : chosen) {
      mesh_.owner.push_back(key(f).first);
      mesh_.neighbour.push_back(key(f).second);
      push_points(mesh_.face_points, faces_.points[f]);
      if (!faces_.shift.empty()) mesh_.neighbour_shift.push_back(faces_.shift[f]);
    }
    mesh_.n_interior = static_cast<Index>(chosen.size());
  }

  void fill_boundary_faces() {
    struct Chosen {
      bool ghost;
      int patch;
      Index cell, id;
      auto operator<=>(const Chosen&) const = default;
    };
    std::vector<Chosen> chosen;
    for (Index b = 0; b < faces_.n_boundary(); ++b) {
      const Index cell = cell_local_[faces_.owner[faces_.n_interior + b]];
      if (cell >= 0) chosen.push_back({cell >= mesh_.cells.n_owned(), faces_.patch[b], cell, b});
    }
    std::sort(chosen.begin(), chosen.end());
    for (const std::string& name : raw_.patches) mesh_.patches.push_back({name});
    Index n_owned = 0;
    std::vector<int> ghost_owner;
    for (const Chosen& f : chosen) {
      Patch& patch = mesh_.patches[f.patch];
      ++(f.ghost ? patch.ghost_count : patch.count);
      if (f.ghost)
        ghost_owner.push_back(part_[mesh_.cell_id[f.cell]]);
      else
        ++n_owned;
      mesh_.owner.push_back(f.cell);
      mesh_.boundary_id.push_back(faces_.number_of_boundary(f.id));
      push_points(mesh_.face_points, faces_.points[faces_.n_interior + f.id]);
    }
    Index at = mesh_.n_interior;
    for (Patch& p : mesh_.patches) at = (p.first = at) + p.count;
    for (Patch& p : mesh_.patches) at = (p.ghost_first = at) + p.ghost_count;
    mesh_.boundary = make_index_map(comm_, mesh_.boundary_id, n_owned, ghost_owner);
    if (faces_.first_bonded >= 0) find_twins();
  }

  /// Arrays that grew entry by entry have room for more.
  void give_back() {
    const auto shrink = [](auto&... arrays) { (arrays.shrink_to_fit(), ...); };
    shrink(mesh_.cell_id, mesh_.point_id, mesh_.boundary_id, mesh_.cell_type, mesh_.cell_points.offset,
           mesh_.cell_points.index, mesh_.cell_zone, mesh_.cell_material, mesh_.face_points.offset,
           mesh_.face_points.index, mesh_.owner, mesh_.neighbour, mesh_.neighbour_shift, points_,
           mesh_.wide_points);
  }

  void find_twins() {
    mesh_.patches.back().bonded = true;
    std::vector<std::pair<GlobalIndex, Index>> bonded;  // number, entry
    for (std::size_t b = 0; b < mesh_.boundary_id.size(); ++b)
      if (mesh_.boundary_id[b] >= faces_.first_bonded)
        bonded.emplace_back(mesh_.boundary_id[b] - faces_.first_bonded, static_cast<Index>(b));
    std::ranges::sort(bonded);
    mesh_.twin.assign(mesh_.boundary_id.size(), -1);
    for (std::size_t i = 1; i < bonded.size(); ++i) {
      if (bonded[i].first != bonded[i - 1].first + 1 || bonded[i].first % 2 == 0) continue;
      mesh_.twin[bonded[i].second] = bonded[i - 1].second;
      mesh_.twin[bonded[i - 1].second] = bonded[i].second;
    }
  }

  MPI_Comm comm_;
  int rank_;
  WholeMesh whole_;  // what the part has is given back as it goes
  RawMesh& raw_ = whole_.raw;
  const Faces& faces_ = whole_.faces;
  const std::vector<int>& part_ = whole_.part;
  const std::vector<int>& cell_material_ = whole_.cell_material;
  const std::vector<Index>& wide_points_ = whole_.wide_points;
  std::vector<Index> cell_local_, point_local_;  // -1: not on this rank
  Mesh mesh_;
  std::vector<Vec3> points_;  // per local point, as read
};

}  // namespace

LoadedMesh cut_part(MPI_Comm comm, WholeMesh&& whole) {
  auto [mesh, points] = LocalPart(comm, std::move(whole)).build();
  malloc_trim(0);  // with MPI, memory that is given back stays with the process otherwise
  Geometry geometry = compute_geometry(mesh, std::move(points));
  return {std::move(mesh), std::move(geometry)};
}

LoadedMesh distribute(MPI_Comm comm, const RawMesh& raw) {
  return cut_part(comm, make_whole_mesh(comm, raw));
}

}  // namespace couplet::mesh
