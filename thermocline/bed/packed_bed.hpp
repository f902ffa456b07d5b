// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "thermocline/bed/bed_parameters.hpp"
#include "thermocline/bed/closures.hpp"
#include "thermocline/bed/grains.hpp"
#include "thermocline/material/numerics.hpp"
#include "thermocline/material/properties.hpp"

namespace couplet::thermocline {

/// I - tau L with L conduction and exchange (and advection if implicit): matrix and grain factors.
struct BedOperator {
  double tau = 0;            // [s]
  std::vector<double> rate;  // eps rho c dz/tau [W/(m^2 K)]
  // With g = exchange(film) and sum = sum_j weight_j theta_j of the old grains, theta_0 = share sum + beta
  // T, and the fluid receives heat sum from them.
  std::vector<double> share, beta, heat;  // 1/(own + g), g/(own + g), g dz/(own + g)
  std::vector<GrainElimination> grains;
  Tridiagonal matrix;
};

/// Constants of a run, shared by all copies of the bed.
struct BedConstants {
  BedConstants(const BedParameters& parameters, const Medium& fluid, const Filler& filler, double diameter);
  /// Temperature at which properties of the grains are called nominal [K].
  double nominal = 0;
  BedGrid grid;
  Medium fluid;
  double area;
  int shells;
  Advection advection;
  double courant;
  bool conducting_inlet;
  // One entry per run, the adjacent cells of one layer.
  std::vector<Filler> fillers;
  std::vector<LayerClosure> closures;
  std::vector<Grains> grains;
  std::vector<std::optional<GrainHeat>> heat;  // of nonlinear layers; empty if there are none
  std::vector<double> capacity;  // eps rho c dz of the cells at the fluid's constant density [J/(m^2 K)]
  double heat_capacity = 0;      // [J/K]
  double limit = std::numeric_limits<double>::infinity();  // smallest eps rho dz [kg/m^2]
};

/// Coefficients and matrices of the steps after prepare().
struct PreparedBed {
  double dt = 0, mass_flow = 0;                  // [s], [kg/s]
  std::vector<double> film, conductivity, wall;  // per cell
  BedOperator main;
  BedOperator fallback;  // at first order, without grains until a step needs it
};

/// Rows of nonlinear layers: shells times cells, of the diagonal cells. Empty if there are none.
struct NonlinearRows {
  std::vector<double> capacity, right, alpha, beta, diagonal;
  Tridiagonal matrix;
};

/// Work vectors that a step overwrites before reading.
struct BedWork {
  std::vector<double> extra, face, fluid1, fluid2, shell1, shell2;
  std::vector<double> sums;                                // of the shells, weighted, per cell
  std::vector<double> lower, diagonal, upper, resistance;  // of a matrix during assembly
  NonlinearRows nonlinear;
};

/// Heat of one step of the bed.
struct BedHeat {
  double outlet = 0;     ///< mean temperature of the outflow [K]; that of the inlet at rest
  double by_flow = 0;    ///< enthalpy in minus out, and conduction through the inlet [J]
  double by_source = 0;  ///< [J]
};

/// Fluid and filler of the tank (5.7, 5.8), one-dimensional in z. One step of the fluid solves
///   rho eps c dT/dt = d/dz(k_eff dT/dz) - G c dT/dz - h_v (T - T_surface) + source
/// with explicit (optionally implicit) advection and implicit conduction and exchange. The grains are
/// eliminated cell by cell, leaving a tridiagonal system. Coefficients are those at the start of a block of
/// steps (prepare()).
class PackedBed {
 public:
  PackedBed(const BedParameters& parameters, const Medium& fluid, const Filler& filler, double diameter);

  const BedGrid& grid() const { return c_->grid; }
  double area() const { return c_->area; }
  int shells() const { return c_->shells; }

  /// Largest step allowed at this flow [s]; infinity at rest or if implicit.
  double largest_step(double mass_flow) const;
  /// Prepares film, conductivity and factorization for steps of this length at this flow.
  void prepare(double dt, double mass_flow);
  const PreparedBed& prepared() const { return prepared_; }
  /// Heat received by the fluid of each cell from walls, ullage and ground in the following steps [W].
  void set_source(std::span<const double> source);

  /// Performs a step of the prepared length. mass_flow > 0: upward.
  BedHeat step(double mass_flow, double inlet_temperature);

  /// Heat relative to a uniform temperature [J].
  double energy(double reference) const;
  /// [J/K]; at the fluid's constant density and the nominal properties of the grains
  double heat_capacity() const { return c_->heat_capacity; }
  /// Heat of fluid and filler between two temperatures [J].
  double heat_between(double cold, double hot) const;
  /// Completes the steps since prepare() for a temperature-dependent density. During these, each cell kept
  /// its initial capacity. Its temperature is set to match the heat it received, so no heat is lost. The
  /// interval should be short relative to the passage of the front.
  void settle();
  bool has_real_density() const { return c_->fluid.real_density; }

