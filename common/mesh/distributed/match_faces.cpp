// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/distributed/match_faces.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <tuple>

#include "common/base/error.hpp"
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

/// Centers of the faces as text. Collective.
std::vector<std::string> places_of(MPI_Comm comm, const MeshBlock& block,
                                   const std::vector<FaceFault>& faults) {
  std::vector<GlobalIndex> all;
  for (const FaceFault& fault : faults)
    std::ranges::copy_if(fault.face, std::back_inserter(all), [](GlobalIndex p) { return p >= 0; });
  const PointNumbers points(all);
  const std::vector<Vec3> x =
      fetch(comm, block.point_shares, std::span<const Vec3>(block.points), points.numbers());
  std::vector<std::string> places;
  for (const FaceFault& fault : faults) {
    Vec3 sum = Vec3::Zero();
    int n = 0;
    for (const GlobalIndex p : fault.face)
      if (p >= 0) sum += x[points.place(p)], ++n;
    places.push_back(place(sum / n, block.dim));
  }
  return places;
}

/// Number of cells of all blocks that have each of these faces. Collective.
std::vector<GlobalIndex> cells_with(MPI_Comm comm, const MeshBlock& block,
                                    const std::vector<FaceFault>& faults) {
  std::vector<GlobalIndex> count(faults.size(), 0);
  for (Index c = 0; c < block.cells.size(); ++c)
    for (int f = 0; f < shape_of(block.cells.type[c]).n_faces; ++f) {
      const FaceKey key = make_side(block.cells.face_of(c, f), 0, 0, f).key;
      for (std::size_t i = 0; i < faults.size(); ++i) count[i] += faults[i].face == key;
    }
  MPI_Allreduce(MPI_IN_PLACE, count.data(), static_cast<int>(count.size()), MPI_INT64_T, MPI_SUM, comm);
  return count;
}

int at_place(std::uint8_t order, int i) { return order >> 2 * i & 3; }

/// Faces whose smallest point is in this rank's share.
class MeetingFaces {
 public:
  explicit MeetingFaces(std::vector<FaceSide> sides) : sides_(std::move(sides)) {
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

  std::vector<FacePair> pairs;  // as reported to each cell
  std::vector<BoundedCell> bounded;
  std::vector<FaceFault> faults;

 private:
  void meet(std::span<const FaceSide> cells, std::span<const FaceSide> elements) {
    using enum FaceFault::Kind;
    const FaceKey& face = cells.empty() ? elements[0].key : cells[0].key;
    if (cells.size() > 2) return faults.push_back({many_cells, face, 0, 0, std::ssize(cells)});
    if (!elements.empty()) {
      const int patch = elements[0].group;
      if (cells.size() != 1) return faults.push_back({cells.empty() ? orphan : inside, face, patch});
      for (const FaceSide& e : elements)
        if (e.group != patch) return faults.push_back({two_patches, face, patch, e.group});
      bounded.push_back({-1 - elements[0].cell, cells[0].cell, cells[0].face});
    } else if (cells.size() == 2) {
      pairs.push_back(make_pair(cells[0], cells[1]));
      pairs.push_back(make_pair(cells[1], cells[0]));
    } else {
      faults.push_back({unassigned, face});
    }
  }

  std::vector<FaceSide> sides_;
};

}  // namespace

std::string face_of_many_cells(GlobalIndex cells, const std::string& where) {
  return fmt::format(
      "{} cells share the face at {}, but a face has at most two cells; the mesh has duplicate or "
      "overlapping cells.",
      cells, where);
}

void throw_face_faults(MPI_Comm comm, const MeshBlock& block, const std::vector<FaceFault>& found) {
  using enum FaceFault::Kind;
  std::array<std::size_t, 5> count{};
  std::vector<FaceFault> all;
  for (const FaceFault& fault : found)
    if (count[std::size_t(fault.kind)]++ < most_told) all.push_back(fault);
  all = parallel::all_gather(comm, all);
  if (all.empty()) return;
  std::ranges::stable_sort(all, {}, [](const FaceFault& f) { return std::max(f.kind, two_patches); });
  const std::vector<std::string> places = places_of(comm, block, all);
  const std::vector<GlobalIndex> cells = cells_with(comm, block, all);
  const GlobalIndex n_unassigned = parallel::sum(comm, GlobalIndex(count[std::size_t(unassigned)]));
  const auto patch = [&](int number) { return block.patches[std::size_t(number)]; };
  const FaceFault& first = all.front();
  switch (first.kind) {
    case many_cells:
      throw Error(face_of_many_cells(first.cells, places[0]));
    case inside:
      throw Error(face_inside(patch(first.patch), places[0]));
    case two_patches:
      throw Error(face_in_two_patches(patch(first.patch), patch(first.other), places[0]));
    case orphan:
      throw Error(cells[0] > 0 ? face_inside(patch(first.patch), places[0])
                               : face_without_cell(patch(first.patch), places[0]));
    case unassigned:
      // Faces matched within their own block may also have more than two cells.
      for (std::size_t i = 0; i < all.size(); ++i)
        if (cells[i] > 2) throw Error(face_of_many_cells(cells[i], places[i]));
      throw Error(faces_in_no_patch(
          n_unassigned, {places.begin(), places.begin() + std::ptrdiff_t(std::min(most_told, places.size()))},
          block.dim));
  }
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
  MeetingFaces meeting(parallel::exchange(comm, parallel::sort_by_rank(comm, sides, at_point)).items);
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
