// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mesh/load.hpp"
#include "solid_solver/diagnostics/stability.hpp"
#include "solid_solver/diagnostics/strain_energy.hpp"
#include "solid_solver/solid.hpp"
#include "tests/support/box.hpp"
#include "tests/support/saved_state.hpp"
#include "tests/support/test.hpp"

namespace couplet::testing {
using namespace solid;

using Type = SolidBoundary::Type;
using FaceGradient = MethodParameters::FaceGradient;

inline SolidBoundary boundary(Type type, const std::vector<std::string>& value = {}) {
  SolidBoundary b;
  b.type = type;
  for (const std::string& text : value) b.value.push_back({text});
  return b;
}

/// All components are held at zero.
inline SolidBoundary clamped(int dim) {
  return boundary(Type::fixed_displacement, std::vector<std::string>(std::size_t(dim), "0"));
}

inline SolidBoundary pressed(const std::string& pressure) {
  SolidBoundary b = boundary(Type::pressure);
  b.pressure = {pressure};
  return b;
}

inline SolidBoundary sprung(const std::string& stiffness) {
  SolidBoundary b = boundary(Type::spring);
  b.stiffness = {stiffness};
  return b;
}

/// All patches of make_box() free; E = 200 GPa, nu = 0.3, static.
inline SolidParameters box_parameters(int dim) {
  SolidParameters p;
  p.mesh = "box";
  p.dimension = dim;
  p.analysis = SolidParameters::Analysis::static_;
  p.material = {7800, 200e9, 0.3};
  for (const char* name : {"xmin", "xmax", "ymin", "ymax"}) p.boundaries[name] = boundary(Type::free);
  if (dim == 3)
    for (const char* name : {"zmin", "zmax"}) p.boundaries[name] = boundary(Type::free);
  return p;
}

inline std::unique_ptr<Solid> make_solid(mesh::RawMesh raw, const SolidParameters& p,
                                         MPI_Comm comm = MPI_COMM_WORLD) {
  raw.materials = zones_of(p.materials);
  return std::make_unique<Solid>(mesh::distribute(comm, raw), p, SolidContext{});
}

/// One accepted step from the present state.
inline void step(Solid& solid, double dt) {
  solid.begin_step(
      {solid.stepper().state().time, dt, coupling::Scheme::standalone, solid.stepper().state().steps});
  solid.solve({});
  solid.accept_step();
}

/// Work against strain energy of the accepted state, with two gradients.
inline StrainAudit audit_of(const Solid& solid) { return audit_strain(solid.view(), true); }

/// Energy that the accepted state of a motion holds beyond what it was given, over the latter.
inline double created_energy(const Solid& solid) {
  const SolidView view = solid.view();
  EnergyBalance balance(view, !view.body.large_strain() ? std::make_shared<StrainEnergy>(view) : nullptr);
  diagnostics::Report report;
  balance.look(report);
  return balance.audit().created();
}

/// After one step of 1 s.
inline std::unique_ptr<Solid> stepped(const mesh::RawMesh& raw, const SolidParameters& p,
                                      MPI_Comm comm = MPI_COMM_WORLD) {
  auto solid = make_solid(raw, p, comm);
  step(*solid, 1);
  return solid;
}

inline SolidEnergies energies(const Solid& solid) {
  return solid.stepper().ledger().total(solid.stepper().state(), solid.fields().point_displacement());
}

/// Displacement of a cell.
inline Vec3 cell_u(const Solid& solid, Index c) {
  const int dim = solid.body().mesh().dim;
  Vec3 u = Vec3::Zero();
  std::copy_n(&solid.stepper().state().cell_u[std::size_t(c) * std::size_t(dim)], dim, u.data());
  return u;
}

/// Root of the sum of squares of the cells' displacements on all ranks of the solid.
inline double norm_of(const Solid& solid) {
  double square = 0;
  for (Index c = 0; c < solid.body().mesh().cells.n_owned(); ++c) square += cell_u(solid, c).squaredNorm();
  return std::sqrt(parallel::sum(solid.body().mesh().comm, square));
}

/// Displacement of the mesh point at `x`, on all ranks.
inline Vec3 displacement_at(const Solid& solid, const Vec3& x) {
  const mesh::Mesh& mesh = solid.body().mesh();
  const std::vector<double> u = solid.fields().point_displacement();
  Vec3 found = Vec3::Constant(-1e300);
  for (Index v = 0; v < mesh.points.n_local(); ++v)
    if ((solid.body().geometry().points[v] - x).norm() < 1e-9)
      std::copy_n(&u[std::size_t(v) * std::size_t(mesh.dim)], mesh.dim, found.data());
  for (double& value : found) value = parallel::max(mesh.comm, value);
  return found;
}

/// Errors of cells in the L2 norm over the norm of what is wanted; of the stress the components of the plane in 2-D.
struct L2Errors {
  double displacement = 0, stress = 0;
};
inline L2Errors l2_errors(const Solid& solid, const std::function<Vec3(const Vec3&)>& exact_u,
                          const std::function<Tensor3(const Vec3&)>& exact_stress = {}) {
  const mesh::Mesh& mesh = solid.body().mesh();
  const bool in_plane =
      mesh.dim == 2 && solid.body().parameters().plane != SolidParameters::Plane::axisymmetric;
  const int n = in_plane ? 2 : 3;
  const auto stress = solid.fields().cell_stress(solid.fields().point_displacement());
  std::array<double, 4> sums{};
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    const Vec3& x = solid.body().geometry().cell_centre[c];
    const double volume = solid.body().geometry().volume[c];
    sums[0] += volume * (cell_u(solid, c) - exact_u(x)).squaredNorm();
    sums[1] += volume * exact_u(x).squaredNorm();
    if (!exact_stress) continue;
    const Tensor3 wanted = exact_stress(x);
    sums[2] += volume * (stress[std::size_t(c)] - wanted).topLeftCorner(n, n).squaredNorm();
    sums[3] += volume * wanted.topLeftCorner(n, n).squaredNorm();
  }
  for (double& s : sums) s = parallel::sum(mesh.comm, s);
  return {sums[1] > 0 ? std::sqrt(sums[0] / sums[1]) : 0, sums[3] > 0 ? std::sqrt(sums[2] / sums[3]) : 0};
}

