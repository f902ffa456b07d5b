// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/distributed/cell_list.hpp"

#include <algorithm>
#include <numeric>

#include "common/mesh/cell_shapes.hpp"

namespace couplet::mesh {

void CellList::push(const CellList& other, Index c, GlobalIndex number) {
  id.push_back(number);
  type.push_back(other.type[c]);
  zone.push_back(other.zone[c]);
  const auto cell_points = other.points_of(c);
  points.insert(points.end(), cell_points.begin(), cell_points.end());
  point_offset.push_back(static_cast<Index>(points.size()));
  const auto cell_records = other.records_of(c);
  records.insert(records.end(), cell_records.begin(), cell_records.end());
  record_offset.push_back(static_cast<Index>(records.size()));
}

std::size_t packed_size(const CellList& cells, Index c) {
  return 2 + cells.points_of(c).size() + 2 * cells.records_of(c).size();
}

// number; type, number of records, zone; points; of each record: face, turn, patch; number.
GlobalIndex* pack(const CellList& cells, Index c, GlobalIndex id, GlobalIndex* to) {
  const auto records = cells.records_of(c);
  *to++ = id;
  *to++ = GlobalIndex(cells.type[c]) | GlobalIndex(records.size()) << 8 | GlobalIndex(cells.zone[c]) << 32;
  to = std::ranges::copy(cells.points_of(c), to).out;
  for (const FaceRecord& r : records) {
    *to++ = GlobalIndex(r.face) | GlobalIndex(r.turn) << 8 | GlobalIndex(r.patch) * (GlobalIndex(1) << 32);
    *to++ = r.number;
  }
  return to;
}

void unpack(std::span<const GlobalIndex> packed, CellList& cells) {
  for (auto at = packed.begin(); at != packed.end();) {
    cells.id.push_back(*at++);
    cells.type.push_back(static_cast<CellType>(*at & 0xff));
    const auto n_records = std::size_t(*at >> 8 & 0xff);
    cells.zone.push_back(static_cast<int>(*at++ >> 32));
    const auto n_points = shape_of(cells.type.back()).n_points;
    cells.points.insert(cells.points.end(), at, at + n_points);
    at += n_points;
    for (std::size_t i = 0; i < n_records; ++i, at += 2)
      cells.records.push_back({static_cast<std::int8_t>(at[0] & 0xff),
                               static_cast<std::int8_t>(at[0] >> 8 & 0xff), static_cast<int>(at[0] >> 32),
                               at[1]});
    cells.point_offset.push_back(static_cast<Index>(cells.points.size()));
    cells.record_offset.push_back(static_cast<Index>(cells.records.size()));
  }
}

CellList sorted(const CellList& cells) {
  std::vector<Index> order(cells.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, [&](Index a, Index b) { return cells.id[a] < cells.id[b]; });
  const auto repeated =
      std::ranges::unique(order, [&](Index a, Index b) { return cells.id[a] == cells.id[b]; });
  order.erase(repeated.begin(), repeated.end());
  CellList result;
  result.id.reserve(order.size()), result.type.reserve(order.size()), result.zone.reserve(order.size());
  result.points.reserve(cells.points.size()), result.records.reserve(cells.records.size());
  result.point_offset.reserve(order.size() + 1), result.record_offset.reserve(order.size() + 1);
  for (const Index c : order) result.push(cells, c, cells.id[c]);
  return result;
}

PointNumbers::PointNumbers(std::span<const GlobalIndex> all) {
  if (all.empty()) return;
  const auto [least, most] = std::ranges::minmax(all);
  // Points of a part are mostly numbered close together: a table of them is quicker than searching.
  if (std::size_t(most - least) > all.size()) {
    numbers_.assign(all.begin(), all.end());
    std::ranges::sort(numbers_);
    numbers_.erase(std::ranges::unique(numbers_).begin(), numbers_.end());
    numbers_.shrink_to_fit();
    return;
  }
  table_.assign(std::size_t(most - least) + 1, 0);
  for (const GlobalIndex number : all) table_[number - least] = 1;
  numbers_.reserve(std::accumulate(table_.begin(), table_.end(), std::size_t(0)));
  for (std::size_t i = 0; i < table_.size(); ++i)
    if (table_[i] != 0) {
      table_[i] = static_cast<Index>(numbers_.size());
      numbers_.push_back(least + GlobalIndex(i));
    }
}

Index PointNumbers::place(GlobalIndex number) const {
  if (!table_.empty()) return table_[number - numbers_.front()];
  return static_cast<Index>(std::ranges::lower_bound(numbers_, number) - numbers_.begin());
}

}  // namespace couplet::mesh
