// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "solid_solver/diagnostics/strain_energy.hpp"

namespace couplet::solid {

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

/// Tells a motion that holds more energy than loads and initial motion have brought in, and ends one of which nothing is
/// left. Moving supports and heat do work that is not counted: no balance then.
class EnergyBalance final : public diagnostics::Diagnostic {
 public:
  /// `strain`: looks at the same steps before it; nullptr at large strain, whose energy is that of the law.
  EnergyBalance(const SolidView& view, std::shared_ptr<StrainEnergy> strain)
      : view_(view), strain_(std::move(strain)) {}
  const EnergyAudit& audit() const { return audit_; }
  void observe(diagnostics::Report& report) override {
    if (is_time_to_look(view_)) look(report);
  }
  /// Throws Error if nothing of the answer is left.
  void look(diagnostics::Report& report) override;
  void conclude(diagnostics::Report& report) override;
  void visit(io::Archive& archive) override;

 private:
  SolidView view_;
  std::shared_ptr<StrainEnergy> strain_;
  EnergyAudit audit_;
  double largest_kinetic_ = 0, largest_strain_ = 0;  // [J]
};

}  // namespace couplet::solid
