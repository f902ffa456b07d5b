// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/boundary/checks.hpp"

#include <fmt/format.h>
#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "common/base/constants.hpp"
#include "common/base/disjoint_sets.hpp"
#include "common/base/error.hpp"
#include "common/log/log.hpp"
#include "common/mesh/quality.hpp"
#include "common/mesh/touching_faces.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::solid {

namespace {

std::string text_of(const Vec3& x, int dim) {
  return dim == 2 ? fmt::format("({:.4g}, {:.4g})", x[0], x[1])
                  : fmt::format("({:.4g}, {:.4g}, {:.4g})", x[0], x[1], x[2]);
}

struct Found {
  GlobalIndex count;
  Vec3 first;  ///< place of the first one
};

/// Finds one of the points listed on the ranks. Collective.
std::optional<Found> find_any(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                              const std::vector<Index>& points) {
  std::vector<double> first;
  if (!points.empty()) {
    const Vec3& x = geometry.points[points.front()];
    first.assign(x.data(), x.data() + 3);
  }
  const std::vector<double> all = parallel::all_gather(mesh.comm, first);
  if (all.empty()) return std::nullopt;
  return Found{parallel::sum(mesh.comm, GlobalIndex(points.size())), Vec3(all[0], all[1], all[2])};
}

}  // namespace

void check_mesh(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                const fv::VertexInterpolation& vertices) {
  if (const auto trouble = mesh::find_inverted(mesh, geometry))
    throw Error(
        "The mesh has an inverted cell: cell {} at {} has the volume {:.3g} m^3. Its faces intersect; "
        "remesh there, coarser or with another element size.",
        trouble->cell_id, text_of(trouble->centre, mesh.dim), trouble->volume);
  // The operator is not elliptic if a cell is not behind its face.
  if (const auto fold = mesh::find_fold(mesh, geometry))
    throw Error(
        "The mesh is folded at {}: cell {} (counted from 0 in the file) lies on the wrong side of its face there. A cell is "
        "inverted or bent over; remesh there.",
        text_of(fold->centre, mesh.dim), fold->cell_id);
  if (const auto bent = find_any(mesh, geometry, vertices.bent_points()))
    throw Error(
        "boundaries: a patch of 'type: symmetry' is not flat at {}. A symmetry plane must be a plane; 'type: "
        "frictionless' also slides along curved surfaces.",
        text_of(bent->first, mesh.dim));
  if (const auto inexact = find_any(mesh, geometry, vertices.inexact_points());
      inexact && parallel::comm_rank(mesh.comm) == 0)
    log::warn(
        "at {} vertices, the first at {}, the adjacent cells and faces do not span all directions: values "
        "there are plain means of the neighbors, exact for constant fields only",
        inexact->count, text_of(inexact->first, mesh.dim));
}

void check_touching(const mesh::LoadedMesh& body, const SolidParameters& parameters) {
  if (parameters.touching_faces == SolidParameters::TouchingFaces::apart) return;
  const auto is_free = [&](const std::string& patch) {
    const auto at = parameters.boundaries.find(patch);
    return at == parameters.boundaries.end() ||
           (at->second.type == SolidCondition::Type::free && at->second.parts.empty());
  };
  const auto is_adiabatic = [&](const std::string& patch) {
    if (!parameters.heat) return true;
    const auto heat = parameters.heat->boundaries.find(patch);
    return heat == parameters.heat->boundaries.end() || heat->second.type == HeatBoundary::Type::adiabatic;
  };
  const auto is_apart = [&](const mesh::TouchingFaces& found, const auto& is_open) {
    return found.patch != found.other && !is_open(found.patch) && !is_open(found.other);
  };
  const bool ties = parameters.touching_faces == SolidParameters::TouchingFaces::tie;
  for (const mesh::Patch& patch : body.mesh.patches)
    if (ties && parallel::sum(body.mesh.comm, double(patch.count)) == 0 &&
        !(is_free(patch.name) && is_adiabatic(patch.name)))
      throw Error(
          "boundaries.{}: all faces of this patch are tied to other faces ('touching-faces: tie'), so that its condition "
          "acts nowhere. Make it 'free' and without heat, or set 'touching-faces: apart'.",
          patch.name);
  for (const mesh::TouchingFaces& found : mesh::find_touching_faces(body.mesh, body.geometry)) {
    // Parts are separate only if each of the fields that are solved has its condition on both sides.
    const bool forces = parameters.analysis == SolidParameters::Analysis::thermal || is_apart(found, is_free),
               heat = !parameters.heat || is_apart(found, is_adiabatic);
    if (forces && heat) continue;
    throw Error(
        "mesh: {} face{} of patch '{}', the first at {}, touch{} faces of {} without sharing their points, so that {} passes "
        "there. {} If the parts are meant to be separate, such as the faces of a crack, set 'touching-faces: apart'.",
        found.count, found.count == 1 ? "" : "s", found.patch, text_of(found.where, body.mesh.dim),
        found.count == 1 ? "es" : "", found.patch == found.other ? "the same patch" : "'" + found.other + "'",
        heat     ? "no force"
        : forces ? "no heat"
                 : "neither force nor heat",
        found.alike && ties ? "Only faces in a group of the mesh are tied: put both sides into groups."
        : found.alike
            ? "Merge the double points of the mesh, or set 'touching-faces: tie'."
            : "The faces of the two sides have different corners, so 'touching-faces: tie' cannot join them: mesh both sides "
              "identically, or as one body.");
  }
}

