// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/elasticity/elastic_kernel.hpp"
#include "common/elasticity/elasticity.hpp"
#include "common/fv/table.hpp"
#include "solid_solver/thermal/temperature_field.hpp"

namespace couplet::solid {

/// Stress and heat of the deformation that a temperature makes, thesis (2.21), (2.60):
///   sigma = sigma(grad u) - B epsilon I,   epsilon = integral of alpha dT from T_ref,   B = 3 lambda + 2 mu
/// In plane stress, B = 2 lambda + 2 mu with the effective lambda. alpha is the instantaneous coefficient; 3 K alpha (T - T0) of (5.10)
/// holds only if it is constant. B epsilon S is a known force of each face at its own temperature, or at that of its cells with one volume
/// strain per cell. A free body at uniform temperature is exactly stress-free. Thermoelastic coupling adds the heat
/// -3 K alpha T tr(d eps/dt) (2.27) from the strain rate of the previous step.
///
/// As for a Participant, only accept_step() changes the accepted state.
class ThermalLoad {
 public:
  ThermalLoad(const mesh::Mesh& mesh, const elastic::ElasticOperator& elastic,
              const SolidParameters& parameters);

  TemperatureField& temperature() { return temperature_; }
  /// Starts a step from t^n and solves for its temperature. Throws SolveFailure.
  void begin_step(const coupling::Step& step);
  /// Elastic constants for the current step, one per local cell; empty if unchanged. Equal on all ranks.
  std::span<const elastic::LameConstants> stiffness() const;
  /// Call after changing the constants of the operator. Collective.
  void stiffness_changed();
  /// Adds the forces [N] at time t within the step to the rows of the kernel.
  void add_loads(double t, const elastic::ElasticKernel& kernel, std::span<double> rhs) const;
  /// Thermal pressure p [Pa] at time t, stress -p I, per local face; empty if there is none.
  std::vector<double> pressure(double t) const;
  /// Strain of the free body at time t per local flux face, if the equilibrium includes it (large strain).
  /// add_loads() and the stresses then exclude it. Empty if there is none.
  std::vector<double> expansion(double t) const;
  void accept_step();
  /// If wants_stress(), take_stress() receives that of the owned cells after each accepted step [Pa].
  bool wants_stress() const { return parameters_.thermoelastic_coupling; }
  void take_stress(std::span<const Tensor3> stress);
  /// Saves or loads the accepted state. Collective.
  void visit(io::Archive& archive);
  /// Adds the thermal part of the stress of owned cells at the accepted time [Pa].
  void add_cell_stress(std::span<Tensor3> stress) const;
  /// Adds the thermal part of the stress of the local faces first, first + 1, ...
  void add_face_stress(Index first, std::span<Tensor3> stress) const;
  /// Relative stiffening by thermoelastic coupling; 0 if unknown. Collective.
  double coupling_number() const;

 private:
  /// A material with its tables over temperature.
  struct Material {
    SolidMaterial constants;
    std::optional<fv::Property> expansion, youngs_modulus, poissons_ratio;
  };
  /// False at large strain, where the equilibrium takes expansion().
  bool expands() const { return parameters_.expansion && !has_finite_strain(parameters_); }
  std::vector<double> strain(std::span<const double> temperature) const;
  /// B epsilon of the flux faces [Pa] from their epsilon. With one volume strain per cell, the bulk modulus acts on the cell mean, K (tr
  /// e_P - 3 epsilon_P), which is distributed to faces by their pyramids. Using the face's own epsilon instead would give a spurious
  /// stress: at nu = 0.499 and T linear in x, 20 MPa in a stress-free body of 1 GPa. Collective.
  std::vector<double> stress_of(const std::vector<double>& strain) const;
  bool by_cells() const { return elastic_->volume_by_cells() && !is_plane_stress(parameters_); }
  double modulus(Index cell) const;     // B
  double three_bulk(Index cell) const;  // 3 K, the true one in plane stress
  double face_modulus(Index face) const;
  /// Means over the faces weighted by their pyramids, as for the displacement gradient of a cell; owned cells.
  std::vector<double> pyramid_means(const std::vector<double>& of_faces) const;
  std::vector<double> cell_strain() const;  // thermal, per owned cell at the accepted time
  void set_accepted();
  std::vector<elastic::LameConstants> lame_at(std::span<const double> temperature) const;
  void choose_stiffness();

  const mesh::Mesh* mesh_;
  const elastic::ElasticOperator* elastic_;
  const SolidParameters parameters_;
  TemperatureField temperature_;
  std::vector<Material> materials_;
  /// Per local cell, of the accepted and the trial step; empty if the constants do not vary.
  struct Stiffness {
    std::vector<elastic::LameConstants> accepted, trial;
    bool varies = false;
  } lame_;
  struct Dilation {
    std::vector<double> value, rate;  // tr(eps) and its rate, per owned cell
  } dilation_;                        // with thermoelastic coupling
  double dt_ = 0;                     // last step
  struct Accepted {
    std::vector<double> strain;  // per flux face of the mesh
    std::vector<double> stress;  // strain times B [Pa], see stress_of()
  } accepted_;
};

}  // namespace couplet::solid