  std::span<const double> fluid() const { return fluid_; }
  double top() const { return fluid_.back(); }
  double bottom() const { return fluid_.front(); }
  /// Mean temperature of the grains in each cell [K].
  void filler_temperature(std::vector<double>& mean) const;
  /// Shell j of all cells, 0 at the surface [K].
  std::span<const double> shell(int j) const {
    return {shell_.data() + std::size_t(j) * c_->grid.size(), fluid_.size()};
  }
  /// Fluid-wall coefficients at the prepared flow [W/(m^2 K)].
  std::span<const double> wall_coefficient() const { return prepared_.wall; }
  const LayerClosure& closure(std::size_t run) const { return c_->closures[run]; }
  const Filler& filler(std::size_t run) const { return c_->fillers[run]; }

  /// Mixes fluid that is colder than the fluid below it; conserves heat.
  void mix_inversions();
  /// True if layers melt or their grains have properties that depend on temperature.
  bool is_nonlinear() const { return !c_->heat.empty(); }
  /// Steps of the tvd scheme repeated at first order in time to stay bounded. For a nonlinear bed, steps with
  /// an unconverged iteration.
  long fallbacks() const { return fallbacks_; }
  long steps() const { return steps_; }

  /// Fluid, shells, and step size, flow and wall coefficients of the last steps.
  template <class Numbers>
  void visit(Numbers& numbers) {
    visit_values(numbers, fluid_, shell_, prepared_.wall);
    numbers(prepared_.dt, prepared_.mass_flow, steps_, fallbacks_);
  }
  /// Recomputes all derived data after loading a state.
  void resume();
  void set_temperature(std::span<const double> temperature);

 private:
  void build(BedOperator& op, double tau);
  /// Solves (I - tau L) x = (fluid, shells) + tau extra. `to_shells` may be `shells`.
  void solve(const BedOperator& op, double* fluid, const double* shells, double* to_shells,
             const double* extra);
  GrainCells cells_of(const BedOperator& op, const BedGrid::Run& run) const;
  /// Solves a step of a bed with nonlinear layers, in place.
  void solve_nonlinear(const BedOperator& op, const double* extra);
  void linearise(const BedGrid::Run& run, const GrainHeat& content);
  void eliminate(const BedOperator& op, std::size_t run, const double* extra);
  double settle(const BedGrid::Run& run, const GrainHeat& content);
  /// Sets work_.extra to advection and sources [W/m^2] at the given fluid temperatures. Returns the
  /// temperature of the outflow.
  double explicit_terms(const double* fluid, double flux, double inlet, bool second_order);
  BedHeat first_order_step(const BedOperator& op, double flux, double inlet, bool second_order);
  bool second_order_step(double flux, double inlet, BedHeat& heat);
  double inlet_conductance(bool upward) const;
  void follow_density();

  std::shared_ptr<const BedConstants> c_;
  // State.
  std::vector<double> fluid_, shell_;  // [K]; all cells of a shell are contiguous
  std::vector<double> settled_;        // fluid temperature for capacity_; only with a real density
  std::vector<double> capacity_;       // eps rho c dz [J/(m^2 K)]
  // Conditions of the following steps.
  std::vector<double> source_;  // [W/m^2]
  double source_rate_ = 0;      // largest |source|/capacity [K/s]
  PreparedBed prepared_;
  BedWork work_;
  long steps_ = 0, fallbacks_ = 0;
};

/// Largest temperature deficit of fluid relative to hotter fluid below it [K], with place [m] and time [s].
struct Inversion {
  double depth = 0, z = 0, time = 0;
};
Inversion inversion_of(const PackedBed& bed);

/// Pump or fan of the bed.
struct PumpParameters {
  double efficiency = 0.7;  ///< including the motor
};

/// Ergun 1952, on the superficial mass flux G = rho u: rho dp/dz [Pa kg/m^4]
///   150 mu G (1 - eps)^2/(eps^3 d^2) + 1.75 G^2 (1 - eps)/(eps^3 d)
double ergun(const BedLayer& layer, double viscosity, double flux);

struct PressureLoss {
  double inlet = 0, outlet = 0;  ///< absolute for a gas; for a liquid above the outlet [Pa]
  double loss() const { return inlet - outlet; }
};
/// Pressure loss across the bed at fluid temperatures `temperature`, one per cell [K]. For an ideal gas, with
/// the fluid's pressure at the outlet, p dp/dz = R T (...) is integrated exactly in each cell:
///   p_in^2 = p_out^2 + 2 R T dz (...)
PressureLoss pressure_loss(const BedGrid& grid, const Medium& fluid, std::span<const double> temperature,
                           double mass_flow, double area);

/// Power of the pump at the cold end of the bed [W]: m dp/(rho eta) for a liquid, isentropic compression m c
/// T ((p_in/p_out)^(R/c) - 1)/eta for a gas.
double pump_power(const PressureLoss& loss, const Medium& fluid, double cold_end, double mass_flow,
                  double efficiency);

}  // namespace couplet::thermocline
