// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/distributed/face_faults.hpp"

#include <algorithm>

#include "common/base/error.hpp"
#include "common/mesh/cell_shapes.hpp"
#include "common/mesh/distributed/match_faces.hpp"
#include "common/mesh/on_root.hpp"
#include "common/mesh/topology.hpp"

namespace couplet::mesh {
namespace {

constexpr std::size_t most_told = 3;

/// Their middles, as text. Collective.
std::vector<std::string> places_of(MPI_Comm comm, const MeshBlock& block, const std::vector<FaceKey>& faces) {
  std::vector<GlobalIndex> all;
  for (const FaceKey& face : faces)
    for (const GlobalIndex p : face)
      if (p >= 0) all.push_back(p);
  const PointNumbers points(all);
  const std::vector<Vec3> x =
      fetch(comm, block.point_shares, std::span<const Vec3>(block.points), points.numbers());
  std::vector<std::string> places;
  for (const FaceKey& face : faces) {
    Vec3 sum = Vec3::Zero();
    int n = 0;
    for (const GlobalIndex p : face)
      if (p >= 0) sum += x[points.place(p)], ++n;
    places.push_back(place(sum / n, block.dim));
  }
  return places;
}

/// How many cells have each of these faces, of which each rank has some. Collective.
std::vector<GlobalIndex> cells_with(MPI_Comm comm, const MeshBlock& block,
                                    const std::vector<FaceKey>& faces) {
  std::vector<GlobalIndex> count;
  for (const FaceKey& face : parallel::all_gather(comm, faces)) {
    count.push_back(0);
    for (Index c = 0; c < block.cells.size(); ++c) {
      const CellShape& shape = shape_of(block.cells.type[c]);
      for (int f = 0; f < shape.n_faces; ++f) {
        std::vector<GlobalIndex> points;
        for (int i = 0; i < shape.face_size(f); ++i)
          points.push_back(block.cells.points_of(c)[shape.faces[f][i]]);
        count.back() += make_side(points, 0, 0, f).key == face;
      }
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, count.data(), static_cast<int>(count.size()), MPI_INT64_T, MPI_SUM, comm);
  const GlobalIndex first = parallel::exclusive_scan(comm, GlobalIndex(faces.size()));
  return {count.begin() + first, count.begin() + first + GlobalIndex(faces.size())};
}

/// The first of a list, if there is one, as a list.
template <class T>
std::vector<T> first_of_list(const std::vector<T>& list) {
  return {list.begin(), list.begin() + (list.empty() ? 0 : 1)};
}

/// Faces that a cell has alone, though others that met each other in their own block may have it, too. Collective.
void throw_unassigned(MPI_Comm comm, const MeshBlock& block, const std::vector<FaceKey>& unassigned) {
  const std::vector<FaceKey> first = first_of_list(unassigned);
  const std::vector<GlobalIndex> cells = cells_with(comm, block, first);
  const std::vector<FaceKey> some(
      unassigned.begin(), unassigned.begin() + std::ptrdiff_t(std::min(most_told, unassigned.size())));
  const std::vector<std::string> mine = places_of(comm, block, some);
  on_all(comm, [&] {
    if (!first.empty() && cells[0] > 2) throw Error(face_of_many_cells(std::size_t(cells[0]), mine[0]));
  });
  std::string text;
  for (const std::string& at : mine) text += at + '\n';
  const std::vector<char> all = parallel::all_gather(comm, std::vector<char>(text.begin(), text.end()));
  const GlobalIndex n = parallel::sum(comm, GlobalIndex(unassigned.size()));
  std::vector<std::string> places;
  for (auto at = all.begin(); at != all.end() && places.size() < most_told;) {
    const auto end = std::find(at, all.end(), '\n');
    places.emplace_back(at, end);
    at = end + 1;
  }
  throw Error(faces_in_no_patch(n, places, block.dim));
}

}  // namespace

void throw_face_faults(MPI_Comm comm, const MeshBlock& block, const FaceFaults& found) {
  const bool mine = !found.faults.empty() || !found.unassigned.empty() || !found.orphans.empty();
  if (!parallel::any(comm, mine)) return;
  std::vector<FaceKey> told;
  if (!found.faults.empty()) told.push_back(found.faults.front().face);
  const std::vector<std::string> fault_places = places_of(comm, block, told);
  on_all(comm, [&] {
    if (!found.faults.empty()) throw Error(found.faults.front().text(fault_places.front()));
  });
  std::vector<FaceKey> orphan;
  for (const auto& [face, patch] : first_of_list(found.orphans)) orphan.push_back(face);
  const std::vector<std::string> orphan_places = places_of(comm, block, orphan);
  const std::vector<GlobalIndex> cells = cells_with(comm, block, orphan);
  on_all(comm, [&] {
    if (orphan.empty()) return;
    const std::string& patch = block.patches[found.orphans.front().second];
    throw Error(cells[0] > 0 ? face_inside(patch, orphan_places[0])
                             : face_without_cell(patch, orphan_places[0]));
  });
  throw_unassigned(comm, block, found.unassigned);
}

}  // namespace couplet::mesh
