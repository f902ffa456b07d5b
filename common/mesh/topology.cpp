// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/topology.hpp"

#include <algorithm>

#include "common/base/error.hpp"
#include "common/mesh/half_faces.hpp"

namespace couplet::mesh {
namespace {

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
  if (cells.empty()) throw Error(face_without_cell(name, where()));
  if (cells.size() == 2) throw Error(face_inside(name, where()));
  for (const HalfFace& e : elements)
    if (raw.boundary_patch[e.element()] != raw.boundary_patch[elements[0].element()])
      throw Error(face_in_two_patches(name, raw.patches[raw.boundary_patch[e.element()]], where()));
}

void report_unassigned(const RawMesh& raw, const HalfFaces& halves, const std::vector<HalfFace>& unassigned) {
  if (unassigned.empty()) return;
  std::vector<std::string> places;
  for (const HalfFace& face : unassigned) {
    if (places.size() == 3) break;
    places.push_back(place(mean_point(raw, halves.points(face)), raw.dim));
  }
  throw Error(faces_in_no_patch(GlobalIndex(unassigned.size()), places, raw.dim));
}

}  // namespace

std::string place(const Vec3& x, int dim) {
  // + 0.0 turns -0 into 0
  return dim == 2 ? fmt::format("({:.6g}, {:.6g})", x[0] + 0.0, x[1] + 0.0)
                  : fmt::format("({:.6g}, {:.6g}, {:.6g})", x[0] + 0.0, x[1] + 0.0, x[2] + 0.0);
}

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

std::string face_of_many_cells(std::size_t cells, const std::string& where) {
  return fmt::format(
      "{} cells share the face at {}, but a face has at most two cells; the mesh has duplicate or "
      "overlapping cells.",
      cells, where);
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

Faces build_faces(const RawMesh& raw) {
  HalfFaces halves(raw, true);
  std::vector<Interior> interior;
  std::vector<Boundary> boundary;
  std::vector<HalfFace> unassigned;
  halves.for_each_face([&](std::span<const HalfFace> cells, std::span<const HalfFace> elements) {
    if (cells.size() > 2)
      throw Error(face_of_many_cells(cells.size(), place(mean_point(raw, halves.points(cells[0])), raw.dim)));
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
