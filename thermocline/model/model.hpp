// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "thermocline/model/parameters.hpp"
#include "thermocline/wall/layers.hpp"
#include "thermocline/wall/mechanics.hpp"

namespace couplet::thermocline {

/// Constants of a run.
struct TankSetup {
  TankSetup(const TankParameters& parameters);
  TankParameters parameters;
  Fluid fluid;
  Filler filler;
  BedGrid grid;
  std::optional<Steel> steel;
  std::optional<Rings> rings;
  InnerPressure pressure;  ///< on the rings, of a fluid of constant density
};

/// Foundation and soil as layers of a column.
std::vector<ColumnLayer> ground_layers(const GroundParameters& parameters);

/// Heat that crossed the tank's borders since the start [J].
struct Ledger {
  double flow = 0, side = 0, roof = 0, ground = 0;  ///< flow: into the bed; the others are losses
  double bed = 0;                                   ///< all that went into the bed
  double turnover = 0;                              ///< sum of the absolute values
  double reference = 0;                             ///< temperature from which heat contents count [K]
  double start = 0, start_of_bed = 0;  ///< heat contents at the start, of the tank and of its bed
  double losses() const { return side + roof + ground; }
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(flow, side, roof, ground, bed, turnover, reference, start, start_of_bed);
  }
};

/// Steps of the bed and extremes of the fluid in a step of the simulation.
struct TankStep {
  std::vector<BedStep> bed;  ///< steps of the bed
  /// Coldest and hottest fluid after any exchange of the elements [K] and where [m], and the largest inversion.
  double coldest = std::numeric_limits<double>::infinity(), hottest = 0;
  double coldest_z = 0, hottest_z = 0;
  Inversion inversion;
};

/// The elements of a tank and how they exchange heat. Explicit: over an exchange step each element sees the
/// temperatures its neighbors had before; the lighter one computes the flux implicitly (insulation beside
/// the shell, shell beside the bed, gas between surfaces), the heavier one gets just that heat, so nothing is
/// lost between them. The bed divides the exchange step by its own limit; insulation and ground take longer
/// steps of their own and hold their fluxes meanwhile. A value: copies are snapshots.
class TankModel {
 public:
  TankModel(std::shared_ptr<const TankSetup> setup, const Weather& weather);

  /// From t to t + dt.
  TankStep advance(double t, double dt, FlowControl& control, const Weather& weather);

  const TankSetup& setup() const { return *setup_; }
  const PackedBed& bed() const { return bed_; }
  /// The wall and what the filler does to it; nullptr if the tank has no such element.
  const Shell* shell() const { return wall_ ? &wall_->shell : nullptr; }
  const FillerMechanics* mechanics() const { return wall_ && wall_->filler ? &*wall_->filler : nullptr; }
  /// With an external wall: the filler's pressure at the end of a step from the wall's radial displacement
  /// [m] at its begin, a value a ring; empty if the wall has not answered yet.
  void update_contact(std::span<const double> radial);
  /// With elements elsewhere: the heat that they take from now on [W], of each ring and of the bottom. An
  /// empty list leaves what was.
  void hold_side(std::span<const double> from_rings);
  void hold_bottom(double heat) { bottom_.in = bottom_.out = heat; }
  /// Coefficient between the lowest cell and the plate below it [W/(m^2 K)], and the longest time [s] for which a flux
  /// made from it may be held.
  double plate_coefficient() const;
  double stable_ground() const;
  const WallStress& stress() const { return wall_->stress; }  ///< of a tank with a shell
  const std::optional<Column>& ground() const { return ground_; }
  const Ledger& ledger() const { return ledger_; }
  /// Heat content of all elements at `t` above the temperature they started from [J].
  double energy(double t) const;
  /// Errors of the energy balance of the tank, and of the bed alone, since the start [J].
  double imbalance(double t) const { return energy(t) - ledger_.start - (ledger_.flow - ledger_.losses()); }
  double bed_imbalance() const { return bed_.energy(ledger_.reference) - ledger_.start_of_bed - ledger_.bed; }
  /// The whole state, for checkpoints.
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
  /// Makes everything that follows from a state that was loaded.
  void resume();

 private:
  /// A flux held until a time [s]: what it takes from inside and gives outside [W].
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

  /// The shell and the filler against it.
  struct Wall {
    Shell shell;
    std::optional<FillerMechanics> filler = {};
    std::optional<InnerPressure> pressure =
        {};  // that of now, if the fluid's density follows its temperature
    WallStress stress = {};
  };
  /// Vectors that an exchange step overwrites before it reads them.
  struct Work {
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
  std::vector<double> owed_;  // heat the shell has taken and the bed has yet to give, a value a cell [J]
  Ullage::Heat gas_heat_;     // during an exchange step
  Ledger ledger_;
  Work work_;
};

}  // namespace couplet::thermocline
