// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>
#include <string>

#include "common/base/severity.hpp"
#include "common/diagnostics/error_parts.hpp"
#include "solid_solver/diagnostics/view.hpp"

namespace couplet::solid {

/// Consistency measures of a computed displacement; over all ranks.
struct StrainAudit {
  /// sum_f V_f epsilon_f : C : epsilon_f / 2 [J], V_f = |S . d|/dim the volume between a face and its nodes.
  double strain_energy = 0;
  /// Half the work of loads, prescribed motions and thermal strains [J], computed from the stress: sum_f (C :
  /// epsilon_f) S . (u_N - u_P)/2. In equilibrium it equals half of their products with the displacements.
  double stress_work = 0;
  /// Energy to which differences are relative [J]: the strain energy, or that of the strain to which heat would
  /// free the body, if larger, but no less than round-off.
  double scale = 0;
  bool looks_within_cells = false;
  /// InnerVariation::missed() of the symmetric gradient in 2-D, else 0.
  double inner_variation = 0;
  /// Error of the stiffness, and so of the displacement, due to the mesh: RecoveredStrain::missed(), scaled
  /// likewise, or the variation if that is larger. NaN if unknown.
  double missed_by_mesh = diagnostics::ErrorParts::unknown;
  /// Relative difference of strain energy and work; zero for a symmetric operator.
  double mismatch() const;
  /// Limits above which the result is doubtful (docs/theory/solid-solution.md, "Checks of the answer").
  static constexpr double most_mismatch = 0.35, most_variation = 0.2;
  /// Limit above which work and strain energy are unrelated.
  static constexpr double useless_mismatch = 1.0;
  bool is_doubtful() const;
  base::Severity severity() const {
    return mismatch() < useless_mismatch ? base::Severity::warning : base::Severity::wrong;
  }
  /// Describes the numbers in one sentence.
  std::string text() const;
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(strain_energy, stress_work, scale, looks_within_cells, inner_variation, missed_by_mesh);
  }
};

/// Audits the accepted state and, if requested, the strains within its cells. Collective.
StrainAudit audit_strain(const SolidView& view, bool within_cells);

/// StrainAudit::missed_by_mesh() of a body at large strain, by Green's strains and the moduli at rest. Collective.
double missed_at_large_strain(const SolidView& view);

/// Reports small-strain results whose stress work differs from the strain energy. Checks each step of a
/// static run, and some steps of a dynamic one.
class StrainEnergy final : public diagnostics::Diagnostic {
 public:
  explicit StrainEnergy(const SolidView& view) : view_(view) {}
  void observe(diagnostics::Report& report) override;
  void look(diagnostics::Report& report) override;
  void conclude(diagnostics::Report& report) override;
  void visit(io::Archive& archive) override;
  /// Audit of the accepted state, computed once per step. Collective.
  const StrainAudit& now(bool within_cells);

 private:
  SolidView view_;
  std::optional<StrainAudit> latest_;
  int steps_of_latest_ = -1;
  std::optional<StrainAudit> worst_;  // the last doubtful one, or the last one
};

/// True if a dynamic run should check energies between outputs, too, because spurious growth may appear and
/// vanish between two outputs. A check costs less than a step.
bool is_time_to_look(const SolidView& view);

}  // namespace couplet::solid
