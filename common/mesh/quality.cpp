// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/quality.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/base/error.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::mesh {
namespace {

/// Mean face center, which stays within the bounding box of any inverted cell. The centroid of a cell without
/// volume does not.
Vec3 mean_face_centre(const Mesh& mesh, const Geometry& geometry, Index cell) {
  Vec3 sum = Vec3::Zero();
  int n = 0;
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    if (mesh.owner[f] != cell && (f >= mesh.n_interior || mesh.neighbour[f] != cell)) continue;
    sum += geometry.face_centre[f];
    ++n;
  }
  return sum / n;
}

/// Largest value over all ranks with its location.
struct Extreme {
  double value = 0;
  Vec3 at = Vec3::Zero();
  void add(double other, const Vec3& place) {
    if (other <= value) return;
    value = other;
    at = place;
  }
  void reduce(MPI_Comm comm) {
    struct {
      double value;
      int rank;
    } best{value, parallel::comm_rank(comm)};
    MPI_Allreduce(MPI_IN_PLACE, &best, 1, MPI_DOUBLE_INT, MPI_MAXLOC, comm);
    MPI_Bcast(at.data(), 3, MPI_DOUBLE, best.rank, comm);
    value = best.value;
  }
};

double longest_edge(const Geometry& geometry, std::span<const Index> face) {
  double longest = 0;
  for (std::size_t i = 0; i < face.size(); ++i)
    longest =
        std::max(longest, (geometry.points[face[i]] - geometry.points[face[(i + 1) % face.size()]]).norm());
  return longest;
}

Extreme largest_aspect_ratio(const Mesh& mesh, const Geometry& geometry) {
  std::vector<double> length(mesh.cells.n_local(), 0.0), area(mesh.cells.n_local(), 0.0);
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    const double edge = longest_edge(geometry, mesh.face_points[f]), size = geometry.face_area[f].norm();
    for (const Index c : {mesh.owner[f], f < mesh.n_interior ? mesh.neighbour[f] : mesh.owner[f]}) {
      length[c] = std::max(length[c], edge);
      area[c] = std::max(area[c], size);
    }
  }
  Extreme extreme;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c)
    if (geometry.volume[c] > 0)
      extreme.add(length[c] * area[c] / geometry.volume[c], geometry.cell_centre[c]);
  return extreme;
}

}  // namespace

MeshQuality measure_quality(const Mesh& mesh, const Geometry& geometry) {
  double largest = -std::numeric_limits<double>::max();
  Extreme smallest{-std::numeric_limits<double>::max()}, angle, skewness;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    smallest.add(-geometry.volume[c], geometry.cell_centre[c]);
    largest = std::max(largest, geometry.volume[c]);
  }
  for (Index f = 0; f < mesh.n_interior; ++f) {
    const Vec3& from = geometry.cell_centre[mesh.owner[f]];
    const Vec3 line = geometry.cell_centre[mesh.neighbour[f]] + mesh.shift(f) - from;
    const Vec3& area = geometry.face_area[f];
    const double along = line.dot(area), length = line.norm(), size = area.norm();
    if (length == 0 || size == 0) continue;
    const double cosine = std::clamp(along / (length * size), -1.0, 1.0);
    angle.add(std::acos(cosine) * 180 / std::numbers::pi, geometry.face_centre[f]);
    if (along <= 0) continue;
    const Vec3 to_face = geometry.face_centre[f] - from;
    const Vec3 pierced = to_face.dot(area) / along * line;
    skewness.add((to_face - pierced).norm() / length, geometry.face_centre[f]);
  }
  Extreme aspect = largest_aspect_ratio(mesh, geometry);
  for (Extreme* e : {&smallest, &angle, &skewness, &aspect}) e->reduce(mesh.comm);
  return {-smallest.value, parallel::max(mesh.comm, largest),
          angle.value,     skewness.value,
          aspect.value,    smallest.at,
          angle.at,        skewness.at,
          aspect.at};
}

std::optional<CellTrouble> find_inverted(const Mesh& mesh, const Geometry& geometry) {
  CellTrouble worst{std::numeric_limits<GlobalIndex>::max(), Vec3::Zero(),
                    std::numeric_limits<double>::max()};
  const auto worse = [](const CellTrouble& a, const CellTrouble& b) {
    // A volume that is not a number is worst.
    const auto key = [](const CellTrouble& t) {
      return std::pair(std::isnan(t.volume) ? -std::numeric_limits<double>::infinity() : t.volume, t.cell_id);
    };
    return key(a) < key(b);
  };
  Index cell = -1;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    const CellTrouble here{mesh.cell_id[c], Vec3::Zero(), geometry.volume[c]};
    if (here.volume > 0 || !worse(here, worst)) continue;
    worst = here;
    cell = c;
  }
  if (cell >= 0) worst.centre = mean_face_centre(mesh, geometry, cell);
  if (!parallel::any(mesh.comm, !(worst.volume > 0))) return std::nullopt;
  const std::vector<CellTrouble> all = parallel::all_gather(mesh.comm, std::vector<CellTrouble>{worst});
  return *std::min_element(all.begin(), all.end(), worse);
}

