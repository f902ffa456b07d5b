// SPDX-License-Identifier: Apache-2.0
#include "common/io/probes/probe.hpp"

#include <cmath>
#include <limits>
#include <ranges>
#include <tuple>

#include "common/base/error.hpp"
#include "common/base/point_tree.hpp"
#include "common/io/probes/place_search.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::io {
namespace {

constexpr double none = std::numeric_limits<double>::infinity();
// Tolerances relative to the mesh size for a position on a point and on the boundary.
constexpr double on_point = 1e-10, on_boundary = 1e-6;

// Best candidate of one rank for the probe. The ranks agree on the smallest key.
struct Candidate {
  double key = none;
  Vec3 place = Vec3::Zero();
  std::vector<Index> points;
  std::vector<double> weights;
};

// Nearest point among all candidates, or those that a search found; likewise below.
Candidate nearest_point(std::span<const Vec3> places, const auto& candidates, const Vec3& place) {
  Candidate best;
  for (const Index p : candidates) {
    const double distance = (places[p] - place).norm();
    if (distance < best.key) best = {distance, places[p], {p}, {1.0}};
  }
  return best;
}

Candidate containing_cell(const mesh::Mesh& mesh, std::span<const Vec3> places, const auto& candidates,
                          const Vec3& place) {
  constexpr double slack = 1e-9;
  Candidate best;
  std::vector<Vec3> corners;
  for (const Index c : candidates) {
    // Takes the first containing cell of the file, so a position on a face has the same cell on any
    // partition.
    if (double(mesh.cell_id[c]) > best.key) continue;
    const auto points = mesh.cell_points[c];
    corners.clear();
    for (const Index p : points) corners.push_back(places[p]);
    const auto weights = weights_in_cell(mesh.cell_type[c], corners, place, slack);
    if (!weights) continue;
    best = {double(mesh.cell_id[c]),
            place,
            {points.begin(), points.end()},
            {weights->begin(), weights->begin() + std::ptrdiff_t(points.size())}};
  }
  return best;
}

Candidate nearest_on_face(std::span<const Vec3> places, std::span<const Index> points, const Vec3& place) {
  Candidate best;
  const auto consider = [&](std::initializer_list<int> corners, std::span<const double> weights) {
    Candidate one;
    int i = 0;
    for (const int corner : corners) {
      one.points.push_back(points[corner]);
      one.weights.push_back(weights[i]);
      one.place += weights[i++] * places[points[corner]];
    }
    one.key = (one.place - place).norm();
    if (one.key < best.key) best = std::move(one);
  };
  const auto x = [&](int i) -> const Vec3& { return places[points[i]]; };
  if (points.size() == 2) {
    consider({0, 1}, base::nearest_on_segment(x(0), x(1), place).weights);
  } else {
    consider({0, 1, 2}, base::nearest_on_triangle(x(0), x(1), x(2), place).weights);
    if (points.size() == 4) consider({0, 2, 3}, base::nearest_on_triangle(x(0), x(2), x(3), place).weights);
  }
  return best;
}

Candidate nearest_on_boundary(const mesh::Mesh& mesh, std::span<const Vec3> places, const auto& candidates,
                              const Vec3& place) {
  Candidate best;
  for (const Index f : candidates) {
    Candidate one = nearest_on_face(places, mesh.face_points[f], place);
    if (one.key < best.key) best = std::move(one);
  }
  return best;
}

// Finds the smallest key and its rank. Collective.
std::pair<double, int> agree(MPI_Comm comm, double key) {
  struct {
    double key;
    int rank;
  } value{key, parallel::comm_rank(comm)};
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE_INT, MPI_MINLOC, comm);
  return {value.key, value.rank};
}

