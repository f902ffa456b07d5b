// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/diagnostics/reference.hpp"
#include "solid_solver/diagnostics/strain_energy.hpp"
#include "solid_solver/diagnostics/view.hpp"

namespace couplet::solid {

/// Checks the stability of the equilibria of a static run at large strain. The smallest x . K x of the
/// tangent K over that of the undeformed body is 1 without load, zero at the loss of stability and negative
/// beyond. Reports the load of the first loss. With arc length, reports the limit points passed and whether
/// the last equilibrium is stable.
class Stability final : public diagnostics::Diagnostic {
 public:
  /// `searches`: at each step, else only at the last one.
  Stability(const SolidView& view, bool searches) : view_(view), searches_(searches) {}
  void observe(diagnostics::Report& report) override;
  void conclude(diagnostics::Report& report) override;
  void visit(io::Archive& archive) override;

 private:
  void see_limits(const LoadPath& path);

  SolidView view_;
  bool searches_;
  double time_ = 0, stiffness_ = 1;  // of the last stable equilibrium
  Vec3 load_ = Vec3::Zero();
  bool is_lost_ = false;
  std::size_t limits_told_ = 0;
};

/// Energy of a dynamic run compared with the energy supplied to it [J]; over all ranks.
struct EnergyAudit {
  double held = 0;      ///< kinetic and strain energy
  double given = 0;     ///< initial energy and work of the loads
  double rounding = 0;  ///< of the strain energy
  diagnostics::Reference supplied{"solid: energy supplied"};
  bool is_driven = true;  ///< loads did work, which is known only approximately
  double created() const { return supplied.share(held - given, rounding); }
  /// Limits of energy growth without a cause. In an undriven body, only the motion can be in error.
  static constexpr double most_created = 0.2, most_created_undriven = 0.1;
  /// Limit above which the run ends because the result is unusable.
  static constexpr double hopeless = 10;
  // The comparisons treat NaN as exceeding every limit.
  double limit() const { return is_driven ? most_created : most_created_undriven; }
  bool is_doubtful() const { return !(created() <= limit()); }
  /// Limit at which more energy was created than supplied.
  static constexpr double useless = 1;
  base::Severity severity() const {
    return created() < useless ? base::Severity::warning : base::Severity::wrong;
  }
  bool is_hopeless() const { return !(created() <= hopeless); }
  /// Both energies, with the growth in percent.
  std::string text() const;
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(held, given, rounding, supplied, is_driven);
  }
};

/// Reports a motion with more energy than loads and initial motion supplied, and ends the run in hopeless
/// cases. Moving supports and heat do work that is not counted, so there is no balance with them.
class EnergyBalance final : public diagnostics::Diagnostic {
 public:
  /// `strain`: observed before it at the same steps; nullptr at large strain (energy of the law).
  EnergyBalance(const SolidView& view, std::shared_ptr<StrainEnergy> strain)
      : view_(view), strain_(std::move(strain)) {}
  const EnergyAudit& audit() const { return audit_; }
  void observe(diagnostics::Report& report) override;
  /// Throws Error if the result is unusable.
  void look(diagnostics::Report& report) override;
  void conclude(diagnostics::Report& report) override;
  void visit(io::Archive& archive) override;

 private:
  double strain_energy() const;
  double work_by_vertices() const;
  double rounding() const;

  SolidView view_;
  std::shared_ptr<StrainEnergy> strain_;
  EnergyAudit audit_;
  double by_changes_ = 0;                            // energy that the changes of restarts gave the body [J]
  double largest_kinetic_ = 0, largest_strain_ = 0;  // [J]
  // Of this rank: integrals over time of m v^2 and m a^2 [J s], [J/s]; see work_by_vertices() [J].
  std::vector<double> rates_ = {0, 0, 0};
};

}  // namespace couplet::solid
