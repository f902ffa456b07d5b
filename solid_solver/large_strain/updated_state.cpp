// SPDX-License-Identifier: Apache-2.0
// What follows from a state of the updated-Lagrangian method: energies, forces, the place where the next step begins.
#include "common/base/error.hpp"
#include "common/elasticity/symmetric/symmetric_faces.hpp"
#include "common/elasticity/vector_at.hpp"
#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/large_strain/updated_lagrangian.hpp"

namespace couplet::solid {
namespace {

constexpr const char* points_on_file = "updated-points";
constexpr const char* gradient_on_file = "updated-deformation";

}  // namespace

std::vector<double> UpdatedLagrangian::forces(std::span<const double> unknowns,
                                              std::span<const double> known) {
  std::vector<double> result(unknowns.size(), 0);
  look(unknowns, known);
  add_forces(result);
  return result;
}

/// W a face times the pyramids of owned cells over it.
double UpdatedLagrangian::energy(std::span<const double> unknowns, std::span<const double> known) {
  look(unknowns, known);
  const Index n = mesh_.cells.n_owned();
  double here = 0;
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
    const auto [behind, ahead] = elastic::pyramids(mesh_, geometry_, f);
    if (mesh_.owner[f] < n) here += behind * energy_[f];
    if (f < mesh_.n_interior && mesh_.neighbour[f] < n) here += ahead * energy_[f];
  }
  return parallel::sum(mesh_.comm, here);
}

/// Each face once over all ranks, where the cell of its owner lives.
void UpdatedLagrangian::visit(std::span<const double> unknowns, std::span<const double> known,
                              const Take& take) {
  look(unknowns, known);
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f)
    if (mesh_.owner[f] < mesh_.cells.n_owned()) take(f, deformation_[f], stress_[f]);
}

/// Loads need not be taken off: faces that are held take none.
std::vector<elastic::Wrench> UpdatedLagrangian::holding_forces(std::span<const double> unknowns,
                                                               std::span<const double> known,
                                                               const elastic::ElasticLoads&) {
  look(unknowns, known);
  std::vector<elastic::Wrench> forces;
  for (const mesh::Patch& patch : mesh_.patches) {
    elastic::Wrench force;
    for (Index f = patch.first; f < patch.first + patch.count; ++f) {
      const Vec3& S = frame().area()[f];
      Vec3 centre = Vec3::Zero();
      for (const Index v : mesh_.face_points[f])
        centre += now_.points[v] / double(mesh_.face_points[f].size());
      if (rows_.at(f).fixed) force.add(force_through(f), centre);
      if (rows_.mirrored(f)) force.add(S.dot(force_through(f)) / S.squaredNorm() * S, centre);
    }
    forces.push_back(force);
  }
  return forces;
}

void UpdatedLagrangian::end_step(std::span<const double> unknowns, std::span<const double> known) {
  if (!look(unknowns, known)) throw SolveFailure("The end of the step inverts a cell. {}", where_worst());
  const std::size_t dim = mesh_.dim;
  const auto [u, g] = since_start(unknowns, known);
  std::vector<double> moved(std::size_t(mesh_.points.n_local()) * dim, 0);
  frame().kernel().point_values(u, g, moved);
  mesh_.points.update_ghosts(moved, mesh_.dim);
  next_.points = now_.points;
  for (Index v = 0; v < mesh_.points.n_local(); ++v)
    next_.points[v] += elastic::vector_at(moved, v, mesh_.dim);
  next_.gradient = deformation_;
  next_.u.assign(unknowns.begin(), unknowns.end());
  next_.known.assign(g.size(), 0);
  std::ranges::copy(known, next_.known.begin());
}

void UpdatedLagrangian::accept() {
  std::swap(now_, next_);
  frame_.reset();
}

void UpdatedLagrangian::save(io::CheckpointWriter& file) const {
  std::vector<double> points, gradient;
  for (const Vec3& x : now_.points) points.insert(points.end(), x.begin(), x.end());
  for (const Tensor3& F : now_.gradient)
    gradient.insert(gradient.end(), F.reshaped().begin(), F.reshaped().end());
  file.write(mesh::Entries::points, points_on_file, points);
  file.write(mesh::Entries::flux_faces, gradient_on_file, gradient);
}

void UpdatedLagrangian::load(io::CheckpointReader& file, std::span<const double> unknowns,
                             std::span<const double> known) {
  std::vector<double> points(now_.points.size() * 3), gradient(now_.gradient.size() * 9);
  file.read(mesh::Entries::points, points_on_file, points);
  file.read(mesh::Entries::flux_faces, gradient_on_file, gradient);
  for (std::size_t v = 0; v < now_.points.size(); ++v)
    now_.points[v] = Vec3(points[3 * v], points[3 * v + 1], points[3 * v + 2]);
  for (std::size_t f = 0; f < now_.gradient.size(); ++f)
    now_.gradient[f] = Eigen::Map<const Tensor3>(gradient.data() + 9 * f);
  now_.u.assign(unknowns.begin(), unknowns.end());
  std::ranges::copy(known, now_.known.begin());
  frame_.reset();
}

}  // namespace couplet::solid
