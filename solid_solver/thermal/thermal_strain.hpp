// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/coupling/participant.hpp"
#include "common/diagnostics/error_parts.hpp"
#include "common/elasticity/elastic_kernel.hpp"
#include "common/elasticity/elasticity.hpp"
#include "common/fv/expression.hpp"
#include "common/fv/table.hpp"
#include "common/io/fields/field_writer.hpp"
#include "common/mesh/mesh.hpp"
#include "solid_solver/effects/evidence.hpp"
#include "solid_solver/parameters/parameters.hpp"
#include "solid_solver/thermal/heat.hpp"
#include "solid_solver/thermal/heat_errors.hpp"

namespace couplet::solid {

/// Conduction for this mesh and these parameters (`parameters.heat` must be there). Collective.
std::unique_ptr<Heat> make_heat(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                const SolidParameters& parameters);

/// 3 K of (effective, in plane stress) constants [Pa].
double three_bulk(elastic::LameConstants lame, bool plane_stress);

/// Temperature in the solid, solved for or prescribed, and the stress it makes, thesis (2.21), (2.60):
///   sigma = sigma(grad u) - B epsilon I,   epsilon = integral of alpha dT from T_ref on,   B = 3 lambda + 2 mu
/// (plane stress: B = 2 lambda + 2 mu with the effective lambda). alpha is the instantaneous coefficient: 3 K
/// alpha (T - T0) of (5.10) holds for a constant one only. In the equations B epsilon S is a known force of
/// each face at its own temperature (or, with one volume strain a cell, at that of its cells): uniform temperatures leave a
/// free body without stress, exactly.
/// With thermoelastic coupling the strain rate of the step before gives the heat -3 K alpha T tr(d eps/dt)
/// (2.27).
///
/// As for a Participant, only accept_step() changes the accepted state.
class ThermalStrain {
 public:
  ThermalStrain(const mesh::Mesh& mesh, const elastic::ElasticOperator& elastic,
                const SolidParameters& parameters);

  /// A step from t^n is tried: solves for its temperature. Throws SolveFailure.
  void begin_step(const coupling::Step& step);
  /// Elastic constants that the operator must get for the step now tried, one a local cell; empty: its own
  /// hold. The same answer on all ranks.
  std::span<const elastic::LameConstants> stiffness() const;
  /// The operator has got other constants since the last call. Collective.
  void stiffness_changed();
  /// Adds the forces [N] at time t within the step to the rows of the kernel.
  void add_loads(double t, const elastic::ElasticKernel& kernel, std::span<double> rhs);
  /// The stress - p I it stands for at time t, p [Pa] per local face; empty: none.
  std::vector<double> pressure(double t);
  /// The strain of the free body at time t, one a local flux face, where the equilibrium takes it so (large strain):
  /// add_loads() and the stresses have nothing of it then. Empty: none.
  std::vector<double> expansion(double t);
  void accept_step();
  /// If it wants_temperature(), it gets the centres of this rank's faces of the interface once, and what was given at
  /// these at the start of each solve (empty: nothing yet); begin_step() follows. Collective.
  bool wants_temperature() const { return given_; }
  void set_interface(const std::vector<Vec3>& face_centres, const std::vector<Index>& faces);
  void take_temperature(const std::vector<double>& faces);
  /// If it wants_stress(), it gets that of the owned cells after each accepted step [Pa].
  bool wants_stress() const { return coupled_; }
  void take_stress(std::span<const Tensor3> stress);
  void save(io::CheckpointWriter& file) const;
  void load(io::CheckpointReader& file);
  /// Adds its part of the stress of owned cells at the accepted time [Pa].
  void add_cell_stress(std::span<Tensor3> stress) const;
  /// Adds its part of the stress of the local faces first, first + 1, ...
  void add_face_stress(Index first, std::span<Tensor3> stress) const;
  /// Appends fields at the accepted time; their values live until the next call.
  void add_fields(std::vector<io::OutputField>& fields);
  /// The same of the boundary: of all local points, or (place "cells") of the boundary faces of owned cells. Collective.
  void add_surface_fields(std::vector<io::OutputField>& fields);
  /// Adds what it has seen, for the verdicts on what was left out. Collective.
  void add_evidence(SolidEvidence& evidence) const;
  /// For Participant::finish(), beside the verdicts of the cards.
  void judge(std::vector<std::string>& sentences) const;
  /// Before the first step, if the run is to end with an estimate of its error; else nothing is collected.
  void collect_errors();
  /// Error of the temperature that is solved for, over its distance from the reference: the strain errs by as much. Collective.
  diagnostics::ErrorParts error_parts() const;

