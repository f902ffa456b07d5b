// SPDX-License-Identifier: Apache-2.0
// A plate in a square that moves as told, for the tests of the mover.
#pragma once

#include "common/mesh/load.hpp"
#include "mesh_mover/mover.hpp"
#include "tests/support/own_folder.hpp"
#include "tests/support/test.hpp"

namespace couplet::mesh_mover::test {

inline double largest_difference(MPI_Comm comm, const std::vector<double>& a, const std::vector<double>& b) {
  double worst = a.size() == b.size() ? 0 : 1e300;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    worst = std::max(worst, std::abs(a[i] - b[i]));
  return parallel::max(comm, worst);
}

inline Parameters all_patches(const mesh::Mesh& mesh, BoundaryMotion motion) {
  Parameters p;
  p.dimension = mesh.dim;
  for (const mesh::Patch& patch : mesh.patches) p.boundaries[patch.name].motion = motion;
  return p;
}

/// `dim` values of the field f per point.
template <class F>
std::vector<double> at_points(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const F& f) {
  std::vector<double> values;
  for (const Vec3& x : geometry.points) {
    const Vec3 d = f(x);
    values.insert(values.end(), d.data(), d.data() + mesh.dim);
  }
  return values;
}

inline mesh::LoadedMesh perturbed_box(mesh::BoxCells cells, int n) {
  mesh::RawMesh raw = mesh::make_box(cells, {n, n, n}, Vec3::Zero(), Vec3::Ones());
  mesh::perturb_interior(raw, 0.2, 7);
  return mesh::distribute(MPI_COMM_WORLD, raw);
}

inline Parameters plate_in_a_square(Method method, double chi = 1) {
  Parameters p;
  p.mesh = "square.geo";
  p.mesh_parameters = {{"n", 16}};
  p.dimension = 2;
  p.method = method;
  p.stiffening = chi;
  for (const char* wall : {"floor", "right", "lid", "left"}) p.boundaries[wall].motion = BoundaryMotion::slip;
  p.boundaries["plate"].motion = BoundaryMotion::moving;
  return p;
}

inline app::ParticipantContext context() {
  app::ParticipantContext c;
  c.comm = MPI_COMM_WORLD;
  c.name = "mover";
  c.case_folder = COUPLET_CONFIGS "/moving-mesh";
  c.coupled = true;  // writes no fields
  c.output_folder = support::own_folder();
  return c;
}

inline void run(Mover& mover, double from, double to, int steps) {
  for (int i = 0; i < steps; ++i) {
    const double dt = (to - from) / steps;
    mover.begin_step({from + i * dt, dt, coupling::Scheme::standalone, i});
    mover.solve({});
    mover.accept_step();
  }
}

/// Makes this mover on one rank, with a folder of its own.
inline app::ParticipantContext alone(app::ParticipantContext c = context()) {
  c.comm = MPI_COMM_SELF;
  c.output_folder = support::own_folder() / ("alone-" + std::to_string(parallel::comm_rank(MPI_COMM_WORLD)));
  std::filesystem::create_directories(c.output_folder);
  return c;
}

/// Largest difference to a reference on one rank, over all ranks.
inline double difference_to(const Mover& reference, const Mover& mover,
                            const std::vector<double>& displacement) {
  const int dim = mover.mesh().dim;
  std::vector<double> by_id(reference.displacement().size());
  for (Index v = 0; v < reference.mesh().points.n_local(); ++v)
    for (int c = 0; c < dim; ++c)
      by_id[dim * reference.mesh().point_id[v] + c] = reference.displacement()[dim * v + c];
  double worst = 0;
  for (Index v = 0; v < mover.mesh().points.n_local(); ++v)
    for (int c = 0; c < dim; ++c)
      worst =
          std::max(worst, std::abs(by_id[dim * mover.mesh().point_id[v] + c] - displacement[dim * v + c]));
  return parallel::max(MPI_COMM_WORLD, worst);
}

inline void turn_by(Parameters& p, const std::string& angle) {
  p.boundaries["plate"].prescribed.angle = {angle};
}

}  // namespace couplet::mesh_mover::test
