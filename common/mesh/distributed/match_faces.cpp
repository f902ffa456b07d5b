// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/distributed/match_faces.hpp"

#include <algorithm>
#include <limits>
#include <tuple>

#include "common/mesh/cell_shapes.hpp"
#include "common/mesh/topology.hpp"

namespace couplet::mesh {
namespace {

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
