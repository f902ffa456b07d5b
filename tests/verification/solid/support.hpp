// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/mesh/load.hpp"
#include "solid_solver/diagnostics/energy_balance.hpp"
#include "solid_solver/diagnostics/strain_energy.hpp"
#include "solid_solver/solid.hpp"
#include "tests/support/box.hpp"

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

inline std::unique_ptr<Solid> make_solid(mesh::RawMesh raw, const SolidParameters& p) {
  raw.materials = zones_of(p.materials);
  return std::make_unique<Solid>(mesh::distribute(MPI_COMM_WORLD, raw), p, SolidContext{});
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
  EnergyBalance balance(view, view.compares_gradients() ? std::make_shared<StrainEnergy>(view) : nullptr);
  diagnostics::Report report;
  balance.look(report);
  return balance.audit().created();
}

inline constexpr std::array all_cells{mesh::BoxCells::quadrilaterals, mesh::BoxCells::triangles,
                                      mesh::BoxCells::hexahedra,      mesh::BoxCells::tetrahedra,
                                      mesh::BoxCells::prisms,         mesh::BoxCells::mixed};

inline const char* name(mesh::BoxCells cells) {
  constexpr std::array names{"quadrilaterals", "triangles", "hexahedra", "tetrahedra", "prisms", "mixed"};
  return names.at(std::size_t(cells));
}

}  // namespace couplet::testing
