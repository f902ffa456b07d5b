// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "thermocline/model/parameters.hpp"
#include "thermocline/wall/layers.hpp"
#include "thermocline/wall/mechanics.hpp"
#include "thermocline/weather/weather.hpp"

namespace couplet::thermocline {

/// Constants of a run.
struct TankSetup {
  TankSetup(const TankParameters& parameters);
  TankParameters parameters;
  Medium fluid;
  Filler filler;
  BedGrid grid;
  std::optional<Steel> steel;
  std::optional<Rings> rings;
  InnerPressure pressure;  ///< on the rings, for a fluid of constant density
};

/// Foundation and soil as layers of a column.
std::vector<ColumnLayer> ground_layers(const GroundParameters& parameters);

/// Heat that crossed the boundaries of the tank since the start [J].
struct HeatSums {
  double flow = 0, side = 0, roof = 0, ground = 0;  ///< flow: into the bed; the others are losses
  double bed = 0;                                   ///< total into the bed
  double turnover = 0;                              ///< sum of the absolute values
  double reference = 0;                             ///< reference temperature of heat contents [K]
  double start = 0, start_of_bed = 0;               ///< initial heat contents of the tank and of its bed
  double losses() const { return side + roof + ground; }
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(flow, side, roof, ground, bed, turnover, reference, start, start_of_bed);
  }
};

/// Bed steps and extreme fluid temperatures within a simulation step.
struct TankStep {
  std::vector<BedStep> bed;  ///< steps of the bed
  /// Coldest and hottest fluid after exchanges [K], their positions [m], and the largest inversion.
  double coldest = std::numeric_limits<double>::infinity(), hottest = 0;
  double coldest_z = 0, hottest_z = 0;
  Inversion inversion;
};

/// Elements of a tank and their explicit heat exchange. Over an exchange step each element uses the previous
/// temperatures of its neighbors. The lighter one computes the flux implicitly (insulation next to shell,
/// shell next to bed, gas between surfaces), and the heavier one receives that heat, so none is lost. The bed
/// divides the exchange step by its own limit. Insulation and ground take longer steps and hold their fluxes
/// in between. This is a value type: copies are snapshots.
class TankModel {
 public:
  TankModel(std::shared_ptr<const TankSetup> setup, const Weather& weather);

  /// Advances from t to t + dt.
  TankStep advance(double t, double dt, FlowControl& control, const Weather& weather);

  const TankSetup& setup() const { return *setup_; }
  const PackedBed& bed() const { return bed_; }
  /// Wall, and the mechanics of the filler; nullptr if the tank has none.
  const Shell* shell() const { return wall_ ? &wall_->shell : nullptr; }
  const FillerMechanics* mechanics() const { return wall_ && wall_->filler ? &*wall_->filler : nullptr; }
  /// With an external wall: computes the filler's pressure at the end of a step from the wall's radial
  /// displacement [m] at its start, one value per ring; empty before the first response.
  void update_contact(std::span<const double> radial);
  /// With external elements: sets the heat they take [W], per ring and at the bottom. An empty list leaves
  /// the value unchanged.
  void hold_side(std::span<const double> from_rings);
  void hold_bottom(double heat) { bottom_.in = bottom_.out = heat; }
  /// Coefficient between the lowest cell and the plate below it [W/(m^2 K)], and the longest time [s] for
  /// which a flux based on it may be held.
  double plate_coefficient() const;
  double stable_ground() const;
  const WallStress& stress() const { return wall_->stress; }  ///< only with a shell
  const std::optional<Column>& ground() const { return ground_; }
  const HeatSums& ledger() const { return ledger_; }
  /// Heat content of all elements at `t` relative to their initial temperature [J].
  double energy(double t) const;
  /// Errors of the energy balances of the tank and of the bed since the start [J].
  double imbalance(double t) const { return energy(t) - ledger_.start - (ledger_.flow - ledger_.losses()); }
  double bed_imbalance() const { return bed_.energy(ledger_.reference) - ledger_.start_of_bed - ledger_.bed; }
  /// Complete state, for checkpoints.
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(bed_, side_, bottom_, ledger_, gas_heat_.from_liquid, gas_heat_.from_wall);
    visit_values(numbers, owed_, into_blanket_);
    if (wall_) {
      visit_values(numbers, wall_->shell.temperature());
      if (wall_->filler) numbers(*wall_->filler);
    }
    if (insulation_) visit_values(numbers, insulation_->temperature());
    if (roof_) visit_values(numbers, roof_->temperature());
    if (ground_) visit_values(numbers, ground_->temperature());
    if (ullage_) numbers(*ullage_);
  }
  /// Recomputes all derived data after loading a state.
  void resume();

 private:
  /// Flux held until a time [s]: heat taken inside and given outside [W].
  struct Held {
    double until = 0, in = 0, out = 0;
    template <class Numbers>
    void visit(Numbers& numbers) {
      numbers(until, in, out);
    }
  };
  double exchange(double t, double longest, FlowControl& control, const Weather& weather, TankStep& step);
  double stable_exchange() const;
  double cell_capacity(int cell) const;
  void step_insulation(double t, double h, const Ambient& air);
  void step_ground(double t, double h);
  void step_ullage(double h, const Ambient& air);
  void step_shell(double h);
  void step_bed(double t, double end, FlowControl& control, const Weather& weather, TankStep& step);
  void update_pressure();
  void update_stress();
  const InnerPressure& pressure() const { return wall_->pressure ? *wall_->pressure : setup_->pressure; }
  void record_fluid(double t, TankStep& step) const;
  double upper_wall() const;

  /// Shell and adjacent filler.
  struct Wall {
    Shell shell;
    std::optional<FillerMechanics> filler = {};
    /// Current one, if the fluid's density depends on temperature.
    std::optional<InnerPressure> pressure = {};
    WallStress stress = {};
  };
  /// Work vectors that an exchange step overwrites before reading.
  struct WorkArrays {
    std::vector<double> source, from_wall;  // [W]
    std::vector<double> filler;             // [K]
  };

  std::shared_ptr<const TankSetup> setup_;
  PackedBed bed_;
  std::optional<Wall> wall_;
  std::optional<Insulation> insulation_;
  std::optional<Column> roof_, ground_;
  std::optional<Ullage> ullage_;
  double deep_temperature_ = 0;  // below the ground [K]
  Held side_, bottom_;
  std::vector<double> into_blanket_;  // heat flow from each ring [W]
  std::vector<double> owed_;          // heat taken by the shell and not yet given by the bed, per cell [J]
  Ullage::UllageHeat gas_heat_;       // during an exchange step
  HeatSums ledger_;
  WorkArrays work_;
};

/// Detects initial bed temperatures with a forgotten unit: below the fluid's lowest, but within its limits if
/// read as degC. Returns a sentence or nothing.
std::string forgotten_unit_of_bed(const TankParameters& parameters);
/// Checks the temperatures of the flow likewise.
std::string forgotten_unit_of_flow(const TankParameters& parameters);

/// Warning about air and sun that nobody gave; empty if nothing needs them.
std::string missing_weather(const TankParameters& parameters);
/// Warning about a plant's restart beyond its cut-off, or nothing.
std::string restart_beyond_cut_off(const FlowParameters& flow);

/// Prices without a matching quantity, as sentences.
std::vector<std::string> prices_for_nothing(const EconomicsParameters& prices, const Inventory& inventory,
                                            bool has_pump);

/// Why the seasons of the plant's calendar have no dates; empty if they have. Constant weather has none.
std::string season_without_dates(const TankParameters& parameters);

}  // namespace couplet::thermocline
