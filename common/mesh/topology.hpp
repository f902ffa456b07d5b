// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "common/mesh/load.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::mesh {

/// Faces of a cell type as positions in the cell's point list, oriented right-handed about the outward
/// normal. Point order is that of VTK and gmsh. For a prism, the normal of points 0 1 2 points to points 3 4
/// 5. In 2-D, a face is an edge (a, b) whose outward normal is (dy, -dx) of b - a, for counterclockwise
/// cells.
struct CellShape {
  int dim, n_points, n_faces;
  std::array<std::array<std::int8_t, 4>, 6> faces;  ///< -1 means no such point
  std::array<std::int8_t, 8> mirrored;              ///< point order that inverts an inverted cell
  int face_size(int face) const {
    if (dim == 2) return 2;
    return faces[face][3] < 0 ? 3 : 4;
  }
};

const CellShape& shape_of(CellType type);
const char* name_of(CellType type);

/// Points of face `face` of a cell in the order of its shape, starting at position `turn`.
struct FacePoints {
  std::array<Index, 4> points{};
  std::size_t n;
  FacePoints(const RawMesh& raw, Index cell, int face, int turn);
  operator std::span<const Index>() const { return {points.data(), n}; }
};

/// Face as seen from one of its cells.
struct HalfFace {
  /// Points above the smallest one, ascending, padded with the largest Index.
  std::array<Index, 3> key;
  Index cell;
  int face;  ///< position in the cell's shape
};

/// Half faces in buckets by their smallest point. Matching partners share a small bucket, so sorting is
/// linear in the number of faces.
class HalfFaces {
 public:
  explicit HalfFaces(const RawMesh& raw) : raw_(raw) {
    const auto visit = [&](auto&& use) {
      std::array<Index, 4> points;
      for (Index c = 0; c < raw.cell_points.size(); ++c) {
        const CellShape& shape = shape_of(raw.cell_type[c]);
        for (int f = 0; f < shape.n_faces; ++f) {
          const int n = shape.face_size(f);
          for (int i = 0; i < n; ++i) points[i] = raw.cell_points[c][shape.faces[f][i]];
          use(points, n, c, f);
        }
      }
    };
    first_.assign(raw.points.size() + 1, 0);
    visit([&](const std::array<Index, 4>& p, int n, Index, int) {
      ++first_[*std::min_element(p.begin(), p.begin() + n) + 1];
    });
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    halves_.resize(first_.back());
    constexpr Index none = std::numeric_limits<Index>::max();
    std::vector<Index> next(first_.begin(), first_.end() - 1);
    visit([&](std::array<Index, 4> p, int n, Index cell, int face) {
      std::fill(p.begin() + n, p.end(), none);
      std::sort(p.begin(), p.end());
      halves_[next[p[0]]++] = {{p[1], p[2], p[3]}, cell, face};
    });
  }

  std::size_t size() const { return halves_.size(); }

  /// Calls use(halves) for each face with its half faces, sorted by cell number.
  template <class Use>
  void for_each_face(Use&& use) {
    for (std::size_t p = 0; p + 1 < first_.size(); ++p) {
      const auto begin = halves_.begin() + first_[p], end = halves_.begin() + first_[p + 1];
      std::sort(begin, end, [](const HalfFace& a, const HalfFace& b) {
        return a.key != b.key ? a.key < b.key : a.cell < b.cell;
      });
      for (auto run = begin; run != end;) {
        auto last = run;
        while (last != end && last->key == run->key) ++last;
        use(std::span<const HalfFace>(run, last));
        run = last;
      }
    }
  }

  FacePoints points(const HalfFace& h) const { return {raw_, h.cell, h.face, 0}; }

 private:
  const RawMesh& raw_;
  std::vector<Index> first_;
  std::vector<HalfFace> halves_;
};

/// Faces that belong to only one cell, as boundary elements. Generators assign their patches.
Csr outer_faces(const RawMesh& raw);

/// Reorders inverted cells (clockwise in 2-D). Throws Error for a cell without volume. `first` is the number
/// of the first cell, for messages.
void orient_cells(RawMesh& raw, GlobalIndex first = 0);

/// Throws Error for a point outside the plane z = 0 of a 2-D mesh with a bounding box of this diagonal.
void check_plane(std::span<const Vec3> points, double diagonal);

/// Formats "(1, 2.5)" in 2-D, "(1, 2.5, 3)" in 3-D.
std::string place(const Vec3& x, int dim);

/// Rows of [first, size) that contain each of `n_entries` entries, numbered from 0 at `first`, ascending.
inline Csr transpose(const Csr& rows, Index first, Index n_entries) {
  Csr result;
  result.offset.assign(n_entries + 1, 0);
  for (Index i = first; i < rows.size(); ++i)
    for (const Index e : rows[i]) ++result.offset[e + 1];
  for (Index e = 0; e < n_entries; ++e) result.offset[e + 1] += result.offset[e];
  result.index.resize(result.offset.back());
  std::vector<Index> next(result.offset.begin(), result.offset.end() - 1);
  for (Index i = first; i < rows.size(); ++i)
    for (const Index e : rows[i]) result.index[next[e]++] = i - first;
  return result;
}

}  // namespace couplet::mesh
