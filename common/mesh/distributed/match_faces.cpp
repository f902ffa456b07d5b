// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/distributed/match_faces.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <tuple>
#include <utility>

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
      "Patch '{}' has a face at {} that lies between two cells. A patch must lie on the boundary; remove the inner surface "
      "from the physical group. If there is none, check whether the mesh contains every cell twice.",
      patch, where);
}

std::string face_in_two_patches(const std::string& one, const std::string& other, const std::string& where) {
  return fmt::format(
      "The boundary face at {} is in two patches, '{}' and '{}'. Every boundary face must be in exactly one patch.",
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
      "{} cells share the face at {}, but a face has at most two cells; the mesh has duplicate or overlapping cells.",
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
void warn_unnamed(MPI_Comm comm, const MeshBlock& block, std::span<const FaceSide> unnamed) {
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
      "mesh: {} boundary face{} in no physical group {} the patch 'rest', at {}{}. If such a location is inside the domain, "
      "the mesh has duplicate points there; merge them.",
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
  warn_unnamed(comm, block, matched.unnamed);
  return matched;
}

namespace {

/// Maximum distance of a face center from its partner's, relative to the size of the face.
constexpr double periodic_tolerance = 1e-4;

struct PeriodicSide {
  Vec3 centre;
  double size;  // largest distance of a point from the center
  GlobalIndex element, cell;
  std::int8_t face, side;
  /// Coordinate along a direction in which meshes are not aligned.
  double key() const { return 0.5377 * centre[0] + 0.3315 * centre[1] + 0.7751 * centre[2]; }
};

/// Faces of both patches on this rank. Collective.
std::vector<PeriodicSide> sides_here(MPI_Comm comm, const MeshBlock& block,
                                     const std::array<std::string, 2>& names,
                                     const std::vector<BoundedCell>& bounded, GlobalIndex first_element) {
  std::array<int, 2> patch{};
  for (int s = 0; s < 2; ++s) {
    const auto found = std::ranges::find(block.patches, names[s]);
    if (found == block.patches.end()) throw Error("The periodic patch '{}' does not exist.", names[s]);
    patch[s] = static_cast<int>(found - block.patches.begin());
  }
  std::vector<PeriodicSide> sides;
  std::vector<GlobalIndex> used;
  for (const BoundedCell& b : bounded) {
    const auto e = static_cast<Index>(b.element - first_element);
    for (std::int8_t s = 0; s < 2; ++s) {
      if (block.element_patch[e] != patch[s]) continue;
      sides.push_back({Vec3::Zero(), 0, b.element, b.cell, b.face, s});
      used.insert(used.end(), block.element(e).begin(), block.element(e).end());
    }
  }
  const PointNumbers numbers(used);
  const std::vector<Vec3> x =
      fetch(comm, block.point_shares, std::span<const Vec3>(block.points), numbers.numbers());
  for (PeriodicSide& side : sides) {
    const auto points = block.element(static_cast<Index>(side.element - first_element));
    for (const GlobalIndex p : points) side.centre += x[numbers.place(p)] / double(points.size());
    for (const GlobalIndex p : points)
      side.size = std::max(side.size, (x[numbers.place(p)] - side.centre).norm());
  }
  return sides;
}

/// Translation from the mean center of the first patch's faces to that of the second's.
Vec3 translation_of(const std::vector<PeriodicSide>& all, const std::array<std::string, 2>& names) {
  std::array<Vec3, 2> sum{Vec3::Zero(), Vec3::Zero()};
  std::array<GlobalIndex, 2> count{};
  for (const PeriodicSide& s : all) sum[s.side] += s.centre, ++count[s.side];
  if (count[0] != count[1] || count[0] == 0)
    throw Error(
        "The periodic patches '{}' and '{}' have {} and {} faces. Mesh both identically (gmsh: Periodic "
        "Curve or Periodic Surface).",
        names[0], names[1], count[0], count[1]);
  return sum[1] / double(count[1]) - sum[0] / double(count[0]);
}

/// Cell across each side, or -1. The first patch is translated onto the second.
std::vector<GlobalIndex> cells_beyond(std::vector<PeriodicSide> all, const Vec3& translation) {
  std::array<std::vector<std::size_t>, 2> order;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].side == 0) all[i].centre += translation;
    order[std::size_t(all[i].side)].push_back(i);
  }
  for (auto& of_side : order)
    std::ranges::sort(of_side, {}, [&](std::size_t i) { return std::pair(all[i].key(), all[i].element); });
  std::vector<GlobalIndex> beyond(all.size(), -1);
  for (const std::size_t a : order[0]) {
    const double reach = periodic_tolerance * all[a].size, key = all[a].key();
    auto b = std::ranges::lower_bound(order[1], key - reach, {}, [&](std::size_t i) { return all[i].key(); });
    for (; b != order[1].end() && all[*b].key() <= key + reach; ++b) {
      if (beyond[*b] >= 0 || (all[*b].centre - all[a].centre).norm() > reach) continue;
      beyond[a] = all[*b].cell;
      beyond[*b] = all[a].cell;
      break;
    }
  }
  return beyond;
}

}  // namespace

PeriodicFaces find_periodic_faces(MPI_Comm comm, const MeshBlock& block,
                                  const std::vector<BoundedCell>& bounded, GlobalIndex first_element) {
  PeriodicFaces found;
  for (std::size_t pair = 0; pair < block.periodic.size(); ++pair) {
    const auto& names = block.periodic[pair];
    const std::vector<PeriodicSide> here = sides_here(comm, block, names, bounded, first_element),
                                    all = parallel::all_gather(comm, here);
    const Vec3 translation = translation_of(all, names);
    const std::vector<GlobalIndex> beyond = cells_beyond(all, translation);
    for (std::size_t i = 0; i < all.size(); ++i)
      if (beyond[i] < 0 && all[i].side == 0)
        throw Error(
            "The face at {} of the periodic patch '{}' has no match on '{}' at {}. The patches must be "
            "translated copies of each other.",
            place(all[i].centre, block.dim), names[0], names[1],
            place(all[i].centre + translation, block.dim));
    const auto before = std::size_t(parallel::exclusive_scan(comm, GlobalIndex(here.size())));
    for (std::size_t i = 0; i < here.size(); ++i) {
      const PeriodicSide& s = here[i];
      found.joined.push_back({s.element, s.cell, beyond[before + i], s.face, s.side, static_cast<int>(pair)});
    }
    found.translation.push_back(translation);
  }
  std::ranges::sort(found.joined, {}, &JoinedFace::element);
  return found;
}

}  // namespace couplet::mesh
