// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/distributed/surroundings.hpp"

#include <algorithm>

#include "common/base/error.hpp"
#include "common/mesh/distributed/match_faces.hpp"
#include "common/mesh/load.hpp"
#include "common/mesh/topology.hpp"

namespace couplet::mesh {
namespace {

/// Record of a cell of any block.
struct RecordOfCell {
  GlobalIndex cell;
  FaceRecord record;
};

class BlockFaces {
 public:
  BlockFaces(MPI_Comm comm, MeshBlock& block)
      : comm_(comm), block_(block), first_cell_(block.cell_shares.first(parallel::comm_rank(comm))) {}

  BlockGraph build() {
    const GlobalIndex before = parallel::exclusive_scan(comm_, GlobalIndex(block_.n_elements()));
    const std::vector<GlobalIndex> first_element =
        parallel::all_gather(comm_, std::vector<GlobalIndex>{before});
    match_within_block(before);
    MatchedFaces matched = match_faces(comm_, block_, sides_, first_element);
    sides_ = {};
    join_periodic_of(matched.bounded, before);
    number_boundary(matched.bounded, before);
    number_unnamed(matched.unnamed);
    block_.element_points = {}, block_.element_offset = {0}, block_.element_patch = {};
    split_materials_of(matched.pairs);
    if (parallel::comm_size(comm_) > 1)
      fill_graph(matched.pairs);
    else
      graph_.within = std::move(within_);
    fill_records();
    return std::move(graph_);
  }

 private:
  /// Renumbers the points used by this block's cells and orients the cells.
  RawMesh oriented_cells() {
    CellList& cells = block_.cells;
    const PointNumbers numbers(cells.points);
    RawMesh raw;
    raw.dim = block_.dim;
    raw.cell_type = cells.type;
    raw.cell_points.offset = cells.point_offset;
    raw.cell_points.index.reserve(cells.points.size());
    for (const GlobalIndex p : cells.points) raw.cell_points.index.push_back(numbers.place(p));
    raw.points = fetch(comm_, block_.point_shares, std::span<const Vec3>(block_.points), numbers.numbers());
    const double diagonal = extent_of(comm_, block_.points).diagonal();
    on_all(comm_, [&] {
      orient_cells(raw, first_cell_);
      if (block_.dim == 2) check_plane(raw.points, diagonal);
    });
    for (std::size_t i = 0; i < cells.points.size(); ++i)
      cells.points[i] = numbers.numbers()[raw.cell_points.index[i]];
    return raw;
  }

  FaceSide side_of(const HalfFace& half) const {
    return make_side(block_.cells.face_of(half.cell, half.face), first_cell_ + half.cell,
                     block_.cells.zone[half.cell], half.face);
  }

  void match_within_block(GlobalIndex first_element) {
    const RawMesh raw = oriented_cells();
    material_of_zone_ = materials_of_zones(block_);
    HalfFaces halves(raw);
    within_.reserve(halves.size() / 2);
    // Rejects a face of three or more cells in this block. Others are rejected when parts are merged.
    std::vector<FaceFault> faults;
    halves.for_each_face([&](std::span<const HalfFace> cells) {
      if (cells.size() == 1) {
        sides_.push_back(side_of(cells[0]));
      } else if (cells.size() > 2) {
        faults.push_back({FaceFault::Kind::many_cells, side_of(cells[0]).key});
      } else {
        const bool bonded = is_bonded(block_.cells.zone[cells[0].cell], block_.cells.zone[cells[1].cell]);
        within_.push_back({cells[0].cell, cells[1].cell, static_cast<std::int8_t>(cells[0].face), bonded});
        if (bonded) bonded_.push_back(make_pair(side_of(cells[0]), side_of(cells[1])));
      }
    });
    throw_face_faults(comm_, block_, faults);
    for (Index e = 0; e < block_.n_elements(); ++e)
      sides_.push_back(make_side(block_.element(e), -1 - (first_element + e), block_.element_patch[e], 0));
  }

  bool is_bonded(int zone, int other) const {
    return !material_of_zone_.empty() && material_of_zone_[zone] != material_of_zone_[other];
  }

  /// Removes joined faces from the boundary.
  void join_periodic_of(std::vector<BoundedCell>& bounded, GlobalIndex first_element) {
    if (block_.periodic.empty()) return;
    PeriodicFaces found = find_periodic_faces(comm_, block_, bounded, first_element);
    graph_.translation = std::move(found.translation);
    for (const JoinedFace& f : found.joined) {
      records_.push_back({f.cell, {f.face, 0, FaceRecord::joined(f.pair, f.side), f.other}});
      if (f.cell != f.other) joined_.push_back({f.cell, f.other});
    }
    std::erase_if(bounded, [&](const BoundedCell& b) {
      return std::ranges::binary_search(found.joined, b.element, {}, &JoinedFace::element);
    });
    const auto at_cell = [&](const auto& pair) { return block_.cell_shares.rank_of(pair[0]); };
    joined_ = parallel::exchange(comm_, parallel::sort_by_rank(comm_, joined_, at_cell)).items;
  }