void check_axis(const mesh::Mesh& mesh, const elastic::ElasticOperator& elastic) {
  const mesh::Geometry& geometry = elastic.geometry();
  double size = 0;
  for (const Vec3& x : geometry.points) size = std::max(size, x.norm());
  const double none = 1e-9 * parallel::max(mesh.comm, size);
  std::vector<Index> behind, open, oblique;
  for (Index v = 0; v < mesh.points.n_local(); ++v)
    if (geometry.points[v][0] < -none) behind.push_back(v);
  for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f) {
    const bool on_axis = std::abs(geometry.face_centre[f][0]) <= none;
    if (on_axis && !elastic.mirrored(f)) open.push_back(mesh.face_points[f][0]);
    const Vec3 n = geometry.face_area[f].normalized();
    if (elastic.mirrored(f) && !on_axis && std::abs(n[0]) > 1e-6) oblique.push_back(mesh.face_points[f][0]);
  }
  if (const auto at = find_any(mesh, geometry, behind))
    throw Error("plane: axisymmetric: x is the radius and must not be negative; the mesh has a point at {}.",
                text_of(at->first, mesh.dim));
  if (const auto at = find_any(mesh, geometry, open))
    throw Error(
        "boundaries: plane: axisymmetric: the patch on the axis x = 0 needs 'type: symmetry' (at {}).",
        text_of(at->first, mesh.dim));
  if (const auto at = find_any(mesh, geometry, oblique))
    throw Error(
        "boundaries: plane: axisymmetric: a 'symmetry' must be the axis x = 0 or a plane y = constant; the "
        "patch at {} is neither. Use 'frictionless' to slide along a surface.",
        text_of(at->first, mesh.dim));
}

namespace {

// A motion is free if its resistance relative to the largest one is below this (squared: holding a spot of a
// millionth of the body suffices, as the end of a foil is).
constexpr double resisted = 1e-12;

using Motion = Eigen::Matrix<double, 6, 1>;  // translation of the center, rotation times the size of the body
using Resistance = Eigen::Matrix<double, 6, 6>;

/// Component-wise sum over the ranks.
void add_over_ranks(MPI_Comm comm, std::vector<double>& values) {
  const std::vector<double> all = parallel::all_gather(comm, values);
  const std::size_t n = values.size();
  for (std::size_t i = 0; i < n; ++i) {
    values[i] = 0;
    for (std::size_t at = i; at < all.size(); at += n) values[i] += all[at];
  }
}

/// The body of each local cell, numbered by the smallest cell_id in it.
std::vector<Index> bodies_of_cells(const mesh::Mesh& mesh, Index& n_bodies) {
  const Index n = mesh.cells.n_local();
  base::DisjointSets sets(n);
  for (Index f = 0; f < mesh.n_interior; ++f) sets.join(mesh.owner[f], mesh.neighbour[f]);
  for (std::size_t b = 0; b < mesh.twin.size(); ++b)
    if (mesh.twin[b] >= 0)
      sets.join(mesh.owner[mesh.n_interior + static_cast<Index>(b)],
                mesh.owner[mesh.n_interior + mesh.twin[b]]);
  std::vector<GlobalIndex> label(mesh.cell_id.begin(), mesh.cell_id.end());
  for (bool changed = true; changed;) {
    std::vector<GlobalIndex> lowest(n, std::numeric_limits<GlobalIndex>::max());
    for (Index c = 0; c < n; ++c) {
      GlobalIndex& low = lowest[sets.find(c)];
      low = std::min(low, label[c]);
    }
    const std::vector<GlobalIndex> before = label;
    for (Index c = 0; c < n; ++c) label[c] = lowest[sets.find(c)];
    mesh.cells.update_ghosts(std::span<GlobalIndex>(label));
    changed = parallel::any(mesh.comm, label != before);
  }
  const auto owned_end = label.begin() + mesh.cells.n_owned();
  std::vector<GlobalIndex> names(label.begin(), owned_end);
  for (int pass = 0; pass < 2; ++pass) {
    std::ranges::sort(names);
    names.erase(std::unique(names.begin(), names.end()), names.end());
    if (pass == 0) names = parallel::all_gather(mesh.comm, names);
  }
  n_bodies = static_cast<Index>(names.size());
  std::vector<Index> body(n);
  for (Index c = 0; c < n; ++c)
    body[c] = static_cast<Index>(std::lower_bound(names.begin(), names.end(), label[c]) - names.begin());
  return body;
}

struct Body {
  Vec3 centre = Vec3::Zero();
  double size = 0;
  Resistance resistance = Resistance::Zero();
};

std::vector<Body> place_bodies(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                               std::span<const Index> body_of_cell, Index n_bodies) {
  std::vector<double> sums(std::size_t(n_bodies) * 4, 0);
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    double* at = sums.data() + 4 * body_of_cell[c];
    at[0] += geometry.volume[c];
    for (int a = 0; a < 3; ++a) at[a + 1] += geometry.volume[c] * geometry.cell_centre[c][a];
  }
  add_over_ranks(mesh.comm, sums);
  std::vector<Body> bodies(n_bodies);
  for (Index b = 0; b < n_bodies; ++b)
    bodies[b].centre = Eigen::Map<const Vec3>(sums.data() + 4 * b + 1) / sums[4 * b];
  for (Index c = 0; c < mesh.cells.n_owned(); ++c)
    for (const Index v : mesh.cell_points[c]) {
      Body& body = bodies[body_of_cell[c]];
      body.size = std::max(body.size, (geometry.points[v] - body.centre).norm());
    }
  for (Body& body : bodies) body.size = parallel::max(mesh.comm, body.size);
  return bodies;
}

