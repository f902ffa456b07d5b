// SPDX-License-Identifier: Apache-2.0
#include "common/io/probe.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "common/base/nearest.hpp"
#include "common/io/shape_functions.hpp"
#include "common/parallel/collective.hpp"

namespace couplet {
namespace {

constexpr double none = std::numeric_limits<double>::infinity();

// One rank's best way to hold the probe; the ranks agree on the smallest key.
struct Candidate {
  double key = none;
  Vec3 place = Vec3::Zero();
  std::vector<Index> points;
  std::vector<double> weights;
};

Candidate nearest_point(const Mesh& mesh, const Vec3& place) {
  Candidate best;
  for (Index p = 0; p < mesh.points.n_owned(); ++p) {
    const double distance = (mesh.reference_points[p] - place).norm();
    if (distance < best.key) best = {distance, mesh.reference_points[p], {p}, {1.0}};
  }
  return best;
}

Candidate containing_cell(const Mesh& mesh, const Vec3& place) {
  constexpr double slack = 1e-9;
  Candidate best;
  std::vector<Vec3> corners;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    // The first cell of the file that contains it, so that a place on a face has the same cell on any
    // partition.
    if (double(mesh.cell_id[c]) > best.key) continue;
    const auto points = mesh.cell_points[c];
    corners.clear();
    for (const Index p : points) corners.push_back(mesh.reference_points[p]);
    const auto weights = weights_in_cell(mesh.cell_type[c], corners, place, slack);
    if (!weights) continue;
    best = {double(mesh.cell_id[c]),
            place,
            {points.begin(), points.end()},
            {weights->begin(), weights->begin() + std::ptrdiff_t(points.size())}};
  }
  return best;
}

Candidate nearest_on_face(const Mesh& mesh, std::span<const Index> points, const Vec3& place) {
  Candidate best;
  const auto consider = [&](std::initializer_list<int> corners, std::span<const double> weights) {
    Candidate one;
    int i = 0;
    for (const int corner : corners) {
      one.points.push_back(points[corner]);
      one.weights.push_back(weights[i]);
      one.place += weights[i++] * mesh.reference_points[points[corner]];
    }
    one.key = (one.place - place).norm();
    if (one.key < best.key) best = std::move(one);
  };
  const auto x = [&](int i) -> const Vec3& { return mesh.reference_points[points[i]]; };
  if (points.size() == 2) {
    consider({0, 1}, nearest_on_segment(x(0), x(1), place).weights);
  } else {
    consider({0, 1, 2}, nearest_on_triangle(x(0), x(1), x(2), place).weights);
    if (points.size() == 4) consider({0, 2, 3}, nearest_on_triangle(x(0), x(2), x(3), place).weights);
  }
  return best;
}

Candidate nearest_on_boundary(const Mesh& mesh, const Vec3& place) {
  Candidate best;
  for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f) {
    Candidate one = nearest_on_face(mesh, mesh.face_points[f], place);
    if (one.key < best.key) best = std::move(one);
  }
  return best;
}

// The rank with the smallest key, and that key. Collective.
std::pair<double, int> agree(MPI_Comm comm, double key) {
  struct {
    double key;
    int rank;
  } value{key, comm_rank(comm)};
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE_INT, MPI_MINLOC, comm);
  return {value.key, value.rank};
}

double mesh_size(const Mesh& mesh) {
  Vec3 low = Vec3::Constant(none), high = Vec3::Constant(-none);
  for (const Vec3& p : mesh.reference_points) low = low.cwiseMin(p), high = high.cwiseMax(p);
  MPI_Allreduce(MPI_IN_PLACE, low.data(), 3, MPI_DOUBLE, MPI_MIN, mesh.comm);
  MPI_Allreduce(MPI_IN_PLACE, high.data(), 3, MPI_DOUBLE, MPI_MAX, mesh.comm);
  return (high - low).norm();
}

}  // namespace

Probe::Probe(const Mesh& mesh, const std::string& name, const Vec3& place, std::optional<double> tolerance)
    : comm_(mesh.comm) {
  const double size = mesh_size(mesh);
  Candidate chosen = nearest_point(mesh, place);
  auto [key, rank] = agree(comm_, chosen.key);
  if (key > 1e-10 * size) {
    chosen = containing_cell(mesh, place);
    std::tie(key, rank) = agree(comm_, chosen.key);
    if (key == none) {
      chosen = nearest_on_boundary(mesh, place);
      std::tie(key, rank) = agree(comm_, chosen.key);
      MPI_Bcast(chosen.place.data(), 3, MPI_DOUBLE, rank, comm_);
      if (key > tolerance.value_or(1e-6 * size))
        throw Error(
            "The probe '{}' at ({}, {}, {}) lies outside the mesh: the nearest place of it is ({:.6g}, "
            "{:.6g}, {:.6g}), "
            "{:.3g} m away. Move the probe there or into the mesh.",
            name, place[0], place[1], place[2], chosen.place[0], chosen.place[1], chosen.place[2], key);
    }
  }
  MPI_Bcast(chosen.place.data(), 3, MPI_DOUBLE, rank, comm_);
  place_ = chosen.place;
  if (comm_rank(comm_) == rank) {
    points_ = std::move(chosen.points);
    weights_ = std::move(chosen.weights);
  }
}

std::vector<double> Probe::sample(std::span<const double> values, int components) const {
  std::vector<double> result(components, 0.0);
  for (std::size_t i = 0; i < points_.size(); ++i)
    for (int c = 0; c < components; ++c)
      result[c] += weights_[i] * values[std::size_t(points_[i]) * components + c];
  // All ranks but one bring zeros.
  const bool root = comm_rank(comm_) == 0;
  MPI_Reduce(root ? MPI_IN_PLACE : result.data(), result.data(), components, MPI_DOUBLE, MPI_SUM, 0, comm_);
  if (!root) result.clear();
  return result;
}

}  // namespace couplet
