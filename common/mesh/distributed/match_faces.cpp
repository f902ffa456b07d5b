// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/distributed/match_faces.hpp"

#include <algorithm>
#include <limits>
#include <tuple>

#include "common/base/error.hpp"
#include "common/mesh/cell_shapes.hpp"
#include "common/mesh/load.hpp"
#include "common/mesh/topology.hpp"

namespace couplet::mesh {
namespace {

std::string face_without_cell(const std::string& patch, const std::string& where) {
  return fmt::format(
      "Patch '{}' has a face at {} that belongs to no cell. Mesh the boundary and the interior together so "
      "that their points coincide.",
      patch, where);
}

std::string face_inside(const std::string& patch, const std::string& where) {
  return fmt::format(
      "Patch '{}' has a face at {} that lies between two cells. A patch must lie on the boundary; remove the "
      "inner surface from the physical group (or the mesh contains every cell twice).",
      patch, where);
}

std::string face_in_two_patches(const std::string& one, const std::string& other, const std::string& where) {
  return fmt::format(
      "The boundary face at {} is in two patches, '{}' and '{}'. Every boundary face must be in exactly one "
      "patch.",
      where, one, other);
}

std::string faces_in_no_patch(GlobalIndex n, const std::vector<std::string>& places, int dim) {
  std::string text;
  for (const std::string& at : places) text += (text.empty() ? "" : ", ") + at;
  return fmt::format(
      "{} boundary face{} in no patch, with centre{} {}{}. Every boundary face must be in exactly one "
      "patch: add {} to a physical group (for a location inside the domain: the mesh has two coincident "
      "points there that should be one).",
      n, n == 1 ? " is" : "s are", n == 1 ? "" : "s", text, n > GlobalIndex(places.size()) ? ", ..." : "",
      dim == 2 ? "the curve (Physical Curve)" : "the surface (Physical Surface)");
}

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

int at_place(std::uint8_t order, int i) { return order >> 2 * i & 3; }

/// The faces whose smallest point is in this rank's share.
class MeetingFaces {
 public:
  MeetingFaces(const MeshBlock& block, std::vector<FaceSide> sides)
      : block_(block), sides_(std::move(sides)) {
    std::ranges::sort(sides_, [](const FaceSide& a, const FaceSide& b) {
      return std::tuple(a.key, a.is_element(), std::max(a.cell, -1 - a.cell)) <
             std::tuple(b.key, b.is_element(), std::max(b.cell, -1 - b.cell));
    });
    for (auto run = sides_.begin(); run != sides_.end();) {
      const auto end = std::find_if(run, sides_.end(), [&](const FaceSide& s) { return s.key != run->key; });
      const auto middle = std::find_if(run, end, [](const FaceSide& s) { return s.is_element(); });
      meet({run, middle}, {middle, end});
      run = end;
    }
  }

  std::vector<FacePair> pairs;  // as each of the two is told
  std::vector<BoundedCell> bounded;
  FaceFaults faults;

 private:
  void fault(const FaceKey& face, std::function<std::string(const std::string&)> text) {
    faults.faults.push_back({face, std::move(text)});
  }

  void meet(std::span<const FaceSide> cells, std::span<const FaceSide> elements) {
    const FaceKey& face = cells.empty() ? elements[0].key : cells[0].key;
    if (cells.size() > 2)
      return fault(face, [n = cells.size()](const std::string& at) { return face_of_many_cells(n, at); });
    if (!elements.empty() && cells.empty()) return faults.orphans.push_back({face, elements[0].group});
    if (!elements.empty()) {
      const std::string& patch = block_.patches[elements[0].group];
      if (cells.size() == 2)
        return fault(face, [patch](const std::string& at) { return face_inside(patch, at); });
      for (const FaceSide& e : elements)
        if (e.group != elements[0].group)
          return fault(face, [patch, other = block_.patches[e.group]](const std::string& at) {
            return face_in_two_patches(patch, other, at);
          });
      bounded.push_back({-1 - elements[0].cell, cells[0].cell, cells[0].face});
    } else if (cells.size() == 2) {
      pairs.push_back(make_pair(cells[0], cells[1]));
      pairs.push_back(make_pair(cells[1], cells[0]));
    } else {
      faults.unassigned.push_back(face);
    }
  }

  const MeshBlock& block_;
  std::vector<FaceSide> sides_;
};

}  // namespace

std::string face_of_many_cells(std::size_t cells, const std::string& where) {
  return fmt::format(
      "{} cells share the face at {}, but a face has at most two cells; the mesh has duplicate or "
      "overlapping cells.",
      cells, where);
}

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

FaceSide make_side(std::span<const GlobalIndex> points, GlobalIndex cell, int group, int face) {
  FaceSide side{{-1, -1, -1, -1}, cell, group, static_cast<std::int8_t>(face), 0, 0};
  side.n = static_cast<std::int8_t>(points.size());
  constexpr GlobalIndex last = std::numeric_limits<GlobalIndex>::max();
  side.key.fill(last);
  std::ranges::copy(points, side.key.begin());
  std::ranges::sort(side.key);
  std::ranges::replace(side.key, last, GlobalIndex(-1));
  for (int i = 0; i < side.n; ++i) {
    const auto place = std::find(side.key.begin(), side.key.end(), points[i]) - side.key.begin();
    side.order = static_cast<std::uint8_t>(side.order | place << 2 * i);
  }
  return side;
}

FacePair make_pair(const FaceSide& cell, const FaceSide& other) {
  const FaceSide &owner = cell.cell < other.cell ? cell : other,
                 &second = cell.cell < other.cell ? other : cell;
  int turn = 0;
  while (turn + 1 < second.n && at_place(second.order, turn) != at_place(owner.order, 0)) ++turn;
  return {cell.cell, other.cell, other.group, cell.face, other.face, static_cast<std::int8_t>(turn)};
}

MatchedFaces match_faces(MPI_Comm comm, const MeshBlock& block, const std::vector<FaceSide>& sides,
                         const std::vector<GlobalIndex>& first_element) {
  const auto at_point = [&](const FaceSide& s) { return block.point_shares.rank_of(s.key[0]); };
  MeetingFaces meeting(block, parallel::exchange(comm, parallel::sort_by_rank(comm, sides, at_point)).items);
  throw_face_faults(comm, block, meeting.faults);
  MatchedFaces matched;
  matched.pairs =
      parallel::exchange(
          comm, parallel::sort_by_rank(comm, meeting.pairs,
                                       [&](const FacePair& p) { return block.cell_shares.rank_of(p.cell); }))
          .items;
  matched.bounded = parallel::exchange(comm, parallel::sort_by_rank(comm, meeting.bounded,
                                                                    [&](const BoundedCell& b) {
                                                                      return std::ranges::upper_bound(
                                                                                 first_element, b.element) -
                                                                             first_element.begin() - 1;
                                                                    }))
                        .items;
  std::ranges::sort(matched.bounded, {}, &BoundedCell::element);
  return matched;
}

}  // namespace couplet::mesh