/// A run of two steps and one that goes on from what another had saved after the first step have the same displacements.
inline void expect_same_after_restart(const mesh::RawMesh& raw, const SolidParameters& p, double first,
                                      double second) {
  const mesh::LoadedMesh body = mesh::distribute(MPI_COMM_WORLD, raw);
  Solid through(body, p, {}), before(body, p, {}), after(body, p, {});
  step(through, first), step(before, first);
  support::SavedState(before).load_into(after);
  EXPECT_EQ(before.fields().cell_stress(before.fields().point_displacement()),
            after.fields().cell_stress(after.fields().point_displacement()));
  step(through, second), step(after, second);
  EXPECT_EQ(through.stepper().state().cell_u, after.stepper().state().cell_u);
  EXPECT_EQ(through.stepper().state().face_u, after.stepper().state().face_u);
}

/// A quarter of a ring; xmin is its inner side, ymin and ymax lie on the axes.
inline mesh::RawMesh quarter_ring(mesh::BoxCells cells, int across, int around, double inner = 1,
                                  double outer = 2) {
  mesh::RawMesh raw =
      mesh::make_box(cells, {across, around, 1}, Vec3(inner, 0, 0), Vec3(outer, std::numbers::pi / 2, 0));
  for (Vec3& x : raw.points) x = Vec3(x[0] * std::cos(x[1]), x[0] * std::sin(x[1]), 0);
  return raw;
}

/// Cook's membrane of n x n quadrilaterals, 48 mm long.
inline mesh::RawMesh cooks_membrane(int n) {
  mesh::RawMesh raw = mesh::make_box(mesh::BoxCells::quadrilaterals, {n, n, 1}, Vec3::Zero(), Vec3(1, 1, 0));
  for (Vec3& x : raw.points) x = Vec3(0.048 * x[0], 0.044 * x[0] + (0.044 - 0.028 * x[0]) * x[1], 0);
  return raw;
}

inline constexpr std::array all_cells{mesh::BoxCells::quadrilaterals, mesh::BoxCells::triangles,
                                      mesh::BoxCells::hexahedra,      mesh::BoxCells::tetrahedra,
                                      mesh::BoxCells::prisms,         mesh::BoxCells::mixed};

inline const char* name(mesh::BoxCells cells) {
  constexpr std::array names{"quadrilaterals", "triangles", "hexahedra", "tetrahedra", "prisms", "mixed"};
  return names.at(std::size_t(cells));
}

}  // namespace couplet::testing
