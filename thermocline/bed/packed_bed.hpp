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

/// Fluid and filler of the tank (5.7, 5.8), one-dimensional in z. One step of the fluid:
///   rho eps c dT/dt = d/dz(k_eff dT/dz) - G c dT/dz - h_v (T - T_surface) + source
/// advection explicit (or implicit on demand), conduction and exchange implicit: the grains are eliminated
/// cell by cell, what remains is tridiagonal. Coefficients are those at the start of a block of steps
/// (prepare()).
class PackedBed {
  /// I - tau L with L conduction and exchange (and advection if implicit): matrix and grain factors.
  struct Operator {
    Operator(int name) : number(name) {}
    int number;                // 1 the scheme's own, 2 the fallback's
    double tau = 0;            // [s]
    std::vector<double> rate;  // eps rho c dz/tau [W/(m^2 K)]
    // With g = exchange(film) and sum_j weight_j theta_j of the grains as they were: theta_0 = share sum +
    // beta T, and the fluid gets heat sum from them.
    std::vector<double> share, beta, heat;  // 1/(own + g), g/(own + g), g dz/(own + g)
    std::vector<double> own_part;           // what the grains add to the diagonal; where layers melt only
    std::vector<GrainElimination> grains;
    Tridiagonal matrix;
  };

 public:
  /// Constants of a run, shared by all copies of the bed.
  struct Constants {
    Constants(const BedParameters& parameters, const Fluid& fluid, const Filler& filler, double diameter);
    BedGrid grid;
    Fluid fluid;
    double area;
    int shells;
    Advection advection;
    double courant;
    bool conducting_inlet;
    // One per run of cells.
    std::vector<LayerClosure> closures;
    std::vector<Grains> grains;
    std::vector<std::optional<PhaseChange>> melting;  // empty if no layer melts
    std::vector<double> capacity;  // eps rho c dz of the cells with the fluid's constant density [J/(m^2 K)]
    double heat_capacity = 0;      // [J/K]
    double limit = std::numeric_limits<double>::infinity();  // smallest eps rho dz [kg/m^2]
  };
  /// Coefficients and matrices of the steps that follow prepare().
  struct Prepared {
    double dt = 0, mass_flow = 0;                  // [s], [kg/s]
    std::vector<double> film, conductivity, wall;  // of each cell
    Operator main{1}, fallback{2};
    bool fallback_is_built = false;
  };
  PackedBed(const BedParameters& parameters, const Fluid& fluid, const Filler& filler, double diameter);

  const BedGrid& grid() const { return c_->grid; }
  double area() const { return c_->area; }
  int shells() const { return c_->shells; }

  /// Largest step that the scheme takes at this flow [s]; infinity at rest or implicit.
  double largest_step(double mass_flow) const;
  /// Steps of this length follow; film, conductivity and factorization are made for this flow.
  void prepare(double dt, double mass_flow);
  const Prepared& prepared() const { return prepared_; }
  /// Heat given to the fluid of each cell by walls, ullage and ground during the following steps [W].
  void set_source(std::span<const double> source);

  struct StepHeat {
    double outlet = 0;     ///< mean temperature of what left [K]; the inlet's at rest
    double by_flow = 0;    ///< enthalpy that entered less what left, and conduction through the inlet [J]
    double by_source = 0;  ///< [J]
  };
  /// One step of the prepared length. mass_flow > 0: upward.
  StepHeat step(double mass_flow, double inlet_temperature);

  /// Heat above a uniform temperature [J].
  double energy(double reference) const;
  double heat_capacity() const { return c_->heat_capacity; }  ///< [J/K]; with the fluid's constant density
  /// Heat from one temperature to another, of fluid and filler [J].
  double heat_between(double cold, double hot) const;
  /// With a density that follows the temperature: closes the steps since prepare(), during which each cell
  /// kept the capacity it had at their begin. Its temperature becomes the one that belongs to the heat it
  /// got, hence no heat is lost. Steps between should be short against the passage of the front.
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
  /// Fluid-wall coefficients of the prepared flow [W/(m^2 K)].
  std::span<const double> wall_coefficient() const { return prepared_.wall; }
  const LayerClosure& closure(std::size_t run) const { return c_->closures[run]; }

  /// Mixes fluid where it is colder than the fluid below it; keeps its heat.
  void mix_inversions();
  bool melts() const { return !c_->melting.empty(); }
  /// Steps of the tvd scheme that were taken again at first order in time to stay within bounds; of a bed
  /// that melts, those whose iteration was cut short.
  long fallbacks() const { return fallbacks_; }
  long steps() const { return steps_; }