/// Displacement at x for the six motions (columns).
Eigen::Matrix<double, 3, 6> displacements(const Body& body, const Vec3& x) {
  const Vec3 r = (x - body.centre) / body.size;
  Eigen::Matrix<double, 3, 6> d;
  d.leftCols<3>().setIdentity();
  d.rightCols<3>() << 0, r[2], -r[1], -r[2], 0, r[0], r[1], -r[0], 0;
  return d;
}

/// n . grad u, times the size of the body, for the six motions.
Eigen::Matrix<double, 3, 6> normal_gradients(const Vec3& n) {
  Eigen::Matrix<double, 3, 6> d = Eigen::Matrix<double, 3, 6>::Zero();
  d.rightCols<3>() << 0, n[2], -n[1], -n[2], 0, n[0], n[1], -n[0], 0;
  return d;
}

void add_face(const mesh::Mesh& mesh, const elastic::ElasticOperator& elastic, Index face, Body& body) {
  const mesh::Geometry& geometry = elastic.geometry();
  const auto resist = [&](const Eigen::Matrix<double, 3, 6>& d, const Tensor3& by) {
    body.resistance += d.transpose() * by * d;
  };
  const auto at_centre = displacements(body, geometry.face_centre[face]);
  const Vec3 n = geometry.face_area[face].normalized();
  const elastic::BoundaryRow& row = elastic.at(face);
  if (row.held) resist(at_centre, row.known);
  // Any spring holds, because its stiffness only determines the displacement.
  if (const double stiffest = row.spring.norm(); stiffest > 0) resist(at_centre, row.spring / stiffest);
  if (row.level) resist(normal_gradients(n), Tensor3::Identity());
  for (const Index v : mesh.face_points[face])
    if (elastic.constraints().is_constrained(v))
      resist(displacements(body, geometry.points[v]),
             Tensor3::Identity() - elastic.constraints().free_part(v));
}

/// Reduced row echelon form with pivots in column order; rows without pivot are removed.
std::vector<Motion> reduce(std::vector<Motion> rows, const std::array<int, 6>& columns) {
  std::vector<Motion> reduced;
  for (const int column : columns) {
    const auto best =
        std::ranges::max_element(rows, {}, [column](const Motion& row) { return std::abs(row[column]); });
    if (best == rows.end() || std::abs((*best)[column]) < 1e-3) continue;
    const Motion pivot = *best / (*best)[column];
    rows.erase(best);
    for (auto* set : {&rows, &reduced})
      for (Motion& row : *set) row -= row[column] * pivot;
    reduced.push_back(pivot);
  }
  return reduced;
}

std::string direction(Vec3 d) {
  d.normalize();
  for (int a = 0; a < 3; ++a)
    if (std::abs(d[a]) > 1 - 1e-6) return base::axis_letters[a];
  const auto tidy = [](double value) { return std::abs(value) < 1e-6 ? 0.0 : value; };
  return fmt::format("({:.3g}, {:.3g}, {:.3g})", tidy(d[0]), tidy(d[1]), tidy(d[2]));
}