  /// None: the temperature is prescribed.
  const Heat* heat() const { return heat_.get(); }
  /// Of all local points at the accepted time [K]. Collective.
  std::vector<double> point_temperature() const;

 private:
  enum Places { at_faces, at_points, at_cells };  // groups of interface_
  bool expands() const { return !expansion_.empty() && !is_large_; }
  /// Temperatures of the flux faces of the mesh at an end of the step: T^{n+1} of the trial, or accepted.
  std::vector<double> face_temperature(double t, bool trial) const;
  std::vector<double> given_at(Places places, bool trial) const;
  std::vector<double> strain(std::span<const double> temperature) const;
  /// B epsilon of the flux faces [Pa] from their epsilon. With one volume strain a cell the bulk modulus acts on the cell's
  /// mean of grad u, and so does epsilon: K (tr e_P - 3 epsilon_P), to the faces by their pyramids as K tr e_P is.
  /// Otherwise each face's own temperature would pull on the mean of all, with K: at nu 0.499 and a temperature that
  /// is linear in x 20 MPa in a body of 1 GPa that is free of stress. Collective.
  std::vector<double> stress_of(const std::vector<double>& strain) const;
  bool by_cells() const { return elastic_->volume_by_cells() && !plane_stress_; }
  double modulus(Index cell) const;  // B
  double face_modulus(Index face) const;
  /// Means over the faces by the pyramids on them, as the displacement gradient of a cell is; owned cells.
  std::vector<double> pyramid_means(const std::vector<double>& of_faces) const;
  std::vector<double> cell_strain() const;  // thermal, of owned cells at the accepted time
  double coupling_number() const;
  void set_accepted();
  std::vector<double> cell_temperature(double t, bool trial) const;  // of all local cells
  std::vector<elastic::LameConstants> lame_at(std::span<const double> temperature) const;
  void choose_stiffness(double t);

  const mesh::Mesh* mesh_;
  const mesh::Geometry* geometry_;
  const elastic::ElasticOperator* elastic_;
  std::unique_ptr<Heat> heat_;        // none: prescribed
  std::optional<HeatErrors> errors_;  // none: not wanted
  std::optional<fv::Expression> prescribed_;
  bool given_ = false;                                // at the interface
  std::vector<Index> interface_faces_;                // as entries of the boundary
  std::optional<InterfaceTemperature> interface_;     // once it is known where that is
  std::vector<double> given_accepted_, given_trial_;  // at its faces that are needed here [K]
  std::vector<fv::Property> expansion_;               // one a material; none: no thermal strain
  double reference_ = 0;                              // [K]
  bool plane_stress_ = false, is_large_ = false;      // is_large_: the equilibrium takes expansion()
  SolidParameters parameters_;
  std::vector<std::optional<fv::Property>> youngs_modulus_, poissons_ratio_;  // one a material
  bool varies_ = false;                                                       // some of them
  std::vector<elastic::LameConstants> lame_,
      lame_trial_;  // per local cell, of the accepted and the trial step; if varies_
  std::vector<SolidMaterial> materials_;
  bool coupled_ = false;
  std::vector<double> dilation_, dilation_rate_;  // tr(eps) and its rate, per owned cell; when coupled

  coupling::Step step_;
  double time_ = 0;                              // of the accepted state
  std::vector<double> start_, end_;              // face temperatures at both ends of the step
  std::vector<double> accepted_strain_;          // per flux face of the mesh, at the accepted time
  std::vector<double> accepted_stress_;          // the same times B [Pa]: see stress_of(); if by_cells()
  std::vector<double> points_, cells_, inflow_;  // of the last fields written
  double lowest_ = 0, highest_ = 0;              // temperatures seen on this rank
};

}  // namespace couplet::solid