  /// Fluid and shells, and the step, the flow and the wall coefficients of the last steps.
  template <class Numbers>
  void visit(Numbers& numbers) {
    visit_values(numbers, fluid_, shell_, prepared_.wall);
    numbers(prepared_.dt, prepared_.mass_flow, steps_, fallbacks_);
  }
  /// Makes everything that follows from a state that was loaded.
  void resume();
  void set_temperature(std::span<const double> temperature);

 private:
  struct Stage {
    double outlet = 0,
           conducted = 0;  // temperature of what leaves; conduction through the inlet face [W/m^2]
  };
  void build(Operator& op, double tau);
  /// Solves (I - tau L) x = (fluid, shells) + tau extra. `to_shells` may be `shells`. `sums_are_known`: work_.sums
  /// are those of `shells` with this operator, as the last step left them.
  void solve(const Operator& op, double* fluid, const double* shells, double* to_shells, const double* extra,
             bool sums_are_known);
  GrainCells cells_of(const Operator& op, const BedGrid::Run& run) const;
  /// Solves the step of a bed with layers that melt, in place.
  void solve_with_melting(const Operator& op, const double* extra);
  void linearise_melting(const BedGrid::Run& run, const PhaseChange& phase);
  void eliminate_melting(const Operator& op, const BedGrid::Run& run, const Grains& grains,
                         const double* extra);
  double settle_melting(const BedGrid::Run& run, const PhaseChange& phase);
  /// Vectors that a step overwrites before it reads them, except `sums`.
  struct Work {
    std::vector<double> extra, face, fluid1, fluid2, shell1, shell2;
    std::vector<double> sums;                                // of the shells, as the last step left them
    int sums_of = 0;                                         // the operator that `sums` belong to; 0: to none
    std::vector<double> lower, diagonal, upper, resistance;  // of a matrix being built
    struct Melting {
      std::vector<double> capacity, right, alpha, beta, diagonal;  // shells times cells; the last: cells
      Tridiagonal matrix;
    } melt;  // empty if no layer melts
  };
  /// Advection and sources [W/m^2] of the fluid temperatures given.
  Stage explicit_terms(const double* fluid, double flux, double inlet, bool second_order);
  StepHeat first_order_step(const Operator& op, double flux, double inlet, bool second_order);
  bool second_order_step(double flux, double inlet, StepHeat& heat);
  double inlet_conductance(bool upward) const;
  void follow_density();

  std::shared_ptr<const Constants> c_;
  // State.
  std::vector<double> fluid_, shell_;  // [K]; all cells of a shell one after the other
  std::vector<double> settled_;        // fluid that capacity_ belongs to; with a real density only
  std::vector<double> capacity_;       // eps rho c dz [J/(m^2 K)]
  // Conditions of the following steps.
  std::vector<double> source_;  // [W/m^2]
  double source_rate_ = 0;      // largest |source|/capacity [K/s]
  Prepared prepared_;
  Work work_;
  long steps_ = 0, fallbacks_ = 0;
};

/// How much colder fluid is than the hottest fluid below it, at most [K], where [m] and when [s].
struct Inversion {
  double depth = 0, z = 0, time = 0;
};
Inversion inversion_of(const PackedBed& bed);

/// Pump or fan that drives the flow through the bed.
struct PumpParameters {
  double efficiency = 0.7;  ///< of pump or fan with its motor
};

/// Ergun 1952, on the superficial mass flux G = rho u: rho dp/dz [Pa kg/m^4]
///   150 mu G (1 - eps)^2/(eps^3 d^2) + 1.75 G^2 (1 - eps)/(eps^3 d)
double ergun(const BedLayer& layer, double viscosity, double flux);

struct PressureLoss {
  double inlet = 0, outlet = 0;  ///< absolute for a gas; of a liquid above the outlet [Pa]
  double loss() const { return inlet - outlet; }
};
/// Across the bed at fluid temperatures `temperature`, a value a cell [K]. For an ideal gas, whose pressure
/// is that of the fluid where it leaves, p dp/dz = R T (...) is integrated exactly in each cell:
///   p_in^2 = p_out^2 + 2 R T dz (...)
PressureLoss pressure_loss(const BedGrid& grid, const Fluid& fluid, std::span<const double> temperature,
                           double mass_flow, double area);

/// Power that the pump (at the bed's cold end) takes [W]: m dp/(rho eta) for a liquid, isentropic compression
/// m c T ((p_in/p_out)^(R/c) - 1)/eta for a gas.
double pump_power(const PressureLoss& loss, const Fluid& fluid, double cold_end, double mass_flow,
                  double efficiency);

}  // namespace couplet::thermocline
