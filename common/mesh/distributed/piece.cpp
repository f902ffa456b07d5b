// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/distributed/piece.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "common/base/error.hpp"
#include "common/mesh/distributed/periodic_faces.hpp"
#include "common/mesh/half_faces.hpp"
#include "common/mesh/on_root.hpp"

namespace couplet::mesh {
namespace {

class Piece {
 public:
  Piece(const PieceSource& source, const LocalCells& local)
      : source_(source), local_(local), rank_(parallel::comm_rank(source.comm)) {}

  WholeMesh make() {
    fill_cells();
    on_all(source_.comm, [&] { find_interior(); });
    find_joined();
    fill_interior();
    fill_boundary();
    return std::move(piece_);
  }

 private:
  void fill_cells() {
    const CellList& cells = local_.cells;
    RawMesh& raw = piece_.raw;
    raw.dim = source_.block.dim;
    raw.zones = source_.block.zones, raw.patches = source_.block.patches;
    raw.materials = source_.block.materials;
    if (source_.graph.first_bonded >= 0) raw.patches.push_back("(between materials)");
    raw.cell_type = cells.type;
    raw.cell_zone = cells.zone;
    raw.cell_points.offset = cells.point_offset;
    PointNumbers numbers(cells.points);
    raw.cell_points.index.reserve(cells.points.size());
    for (const GlobalIndex p : cells.points) raw.cell_points.index.push_back(numbers.place(p));
    raw.points = fetch(source_.comm, source_.block.point_shares, std::span<const Vec3>(source_.block.points),
                       numbers.numbers());
    piece_.cell_number = cells.id;
    piece_.point_number = numbers.numbers();
    piece_.part = local_.owner;
    piece_.cell_material = materials_of_cells(raw);
  }

  bool is_own(Index cell) const { return local_.owner[cell] == rank_; }
  const FaceRecord* record_of(Index cell, int face) const {
    for (const FaceRecord& r : local_.cells.records_of(cell))
      if (r.face == face) return &r;
    return nullptr;
  }
  std::string place_of(const HalfFaces& halves, const HalfFace& half) const {
    Vec3 sum = Vec3::Zero();
    const std::vector<Index> points = halves.points(half);
    for (const Index p : points) sum += piece_.raw.points[p] / double(points.size());
    return place(sum, piece_.raw.dim);
  }

  struct Inner {
    Index owner, neighbour;
    std::int8_t face;  // of the owner's shape
    Index joined = 0;  // 0: no periodic face, else what its record says for a patch
  };

  void find_interior() {
    HalfFaces halves(piece_.raw, false);
    inner_.reserve(halves.size() / 2);
    halves.for_each_face([&](std::span<const HalfFace> cells, std::span<const HalfFace>) {
      const HalfFace& first = cells[0];
      const FaceRecord* record = record_of(first.cell, first.face);
      if (cells.size() > 2) throw Error(face_of_many_cells(cells.size(), place_of(halves, first)));
      if (cells.size() == 1) {
        if (is_own(first.cell) && record == nullptr) throw Error(lost(halves, first));
        return;
      }
      if (record == nullptr) record = record_of(cells[1].cell, cells[1].face);
      if (record != nullptr) {
        if (record->patch >= Index(source_.block.patches.size())) return;  // bonded
        throw Error(face_of_many_cells(2, place_of(halves, first)));
      }
      if (is_own(first.cell) || is_own(cells[1].cell))
        inner_.push_back({first.cell, cells[1].cell, static_cast<std::int8_t>(first.face)});
    });
  }

  /// Periodic faces of own cells, seen from the cell with the smaller number.
  void find_joined() {
    const CellList& cells = local_.cells;
    for (Index c = 0; c < cells.size(); ++c)
      for (const FaceRecord& r : cells.records_of(c)) {
        if (!is_joined(r.patch) || cells.id[c] > r.number) continue;
        if (cells.id[c] == r.number && side_of(r.patch) == 1) continue;
        const auto other = std::ranges::lower_bound(cells.id, r.number);
        if (other == cells.id.end() || *other != r.number) continue;
        const auto beyond = static_cast<Index>(other - cells.id.begin());
        if (is_own(c) || is_own(beyond)) inner_.push_back({c, beyond, r.face, r.patch});
      }
  }

  /// From the neighbour to the owner's side.
  Vec3 shift_of(const Inner& f) const {
    if (f.joined == 0) return Vec3::Zero();
    const Vec3& translation = source_.graph.translation[pair_of(f.joined)];
    return side_of(f.joined) == 0 ? Vec3(-translation) : translation;
  }

  std::string lost(const HalfFaces& halves, const HalfFace& half) const {
    return fmt::format("The face at {} has lost its other side while the mesh was shared out.",
                       place_of(halves, half));
  }

  void push_face(Index cell, int face, int turn) {
    const CellShape& shape = shape_of(piece_.raw.cell_type[cell]);
    const int n = shape.face_size(face);
    std::array<Index, 4> points{};
    for (int i = 0; i < n; ++i) points[i] = piece_.raw.cell_points[cell][shape.faces[face][(i + turn) % n]];
    piece_.faces.points.push_row({points.data(), std::size_t(n)});
    piece_.faces.owner.push_back(cell);
  }

  void fill_interior() {
    std::ranges::sort(inner_, [](const Inner& a, const Inner& b) {
      return std::tuple(a.owner, a.neighbour, a.joined != 0, a.face) <
             std::tuple(b.owner, b.neighbour, b.joined != 0, b.face);
    });
    piece_.faces.n_interior = static_cast<Index>(inner_.size());
    std::size_t n_points = 0;
    for (const Inner& f : inner_)
      n_points += std::size_t(shape_of(piece_.raw.cell_type[f.owner]).face_size(f.face));
    const std::size_t n_faces = inner_.size() + local_.cells.records.size();
    piece_.faces.points.index.reserve(n_points + 4 * local_.cells.records.size());
    piece_.faces.points.offset.reserve(n_faces + 1);
    piece_.faces.owner.reserve(n_faces);
    piece_.faces.neighbour.reserve(inner_.size());
    for (const Inner& f : inner_) {
      push_face(f.owner, f.face, 0);
      piece_.faces.neighbour.push_back(f.neighbour);
      if (!source_.graph.translation.empty()) piece_.faces.shift.push_back(shift_of(f));
    }
    inner_ = {};
  }

  void fill_boundary() {
    struct Outer {
      GlobalIndex number;
      Index cell;
      const FaceRecord* record;
    };
    std::vector<Outer> outer;
    for (Index c = 0; c < local_.cells.size(); ++c)
      for (const FaceRecord& r : local_.cells.records_of(c))
        if (!is_joined(r.patch)) outer.push_back({r.number, c, &r});
    std::ranges::sort(outer, {}, &Outer::number);
    for (const Outer& f : outer) {
      push_face(f.cell, f.record->face, f.record->turn);
      piece_.faces.patch.push_back(f.record->patch);
      piece_.faces.boundary_number.push_back(f.number);
    }
    piece_.faces.first_bonded = source_.graph.first_bonded;
  }

  const PieceSource& source_;
  const LocalCells& local_;
  int rank_;
  std::vector<Inner> inner_;
  WholeMesh piece_;
};

}  // namespace

WholeMesh make_piece(const PieceSource& source, const LocalCells& local) {
  return Piece(source, local).make();
}

}  // namespace couplet::mesh