namespace {

/// Cell with the lowest number over all ranks. Collective.
std::optional<CellTrouble> first_of(MPI_Comm comm, const std::vector<CellTrouble>& found) {
  const std::vector<CellTrouble> all = parallel::all_gather(comm, found);
  if (all.empty()) return std::nullopt;
  return *std::ranges::min_element(all, {}, &CellTrouble::cell_id);
}

Vec3 turn(const Vec3& a, const Vec3& b, const Vec3& c) { return (b - a).cross(c - b); }

/// Returns true if the quadrilateral intersects itself. Then two of its corners have the opposite
/// orientation, whereas a convex one has none and a concave one has one.
bool crosses_itself(const std::array<Vec3, 4>& x) {
  const Vec3 first = turn(x[0], x[1], x[2]);
  int other = 0;
  for (int i = 1; i < 4; ++i) other += turn(x[i], x[(i + 1) % 4], x[(i + 2) % 4]).dot(first) < 0;
  return other == 2;
}

}  // namespace

std::optional<CellTrouble> find_crossed(const Mesh& mesh, const Geometry& geometry) {
  const std::vector<Vec3>& points = geometry.points;
  std::vector<CellTrouble> found;
  const auto judge = [&](std::span<const Index> corner, Index cell) {
    if (corner.size() != 4 || cell >= mesh.cells.n_owned()) return;
    const std::array<Vec3, 4> x{points[corner[0]], points[corner[1]], points[corner[2]], points[corner[3]]};
    if (crosses_itself(x))
      found.push_back({mesh.cell_id[cell], 0.25 * (x[0] + x[1] + x[2] + x[3]), geometry.volume[cell]});
  };
  if (mesh.dim == 2)
    for (Index c = 0; c < mesh.cells.n_owned(); ++c) judge(mesh.cell_points[c], c);
  else
    for (Index f = 0; f < mesh.n_flux_faces(); ++f) judge(mesh.face_points[f], mesh.owner[f]);
  return first_of(mesh.comm, found);
}

std::optional<CellTrouble> find_fold(const Mesh& mesh, const Geometry& g) {
  std::vector<CellTrouble> found;
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    const Index owner = mesh.owner[f];
    if (owner >= mesh.cells.n_owned()) continue;
    const Vec3 there =
        f < mesh.n_interior ? Vec3(g.cell_centre[mesh.neighbour[f]] + mesh.shift(f)) : g.face_centre[f];
    if ((there - g.cell_centre[owner]).dot(g.face_area[f]) > 0) continue;
    found.push_back({mesh.cell_id[owner], g.face_centre[f], g.volume[owner]});
  }
  return first_of(mesh.comm, found);
}

void check_and_report(const Mesh& mesh, const Geometry& geometry) {
  const auto text = [&](const Vec3& x) {
    return mesh.dim == 2 ? fmt::format("({:.4g}, {:.4g})", x.x(), x.y())
                         : fmt::format("({:.4g}, {:.4g}, {:.4g})", x.x(), x.y(), x.z());
  };
  if (const auto trouble = find_inverted(mesh, geometry))
    throw Error(
        "The mesh has an inverted cell: cell {} at {} m has the volume {:.3g} m^3. Its faces intersect; "
        "remesh there, coarser or with another element size.",
        trouble->cell_id, text(trouble->centre), trouble->volume);
  if (const auto trouble = find_crossed(mesh, geometry))
    throw Error(
        "The mesh has a self-intersecting cell: cell {} at {} m. Its points are in the wrong order; remesh "
        "there.",
        trouble->cell_id, text(trouble->centre));
  const MeshQuality q = measure_quality(mesh, geometry);
  const Vec3 size = extent_of(mesh, geometry).size();
  if (parallel::comm_rank(mesh.comm) != 0) return;
  // Locations are omitted where all cells are orthogonal to round-off.
  const auto number_at = [&](double value, double least, const char* unit, const Vec3& at) {
    return value > least ? fmt::format("{:.3g}{} at {}", value, unit, text(at)) : fmt::format("0{}", unit);
  };
  log::info(
      "mesh: {} cells in a box of {:.4g} x {:.4g}{} m; smallest volume {:.3g} m^3 at {}, largest non-orthogonality {}, skewness {}, aspect ratio {:.3g} at {}",
      mesh.cells.n_global(), size.x(), size.y(), mesh.dim == 2 ? "" : fmt::format(" x {:.4g}", size.z()),
      q.min_volume, text(q.volume_at), number_at(q.max_non_orthogonality, 1e-3, " degrees", q.angle_at),
      number_at(q.max_skewness, 1e-9, "", q.skewness_at), q.max_aspect_ratio, text(q.aspect_at));
}

}  // namespace couplet::mesh