// Finds a mesh point, a cell, or else the nearest boundary position: this rank's candidate, and the best key
// with its rank. `look` returns points, cells and faces within a distance. Collective.
struct ChosenPlace {
  Candidate candidate;
  double key = none;  // distance from the boundary if outside [m]
  int rank = 0;
  bool outside = false;
};
ChosenPlace choose(const mesh::Mesh& mesh, std::span<const Vec3> places, const Vec3& place, double size,
                   const auto& look) {
  ChosenPlace chosen;
  chosen.candidate = nearest_point(places, look.points(place, on_point * size), place);
  std::tie(chosen.key, chosen.rank) = agree(mesh.comm, chosen.candidate.key);
  if (chosen.key <= on_point * size) return chosen;
  chosen.candidate = containing_cell(mesh, places, look.cells(place, on_point * size), place);
  std::tie(chosen.key, chosen.rank) = agree(mesh.comm, chosen.candidate.key);
  if (chosen.key != none) return chosen;
  chosen.candidate = nearest_on_boundary(mesh, places, look.faces(place, on_boundary * size), place);
  std::tie(chosen.key, chosen.rank) = agree(mesh.comm, chosen.candidate.key);
  chosen.outside = true;
  return chosen;
}

// Candidates for a single position, without the cost of a tree.
struct Everything {
  const mesh::Mesh& mesh;
  auto points(const Vec3&, double) const { return std::views::iota(Index(0), mesh.points.n_owned()); }
  auto cells(const Vec3&, double) const { return std::views::iota(Index(0), mesh.cells.n_owned()); }
  auto faces(const Vec3&, double) const { return std::views::iota(mesh.n_interior, mesh.n_flux_faces()); }
};

}  // namespace

void Probe::take(const Vec3& place, int rank, const std::vector<Index>& points,
                 const std::vector<double>& weights) {
  place_ = place;
  MPI_Bcast(place_.data(), 3, MPI_DOUBLE, rank, comm_);
  if (parallel::comm_rank(comm_) != rank) return;
  constexpr double rounding = 1e-12;  // of a point across the side of the cell that the place lies on
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::abs(weights[i]) < rounding) continue;
    points_.push_back(points[i]);
    weights_.push_back(weights[i]);
  }
}

Probe::Probe(const mesh::Mesh& mesh, std::span<const Vec3> places, const std::string& name, const Vec3& place,
             std::optional<double> tolerance)
    : comm_(mesh.comm) {
  const double size = mesh_size(mesh, places);
  ChosenPlace chosen = choose(mesh, places, place, size, Everything{mesh});
  take(chosen.candidate.place, chosen.rank, chosen.candidate.points, chosen.candidate.weights);
  if (chosen.outside && chosen.key > tolerance.value_or(on_boundary * size))
    throw Error(
        "The probe '{}' at ({}, {}, {}) is outside the mesh: the nearest point of the mesh is ({:.6g}, "
        "{:.6g}, {:.6g}), {:.3g} m away. Move the probe there or into the mesh{}.",
        name, place[0], place[1], place[2], place_[0], place_[1], place_[2], chosen.key,
        chosen.key > 10 * size ? "; a number without a unit is in meters" : "");
}

std::optional<Probe> Probe::in(const PlaceSearch& search, const Vec3& place) {
  const mesh::Mesh& mesh = search.mesh();
  const double size = search.size();
  ChosenPlace chosen = choose(mesh, search.places(), place, size, search);
  if (chosen.outside && !(chosen.key <= on_boundary * size)) return {};
  Probe probe(mesh.comm);
  probe.take(chosen.candidate.place, chosen.rank, chosen.candidate.points, chosen.candidate.weights);
  return probe;
}

std::vector<double> Probe::sample(std::span<const double> values, int components) const {
  std::vector<double> result(components, 0.0);
  for (std::size_t i = 0; i < points_.size(); ++i)
    for (int c = 0; c < components; ++c)
      result[c] += weights_[i] * values[std::size_t(points_[i]) * components + c];
  // All ranks but one contribute zeros.
  const bool root = parallel::comm_rank(comm_) == 0;
  MPI_Reduce(root ? MPI_IN_PLACE : result.data(), result.data(), components, MPI_DOUBLE, MPI_SUM, 0, comm_);
  if (!root) result.clear();
  return result;
}

}  // namespace couplet::io