  /// Numbers boundary faces in the order of their elements. Of duplicate elements the first counts.
  void number_boundary(const std::vector<BoundedCell>& bounded, GlobalIndex first_element) {
    GlobalIndex number = parallel::exclusive_scan(comm_, GlobalIndex(bounded.size()));
    n_boundary_ = parallel::sum(comm_, GlobalIndex(bounded.size()));
    for (const BoundedCell& b : bounded)
      records_.push_back({b.cell, {b.face, 0, block_.element_patch[b.element - first_element], number++}});
  }

  /// Numbers boundary faces without an element behind the others, in the order of their cells.
  void number_unnamed(const std::vector<FaceSide>& unnamed) {
    const GlobalIndex n = parallel::sum(comm_, GlobalIndex(unnamed.size()));
    if (n == 0) return;
    const int patch = rest_of(block_.patches);
    GlobalIndex number = n_boundary_ + parallel::exclusive_scan(comm_, GlobalIndex(unnamed.size()));
    for (const FaceSide& side : unnamed) records_.push_back({side.cell, {side.face, 0, patch, number++}});
    n_boundary_ += n;
  }

  /// Creates two boundary faces for each face between two materials, numbered by the face's cells.
  void split_materials_of(const std::vector<FacePair>& pairs) {
    for (const FacePair& p : pairs)
      if (p.cell < p.other && is_bonded(block_.cells.zone[p.cell - first_cell_], p.other_zone))
        bonded_.push_back(p);
    if (parallel::sum(comm_, GlobalIndex(bonded_.size())) == 0) return;
    std::ranges::sort(bonded_, {}, [](const FacePair& p) { return std::pair(p.cell, p.other); });
    graph_.first_bonded = n_boundary_;
    GlobalIndex number = n_boundary_ + 2 * parallel::exclusive_scan(comm_, GlobalIndex(bonded_.size()));
    const int patch = static_cast<int>(block_.patches.size());
    for (const FacePair& p : bonded_) {
      records_.push_back({p.cell, {p.face, 0, patch, number++}});
      records_.push_back(
          {p.other, {p.other_face, block_.dim == 2 ? std::int8_t(0) : p.turn, patch, number++}});
    }
  }

  void fill_graph(const std::vector<FacePair>& pairs) {
    graph_.offset.assign(block_.cells.size() + 1, 0);
    for (const auto& p : within_) ++graph_.offset[p.cell + 1], ++graph_.offset[p.other + 1];
    for (const FacePair& p : pairs) ++graph_.offset[p.cell - first_cell_ + 1];
    for (const auto& [cell, other] : joined_) ++graph_.offset[cell - first_cell_ + 1];
    std::partial_sum(graph_.offset.begin(), graph_.offset.end(), graph_.offset.begin());
    graph_.neighbours.resize(graph_.offset.back());
    std::vector<Index> next(graph_.offset.begin(), graph_.offset.end() - 1);
    for (const auto& p : within_) {
      graph_.neighbours[next[p.cell]++] = first_cell_ + p.other;
      graph_.neighbours[next[p.other]++] = first_cell_ + p.cell;
    }
    within_ = {};
    for (const FacePair& p : pairs) graph_.neighbours[next[p.cell - first_cell_]++] = p.other;
    for (const auto& [cell, other] : joined_) graph_.neighbours[next[cell - first_cell_]++] = other;
    // Cells that share several inner or periodic faces are neighbors only once.
    GlobalIndex* to = graph_.neighbours.data();
    for (Index c = 0, first = 0; c < block_.cells.size(); ++c) {
      const auto begin = graph_.neighbours.begin() + first,
                 end = graph_.neighbours.begin() + graph_.offset[c + 1];
      first = graph_.offset[c + 1];
      std::sort(begin, end);
      to = std::copy(begin, std::unique(begin, end), to);
      graph_.offset[c + 1] = static_cast<Index>(to - graph_.neighbours.data());
    }
    graph_.neighbours.resize(std::size_t(graph_.offset.back()));
  }

  void fill_records() {
    const auto at_cell = [&](const RecordOfCell& r) { return block_.cell_shares.rank_of(r.cell); };
    std::vector<RecordOfCell> all =
        parallel::exchange(comm_, parallel::sort_by_rank(comm_, records_, at_cell)).items;
    records_ = {};
    std::ranges::sort(all, {}, [](const RecordOfCell& r) { return std::pair(r.cell, r.record.face); });
    CellList& cells = block_.cells;
    cells.record_offset.assign(1, 0);
    auto at = all.begin();
    for (Index c = 0; c < cells.size(); ++c) {
      for (; at != all.end() && at->cell == first_cell_ + c; ++at) cells.records.push_back(at->record);
      cells.record_offset.push_back(static_cast<Index>(cells.records.size()));
    }
  }

  MPI_Comm comm_;
  MeshBlock& block_;
  GlobalIndex first_cell_, n_boundary_ = 0;
  std::vector<int> material_of_zone_;
  std::vector<FaceSide> sides_;  // without a partner in this block
  std::vector<BlockGraph::CellPair> within_;
  // Cells that share a periodic face, the one of this block first.
  std::vector<std::array<GlobalIndex, 2>> joined_;
  std::vector<FacePair> bonded_;  // as seen by the cell with the smaller number
  std::vector<RecordOfCell> records_;
  BlockGraph graph_;
};

}  // namespace

BlockGraph find_block_faces(MPI_Comm comm, MeshBlock& block) { return BlockFaces(comm, block).build(); }

}  // namespace couplet::mesh
