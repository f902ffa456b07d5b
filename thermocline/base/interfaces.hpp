// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>
#include <string>
#include <vector>

/// What the tank, the weather, the plant and the reports know of each other. Temperatures in K, time in s
/// from the start of the simulation; z grows from the tank's bottom to its top.
namespace couplet::thermocline {

/// The weather at one instant.
struct Ambient {
  double dni = 0;               ///< direct normal irradiance [W/m^2]
  double temperature = 293.15;  ///< of the air [K]
  double wind = 0;              ///< [m/s]
  double humidity = 0.5;        ///< relative [1]
  double pressure = 101325;     ///< of the air [Pa]
  double sun_height = 0;        ///< sine of the sun's height above the horizon [1]; 0 where it is not known
};

class AmbientSource {
 public:
  virtual ~AmbientSource() = default;
  virtual Ambient at(double t) const = 0;
  /// Annual mean air temperature [K], what the deep soil has.
  virtual double mean_temperature() const = 0;
};

/// What is pumped through the tank.
struct Flow {
  double mass_flow = 0;               ///< [kg/s]; > 0 upward: discharge, cold at the bottom; < 0: charge
  double inlet_temperature = 293.15;  ///< of what enters, at the bottom or at the top [K]
  int mode = 0;                       ///< a label of the control's own; comes back in BedStep
  /// The decision holds until this time at most [s]; the bed then asks again. It asks before each of its
  /// steps.
  double until = std::numeric_limits<double>::infinity();
};

/// Decides on the flow at the start of each step of the bed. A control with a memory (charging, waiting, ...)
/// hands it out and takes it back, so that a step of the simulation can be repeated.
class FlowControl {
 public:
  virtual ~FlowControl() = default;
  /// `t_top`, `t_bottom`: fluid temperature in the bed's top and bottom cell [K]; what flows out has it.
  virtual Flow decide(double t, double t_top, double t_bottom, const Ambient& ambient) = 0;
  virtual std::vector<double> state() const { return {}; }
  virtual void restore(std::span<const double>) {}
  /// At the end of a run: why what it did may not be what was meant. Sentences.
  virtual std::vector<std::string> doubts() const { return {}; }
};

/// One step of the bed, from t to t + dt.
struct BedStep {
  double t = 0, dt = 0;           ///< [s]
  Flow flow;                      ///< as decided at t
  Ambient ambient;                ///< at t
  double outlet_temperature = 0;  ///< mean of what left during the step [K]; the inlet's at rest
  double pressure_loss = 0;       ///< across the bed [Pa]; 0 where nobody asked for it
  double pump_power = 0;          ///< [W]
};

/// One accepted step of the simulation: the steps of the bed in it, and where things stand at its end.
/// Profiles are views into the tank, bottom to top, valid during the call; what was not asked for is empty.
struct TankRecord {
  double time = 0;  ///< end of the step [s]
  double dt = 0;    ///< [s]
  std::span<const BedStep> steps;
  // The bed, one value a cell.
  std::span<const double> z, dz;               ///< centres and heights [m]
  std::span<const double> fluid_temperature;   ///< [K]
  std::span<const double> filler_temperature;  ///< mean of the particles [K]
  // The shell, one value a ring (more than cells of the bed if the wall goes on around the ullage).
  std::span<const double> wall_z;             ///< centres [m]
  std::span<const double> wall_temperature;   ///< [K]
  std::span<const double> hoop_stress;        ///< [Pa]
  std::span<const double> equivalent_stress;  ///< von Mises [Pa]
  std::span<const double> yield_strength;     ///< at the ring's temperature [Pa]
  // Heat over the step [J].
  double stored = 0;                                     ///< gained by fluid and filler (5.25-5.27)
  double loss_side = 0, loss_roof = 0, loss_ground = 0;  ///< to the air, the sky and the deep soil
  /// Heat that warms fluid and filler from cold to hot (Q_storable of 5.28), per kelvin [J/K].
  double heat_capacity = 0;
  double losses() const { return loss_side + loss_roof + loss_ground; }
};

/// Whoever keeps a report. Sees accepted steps only.
class TankObserver {
 public:
  virtual ~TankObserver() = default;
  virtual void record(const TankRecord& record) = 0;
  /// At the end of the run.
  virtual void finish() {}
  /// After finish(): why what it wrote may not be what was meant. Sentences.
  virtual std::vector<std::string> doubts() const { return {}; }
  /// For checkpoints.
  virtual std::vector<double> state() const { return {}; }
  virtual void restore(std::span<const double>) {}
};

}  // namespace couplet::thermocline
