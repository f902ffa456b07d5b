// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/topology.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "common/base/error.hpp"
#include "common/mesh/cell_shapes.hpp"

namespace couplet::mesh {
namespace {

constexpr Index none = std::numeric_limits<Index>::max();

/// One side of a face: seen from a cell, or from a boundary element (then `cell` is -1 - element).
struct HalfFace {
  std::array<Index, 3> key;  // the points above the smallest one, ascending, `none` where there is no such
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
    std::vector<Index> next(first_.begin(), first_.end() - 1);
    visit([&](std::array<Index, 4> p, int n, Index cell, int face) {
      std::fill(p.begin() + n, p.end(), none);
      std::sort(p.begin(), p.end());
      halves_[next[p[0]]++] = {{p[1], p[2], p[3]}, cell, face};
    });
  }

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

Vec3 mean_point(const RawMesh& raw, std::span<const Index> points) {
  Vec3 sum = Vec3::Zero();
  for (const Index p : points) sum += raw.points[p];
  return sum / double(points.size());
}

struct Interior {
  HalfFace owner;
  Index neighbour;
};
struct Boundary {
  HalfFace owner;
  Index element;
};

void check_elements(const RawMesh& raw, std::span<const HalfFace> cells, std::span<const HalfFace> elements) {
  if (elements.empty()) return;
  const auto where = [&] {
    return place(mean_point(raw, raw.boundary_points[elements[0].element()]), raw.dim);
  };
  const std::string& name = raw.patches[raw.boundary_patch[elements[0].element()]];
  if (cells.empty())
    throw Error(
        "Patch '{}' has a face at {} that belongs to no cell. Mesh the boundary and the interior together "
        "so that their points coincide.",
        name, where());
  if (cells.size() == 2)
    throw Error(
        "Patch '{}' has a face at {} that lies between two cells. A patch must lie on the boundary; remove "
        "the inner surface from the physical group (or the mesh contains every cell twice).",
        name, where());
  for (const HalfFace& e : elements)
    if (raw.boundary_patch[e.element()] != raw.boundary_patch[elements[0].element()])
      throw Error(
          "The boundary face at {} is in two patches, '{}' and '{}'. Every boundary face must be in exactly "
          "one patch.",
          where(), name, raw.patches[raw.boundary_patch[e.element()]]);
}

void report_unassigned(const RawMesh& raw, const HalfFaces& halves, const std::vector<HalfFace>& unassigned) {
  if (unassigned.empty()) return;
  std::string places;
  for (std::size_t i = 0; i < std::min<std::size_t>(3, unassigned.size()); ++i)
    places +=
        fmt::format("{}{}", i ? ", " : "", place(mean_point(raw, halves.points(unassigned[i])), raw.dim));
  throw Error(
      "{} boundary face{} in no patch, with centre{} {}{}. Every boundary face must be in exactly one "
      "patch: add {} to a physical group (for a location inside the domain: the mesh has two coincident "
      "points there that should be one).",
      unassigned.size(), unassigned.size() == 1 ? " is" : "s are", unassigned.size() == 1 ? "" : "s", places,
      unassigned.size() > 3 ? ", ..." : "",
      raw.dim == 2 ? "the curve (Physical Curve)" : "the surface (Physical Surface)");
}

}  // namespace

std::string place(const Vec3& x, int dim) {
  // + 0.0 turns -0 into 0
  return dim == 2 ? fmt::format("({:.6g}, {:.6g})", x[0] + 0.0, x[1] + 0.0)
                  : fmt::format("({:.6g}, {:.6g}, {:.6g})", x[0] + 0.0, x[1] + 0.0, x[2] + 0.0);
}

Faces build_faces(const RawMesh& raw) {
  HalfFaces halves(raw, true);
  std::vector<Interior> interior;
  std::vector<Boundary> boundary;
  std::vector<HalfFace> unassigned;
  halves.for_each_face([&](std::span<const HalfFace> cells, std::span<const HalfFace> elements) {
    if (cells.size() > 2)
      throw Error(
          "{} cells share the face at {}, but a face has at most two cells; the mesh has duplicate or "
          "overlapping cells.",
          cells.size(), place(mean_point(raw, halves.points(cells[0])), raw.dim));
    check_elements(raw, cells, elements);
    if (cells.size() == 2)
      interior.push_back({cells[0], cells[1].cell});
    else if (elements.empty())
      unassigned.push_back(cells[0]);
    else
      boundary.push_back({cells[0], elements[0].element()});
  });
  report_unassigned(raw, halves, unassigned);

  std::sort(interior.begin(), interior.end(), [](const Interior& a, const Interior& b) {
    return std::pair(a.owner.cell, a.neighbour) < std::pair(b.owner.cell, b.neighbour);
  });
  std::sort(boundary.begin(), boundary.end(),
            [](const Boundary& a, const Boundary& b) { return a.element < b.element; });
  Faces faces;
  faces.n_interior = static_cast<Index>(interior.size());
  for (const Interior& f : interior) {
    faces.points.push_row(halves.points(f.owner));
    faces.owner.push_back(f.owner.cell);
    faces.neighbour.push_back(f.neighbour);
  }
  for (const Boundary& f : boundary) {
    faces.points.push_row(halves.points(f.owner));
    faces.owner.push_back(f.owner.cell);
    faces.patch.push_back(raw.boundary_patch[f.element]);
  }
  return faces;
}

Csr outer_faces(const RawMesh& raw) {
  HalfFaces halves(raw, false);
  std::vector<HalfFace> outer;
  halves.for_each_face([&](std::span<const HalfFace> cells, std::span<const HalfFace>) {
    if (cells.size() == 1) outer.push_back(cells[0]);
  });
  std::sort(outer.begin(), outer.end(), [](const HalfFace& a, const HalfFace& b) {
    return std::pair(a.cell, a.face) < std::pair(b.cell, b.face);
  });
  Csr result;
  for (const HalfFace& h : outer) result.push_row(halves.points(h));
  return result;
}

}  // namespace couplet::mesh
