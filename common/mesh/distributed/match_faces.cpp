// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/distributed/match_faces.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <tuple>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/log/log.hpp"
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

/// Cell at a fault.
struct CellAtFault {
  std::array<GlobalIndex, 8> points{};  ///< ascending
  std::size_t fault;
  CellType type;
  int zone;
};

/// Cells of all blocks that have one of these faces. Collective.
std::vector<CellAtFault> cells_at(MPI_Comm comm, const MeshBlock& block,
                                  const std::vector<FaceFault>& faults) {
  std::vector<CellAtFault> found;
  for (Index c = 0; c < block.cells.size(); ++c)
    for (int f = 0; f < shape_of(block.cells.type[c]).n_faces; ++f) {
      const FaceKey key = make_side(block.cells.face_of(c, f), 0, 0, f).key;
      for (std::size_t i = 0; i < faults.size(); ++i) {
        if (faults[i].face != key) continue;
        found.push_back({{}, i, block.cells.type[c], block.cells.zone[c]});
        std::ranges::copy(block.cells.points_of(c), found.back().points.begin());
        std::ranges::sort(found.back().points);
      }
    }
  return parallel::all_gather(comm, found);
}

/// Throws Error if two of the cells are the same one, as .msh 2.2 has a cell in two groups.
void refuse_twin(const std::vector<CellAtFault>& cells, const std::vector<std::string>& zones,
                 const std::vector<std::string>& places) {
  for (std::size_t i = 0; i < cells.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const CellAtFault &one = cells[k], &other = cells[i];
      if (one.fault != other.fault || one.points != other.points) continue;
      if (one.zone == other.zone)
        throw Error("The mesh has the {} at {} twice.", name_of(one.type), places[one.fault]);
      throw Error("The {} at {} is in two groups, '{}' and '{}'. A cell must be in exactly one.",
                  name_of(one.type), places[one.fault], zones[std::size_t(one.zone)],
                  zones[std::size_t(other.zone)]);
    }
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
  std::vector<FaceSide> unnamed;
  std::vector<FaceFault> faults;

 private:
  void meet(std::span<const FaceSide> cells, std::span<const FaceSide> elements) {
    using enum FaceFault::Kind;
    const FaceKey& face = cells.empty() ? elements[0].key : cells[0].key;
    if (cells.size() > 2) return faults.push_back({many_cells, face});
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
      unnamed.push_back(cells[0]);
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
  std::array<std::size_t, 4> count{};
  std::vector<FaceFault> all;
  for (const FaceFault& fault : found)
    if (count[std::size_t(fault.kind)]++ < most_told) all.push_back(fault);
  all = parallel::all_gather(comm, all);
  if (all.empty()) return;
  std::ranges::stable_sort(all, {}, [](const FaceFault& f) { return std::max(f.kind, two_patches); });
  const std::vector<std::string> places = places_of(comm, block, all);
  const std::vector<CellAtFault> cells = cells_at(comm, block, all);
  refuse_twin(cells, block.zones, places);
  const GlobalIndex n_cells = std::ranges::count(cells, std::size_t(0), &CellAtFault::fault);
  const auto patch = [&](int number) { return block.patches[std::size_t(number)]; };
  const FaceFault& first = all.front();
  switch (first.kind) {
    case many_cells:
      throw Error(face_of_many_cells(n_cells, places[0]));
    case inside:
      throw Error(face_inside(patch(first.patch), places[0]));
    case two_patches:
      throw Error(face_in_two_patches(patch(first.patch), patch(first.other), places[0]));
    case orphan:
      throw Error(n_cells > 0 ? face_inside(patch(first.patch), places[0])
                              : face_without_cell(patch(first.patch), places[0]));
  }
}

namespace {

/// Logs the number of boundary faces without a name and where some are. Collective.
void tell_unnamed(MPI_Comm comm, const MeshBlock& block, std::span<const FaceSide> unnamed) {
  const GlobalIndex n = parallel::sum(comm, GlobalIndex(unnamed.size()));
  if (n == 0) return;
  std::vector<FaceFault> first;
  for (const FaceSide& side : unnamed.first(std::min(most_told, unnamed.size())))
    first.push_back({FaceFault::Kind::orphan, side.key});
  first = parallel::all_gather(comm, first);
  first.resize(std::min(most_told, first.size()));
  const std::vector<std::string> places = places_of(comm, block, first);
  if (parallel::comm_rank(comm) != 0) return;
  log::info(
      "mesh: {} boundary face{} in no group {} the patch 'rest', at {}{} (a location inside the domain: two "
      "coincident points there should be one)",
      n, n == 1 ? "" : "s", n == 1 ? "forms" : "form", base::join(places),
      n > std::ssize(places) ? ", ..." : "");
}

}  // namespace

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
  const auto at_cell = [&](const FaceSide& s) { return block.cell_shares.rank_of(s.cell); };
  matched.unnamed = parallel::exchange(comm, parallel::sort_by_rank(comm, meeting.unnamed, at_cell)).items;
  std::ranges::sort(matched.unnamed, {}, [](const FaceSide& s) { return std::pair(s.cell, s.face); });
  tell_unnamed(comm, block, matched.unnamed);
  return matched;
}

}  // namespace couplet::mesh