std::string describe(const Motion& motion, const Body& body, int dim) {
  const Vec3 t = motion.head<3>(), w = motion.tail<3>() / body.size;
  if (w.norm() * body.size < 1e-6) return "translation along " + direction(t);
  // u = t + w x (x - center) vanishes, or is parallel (a screw), on the axis through center + w x t/|w|^2.
  Vec3 x = body.centre + w.cross(t) / w.squaredNorm();
  for (int a = 0; a < 3; ++a)
    if (std::abs(x[a]) < 1e-6 * body.size) x[a] = 0;
  const bool screw = std::abs(t.dot(w)) > 1e-6 * w.norm();
  const std::string about = dim == 2 ? fmt::format("rotation about ({:.4g}, {:.4g})", x[0], x[1])
                                     : fmt::format("rotation about {} through ({:.4g}, {:.4g}, {:.4g})",
                                                   direction(w), x[0], x[1], x[2]);
  return screw ? about + " with a translation along it" : about;
}

std::vector<std::string> free_modes(const Body& body, int dim, bool axisymmetric) {
  Resistance resistance = body.resistance;
  // In a body of revolution, only the axial motion has no strain.
  if (axisymmetric)
    return resistance(1, 1) > resisted * std::max(resistance.trace(), std::numeric_limits<double>::min())
               ? std::vector<std::string>()
               : std::vector<std::string>{"translation along y, the axis"};
  // The other three motions do not exist in 2-D.
  if (dim == 2)
    for (const int i : {2, 3, 4}) {
      resistance.row(i).setZero();
      resistance.col(i).setZero();
      resistance(i, i) = std::max(1.0, body.resistance.trace());
    }
  const Eigen::SelfAdjointEigenSolver<Resistance> eigen(resistance);
  const double largest = std::max(eigen.eigenvalues()[5], std::numeric_limits<double>::min());
  std::vector<Motion> free;
  for (int i = 0; i < 6; ++i)
    if (eigen.eigenvalues()[i] <= resisted * largest) free.push_back(eigen.eigenvectors().col(i));
  std::vector<std::string> names;
  // Eliminates rotations first, so that pure translations remain; these are reported first.
  for (const Motion& motion : reduce(free, {3, 4, 5, 0, 1, 2})) names.push_back(describe(motion, body, dim));
  std::ranges::stable_partition(names, [](const std::string& n) { return n.starts_with("translation"); });
  return names;
}

}  // namespace

std::vector<FreeMotion> free_motions(const mesh::Mesh& mesh, const elastic::ElasticOperator& elastic) {
  const mesh::Geometry& geometry = elastic.geometry();
  Index n_bodies = 0;
  const std::vector<Index> body_of_cell = bodies_of_cells(mesh, n_bodies);
  std::vector<Body> bodies = place_bodies(mesh, geometry, body_of_cell, n_bodies);
  for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f)
    add_face(mesh, elastic, f, bodies[body_of_cell[mesh.owner[f]]]);
  std::vector<double> sums;
  for (const Body& body : bodies)
    sums.insert(sums.end(), body.resistance.data(), body.resistance.data() + 36);
  add_over_ranks(mesh.comm, sums);
  std::vector<FreeMotion> result;
  for (Index b = 0; b < n_bodies; ++b) {
    bodies[b].resistance = Eigen::Map<const Resistance>(sums.data() + 36 * b);
    result.push_back({bodies[b].centre, free_modes(bodies[b], mesh.dim, is_axisymmetric(elastic))});
  }
  return result;
}

void check_supported(const mesh::Mesh& mesh, const elastic::ElasticOperator& elastic) {
  const std::vector<FreeMotion> bodies = free_motions(mesh, elastic);
  std::string trouble;
  for (const FreeMotion& body : bodies) {
    if (body.modes.empty()) continue;
    if (bodies.size() > 1)
      trouble += fmt::format(
          "{}the body around ({:.4g}, {:.4g}, {:.4g}), one of {} unconnected ones, is free in ",
          trouble.empty() ? "" : "; ", body.centre[0], body.centre[1], body.centre[2], bodies.size());
    for (std::size_t i = 0; i < body.modes.size(); ++i) trouble += (i ? ", " : "") + body.modes[i];
  }
  if (trouble.empty()) return;
  throw Error(
      "boundaries: the supports of this static analysis leave rigid-body motions free: {}. Prevent them by "
      "'fixed-displacement' (all or some components), 'symmetry', a 'spring' or another support, or use 'analysis: dynamic'.",
      trouble);
}

}  // namespace couplet::solid
