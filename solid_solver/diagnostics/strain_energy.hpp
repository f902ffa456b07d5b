// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "common/base/severity.hpp"
#include "solid_solver/diagnostics/view.hpp"

namespace couplet::solid {

/// What a displacement that was found says of itself; over all ranks.
struct StrainAudit {
  /// sum_f V_f epsilon_f : C : epsilon_f / 2 [J], V_f = |S . d| / dim the volume between a face and the nodes
  /// beside it.
  double strain_energy = 0;
  /// Half of what the loads, prescribed motions and thermal strains did [J]: sum_f (C : epsilon_f) S . (u_N -
  /// u_P) / 2, which equilibrium turns into half of their products with the displacements.
  double stress_work = 0;
  /// Norm sqrt(sum V_f mu |epsilon|^2) of the difference of the strains of two face gradients over that of
  /// the one in use (mu alone: near nu = 1/2 the volume strain is nothing beside it).
  double gradient_difference = 0;
  bool compares_gradients = false;
  /// InnerVariation::missed() of the symmetric gradient in the plane, else 0.
  double inner_variation = 0;
  /// SmoothEnergy::missed() of triangles at rest, else 0.
  double smooth_difference = 0;
  /// RecoveredStrain::missed() of the symmetric gradient.
  std::optional<double> recovered_difference;
  /// Share of the stiffness, and so of the displacement, that the mesh errs by: the most of these; in space the square of the
  /// difference of the gradients where that is less, and with the other gradients that alone.
  double missed_by_mesh(int dim) const;
  /// Part of the strain energy by which it misses the work; a symmetric operator has none.
  double mismatch() const;
  /// Above these the answer is not to be trusted (docs/theory.md, "Does the answer fit itself?").
  static constexpr double most_mismatch = 0.35, most_difference = 1.0, most_variation = 0.2;
  /// From here on work and strain energy have nothing to do with each other.
  static constexpr double useless_mismatch = 1.0;
  bool is_doubtful() const;
  base::Severity severity() const {
    return mismatch() < useless_mismatch ? base::Severity::warning : base::Severity::wrong;
  }
  /// One sentence with the numbers.
  std::string text() const;
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(strain_energy, stress_work, gradient_difference, compares_gradients, inner_variation,
            smooth_difference, recovered_difference);
  }
};

/// Work against strain energy of the accepted state and, if asked for, one face gradient against another. Collective.
StrainAudit audit_strain(const SolidView& view, bool compare_gradients);

/// Tells a small strain whose stresses do another work than its strain energy says: after each step of a static run, in
/// motion now and then.
class StrainEnergy final : public diagnostics::Diagnostic {
 public:
  explicit StrainEnergy(const SolidView& view) : view_(view) {}
  void observe(diagnostics::Report& report) override;
  void look(diagnostics::Report& report) override;
  void conclude(diagnostics::Report& report) override;
  void visit(io::Archive& archive) override;
  /// Audit of the accepted state, which is made once per step. Collective.
  const StrainAudit& now(bool compare_gradients);

 private:
  SolidView view_;
  std::optional<StrainAudit> latest_;
  int steps_of_latest_ = -1;
  std::optional<StrainAudit> worst_;  // the last doubtful one; the last one if none was doubtful
};

/// In motion the energies are looked at so often between outputs, too: growth out of nothing may come, or come and go,
/// between two of them. A look costs less than a step.
bool is_time_to_look(const SolidView& view);

}  // namespace couplet::solid
