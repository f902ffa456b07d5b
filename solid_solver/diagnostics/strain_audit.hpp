// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "common/base/severity.hpp"

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

/// Energy that a dynamic run has found beside what it was given [J]; over all ranks.
struct EnergyAudit {
  double held = 0;        ///< kinetic and strain energy
  double given = 0;       ///< initial energy and work of the loads
  double scale = 0;       ///< most that was given so far
  bool is_driven = true;  ///< loads did work: the balance holds as well as their work is known
  double created() const { return scale > 0 ? (held - given) / scale : 0; }
  /// Above these, motion grows out of nothing; an undriven body has nothing that could be in error but the motion.
  static constexpr double most_created = 0.2, most_created_undriven = 0.1;
  /// Above this, nothing of the answer is left: the run ends.
  static constexpr double hopeless = 10;
  // Not a number is more than all of them.
  double limit() const { return is_driven ? most_created : most_created_undriven; }
  bool is_doubtful() const { return !(created() <= limit()); }
  /// More energy out of nothing than was brought in.
  static constexpr double useless = 1;
  base::Severity severity() const {
    return created() < useless ? base::Severity::warning : base::Severity::wrong;
  }
  bool is_hopeless() const { return !(created() <= hopeless); }
  /// What is held and what was given, with the growth in per cent.
  std::string text() const;
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(held, given, scale, is_driven);
  }
};

}  // namespace couplet::solid
