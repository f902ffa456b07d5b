// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/coupling/participant.hpp"
#include "common/fv/conduction.hpp"
#include "common/fv/table.hpp"
#include "common/linalg/linear_solver.hpp"
#include "solid_solver/parameters/heat_parameters.hpp"
#include "solid_solver/thermal/heat_boundaries.hpp"

namespace couplet::io {
class Archive;
}

namespace couplet::solid {

/// Thermal properties of one material.
struct HeatProperties {
  double density = 0;          // [kg/m^3]
  fv::Property conductivity;   // [W/(m K)]
  fv::Property specific_heat;  // [J/(kg K)]
  bool is_constant() const { return conductivity.is_constant() && specific_heat.is_constant(); }
};

/// Temperatures [K] at one accepted time, ghosts current.
struct HeatState {
  double time = 0, dt = 0;                        ///< dt: size of the step that ended here
  int steps = 0;                                  ///< accepted so far
  std::vector<double> cells, boundary;            ///< per local cell, per local boundary face
  std::vector<double> known;                      ///< prescribed values, see ConductionOperator
  std::vector<double> enthalpy, enthalpy_before;  ///< per owned cell, at t^n and t^{n-1} [J/kg]
  std::vector<double> inflow;                     ///< per owned cell [W]; trapezoidal rule only
  std::vector<double> taken;                      ///< mean over the step, per interface face [W]
};

/// Answer of a solid to heat at its interface, per face: k dT/dn = coefficient (ambient - T_face) + what passes beside it.
struct InterfaceFilm {
  std::vector<double>
      coefficient;  ///< heat per area that warms the face by 1 K within the step, if all faces take it [W/(m^2 K)]
  std::vector<double> ambient;  ///< temperature of the face without the heat that it took [K]
};

/// Heat flow through a patch into the solid [W].
struct PatchHeat {
  std::string patch;
  double heat = 0;
};

/// Heat conduction in a solid at rest, thesis (2.35):
///   rho V sum_i a_i h(T^i) / dt = theta R(T^{n+1}) + (1 - theta) R(T^n),  R = sum_f k S . grad T + V source
/// h is the integral of the specific heat, so that energy is conserved even if it depends on T. a = (1, -1)
/// and theta = 1 for Euler, theta = 1/2 for the trapezoidal rule, three levels for three-point backward
/// (2.46)-(2.47). Temperature-dependent conductivities use the last iterate, heat capacities Newton's method.
class Heat final {
 public:
  /// `materials`: one per zone of the mesh. Throws Error. Collective.
  Heat(const mesh::Mesh& mesh, const mesh::Geometry& geometry, std::vector<HeatProperties> materials,
       const HeatParameters& parameters, const std::vector<std::string>& symmetry_patches);
  ~Heat();

  /// Solves for the temperature at the end of the step. `source`: additional heat per owned cell [W/m^3], or
  /// empty. Throws SolveFailure. Collective.
  void solve(const coupling::Step& step, std::span<const double> source = {});
  void accept_step();
  /// Change of the temperature in the last accepted step over its range. Collective.
  double change() const;
  /// Interface faces of owned cells, in the order of take() and film(). Call once before the first step.
  void set_interface(const std::vector<Index>& faces);
  /// Sets the mean heat [W] that enters each interface face in the next step to solve.
  void take(std::vector<double> heat) { trial_.taken = std::move(heat); }
  /// After solve(). Collective.
  InterfaceFilm film() const;
  /// Saves or loads the accepted state. Collective.
  void visit(io::Archive& archive);

  const fv::ConductionOperator& conduction() const { return conduction_; }
  const HeatState& accepted() const { return state_; }
  /// State at the end of the last solve(); after accept_step() the state before the accepted one.
  const HeatState& trial() const { return trial_; }
  const HeatParameters& parameters() const { return parameters_; }
  const std::vector<HeatProperties>& materials() const { return materials_; }
  const HeatBoundaries& boundaries() const { return boundaries_; }
  bool is_steady() const { return parameters_.analysis == HeatParameters::Analysis::steady; }
  bool properties_vary() const { return properties_vary_; }
  /// Temperature of all local points. Collective.
  std::vector<double> point_temperature(const HeatState& state) const;
  /// Temperature of the flux faces of the mesh. Collective.
  std::vector<double> face_temperature(const HeatState& state) const;
  /// Heat through each patch at the accepted time. Collective.
  std::vector<PatchHeat> patch_heat() const;
  /// Heat flux into the solid per boundary face of owned cells at the accepted time [W/m^2]. Collective.
  std::vector<double> boundary_inflow() const;
  /// Heat stored in the whole solid relative to an arbitrary level [J]. Collective.
  double stored_heat() const;

  /// Change [K] in a next step with the same loads, after an Euler or trapezoidal step that changed the owned
  /// cells by `change`. Collective.
  std::vector<double> next_change(std::span<const double> change) const;

  // Linear steady problem with constant conductivities, for other data: used by the dual problem.

  /// Conductivity in the last step, per local face [W/(m K)].
  std::span<const double> conductivity() const { return conductivity_; }
  /// h |S| of the flux faces [W/K], per entry of conduction().flux_faces(); empty without convection.
  std::vector<double> transfer() const;
  /// Quadrature error of the source in each cell [W], accepted time; empty without a source.
  std::vector<double> source_missed() const;
  /// Solves for other `sources` [W], one per row, and known values. Throws SolveFailure. Collective.
  HeatState answer(std::vector<double> sources, std::vector<double> known) const;

 private:
  struct Coefficients;
  void start();
  /// Throws Error if a steady field is `is_missing` a temperature that determines its level.
  void require_level(bool is_missing) const;
  Coefficients coefficients(double dt) const;
  std::vector<double> face_heat() const;  // through flux faces into their owners [W]
  void set_conductivity(const HeatState& state, std::span<double> conductivity) const;
  std::vector<double> sources(double t, std::span<const double> further) const;
  void assemble(const Coefficients& c, std::span<const double> source);
  double take_solution();
  void take(std::span<const double> unknowns, HeatState& state) const;
  void set_inflow(std::span<const double> source);
  void add_taken(const Coefficients& c);
  void find_response(const Coefficients& c);

  const mesh::Mesh* mesh_;
  const mesh::Geometry* geometry_;
  std::vector<HeatProperties> materials_;
  HeatParameters parameters_;
  HeatBoundaries boundaries_;
  fv::ConductionOperator conduction_;
  fv::Expression source_;
  bool properties_vary_ = false;

  HeatState state_, trial_;
  std::vector<double> conductivity_, face_heat_, transfer_, capacity_, rhs_, unknowns_;
  linalg::SparseMatrix matrix_;
  std::unique_ptr<linalg::LinearSolver> solver_;
  double filled_for_ = -1;  // a_0/dt of the present matrix; -1 if none
  struct {
    std::vector<std::size_t> entries;  // of the faces in flux_faces()
    std::vector<double> enters;        // heat at the end of the step [W]
    std::vector<double> response;      // change of T by 1 W/m^2 at all of them [K m^2/W]
    double time = 0, weight = -1;      // start of the step and a_0/dt of the response
  } interface_;
};

}  // namespace couplet::solid
