// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include "common/mesh/cell_shapes.hpp"
#include "common/mesh/load.hpp"

namespace couplet::mesh {

/// One side of a face: seen from a cell, or from a boundary element (then `cell` is -1 - element).
struct HalfFace {
  std::array<Index, 3>
      key;  // the points above the smallest one, ascending; the largest Index where there is no such
  Index cell;
  int face;
  bool is_element() const { return cell < 0; }
  Index element() const { return -1 - cell; }
};

/// Half faces in buckets by their smallest point: matching partners share a bucket, which is small, so that
/// the sort is linear in the number of faces.
class HalfFaces {
 public:
  HalfFaces(const RawMesh& raw, bool with_elements) : raw_(raw) {
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
      if (!with_elements) return;
      for (Index e = 0; e < raw.boundary_points.size(); ++e) {
        const auto element = raw.boundary_points[e];
        std::copy(element.begin(), element.end(), points.begin());
        use(points, static_cast<int>(element.size()), -1 - e, 0);
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

  /// use(cells, elements): the half faces of one face, cells by ascending number.
  template <class Use>
  void for_each_face(Use&& use) {
    for (std::size_t p = 0; p + 1 < first_.size(); ++p) {
      const auto begin = halves_.begin() + first_[p], end = halves_.begin() + first_[p + 1];
      std::sort(begin, end, [](const HalfFace& a, const HalfFace& b) {
        if (a.key != b.key) return a.key < b.key;
        if (a.is_element() != b.is_element()) return b.is_element();
        return a.is_element() ? a.element() < b.element() : a.cell < b.cell;
      });
      for (auto run = begin; run != end;) {
        auto last = run;
        while (last != end && last->key == run->key) ++last;
        auto middle = run;
        while (middle != last && !middle->is_element()) ++middle;
        use(std::span<const HalfFace>(run, middle), std::span<const HalfFace>(middle, last));
        run = last;
      }
    }
  }

  std::vector<Index> points(const HalfFace& h) const {
    const CellShape& shape = shape_of(raw_.cell_type[h.cell]);
    std::vector<Index> result(shape.face_size(h.face));
    for (std::size_t i = 0; i < result.size(); ++i)
      result[i] = raw_.cell_points[h.cell][shape.faces[h.face][i]];
    return result;
  }

 private:
  const RawMesh& raw_;
  std::vector<Index> first_;
  std::vector<HalfFace> halves_;
};

}  // namespace couplet::mesh
