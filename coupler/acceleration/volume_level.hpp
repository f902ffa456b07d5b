// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "common/io/checkpoint.hpp"
#include "coupler/exchange/transfer.hpp"
#include "coupler/mapping/links.hpp"
#include "coupler/parameters/schedule.hpp"

namespace couplet::coupler {

/// Closed fluid whose level VolumeLevel finds.
struct Cavity {
  std::size_t side;
  std::string name;
  CavityWall wall;
  double level = 0, accepted_level = 0;  // [Pa]
  double change = 0, inflow = 0;         // of the volume since the start [m^3]
  std::array<double, 2> swing{};         // h at t^n and t^{n-1} [m^3/s]
  double flow = 0;                       // largest flow of recent steps through wall and openings [m^3/s]
  double allowed = 0;                    // E* of the current step [m^3]
  bool begun = false;                    // a step has been accepted
  std::vector<double> place{};           // displacement of its vertices at t^n
  std::vector<double> load{};            // without the level, of this pass [N]
  std::vector<Vec3> areas{};             // on which the level acts in this pass
};

/// Flow through one cavity's wall and openings, once all data have been given; over all ranks.
struct CavityFlow {
  double mismatch, size;  ///< h; total of all flows [m^3/s]
  double end, begin;      ///< Q [m^3/s]
  double swept;           ///< since t^n [m^3]
};

/// Pressure level of closed incompressible fluids. Without an outlet the pressure is known up to a constant
/// lambda, which enforces the volume. In each pass lambda shifts the structure's response until its wall
/// matches the inflow:
///   g = 2 (E - E*) / dt = 0,   load + lambda S                                                              (16)
/// E is the excess volume at the end of the step over the inflow's. E* is zero unless the flux mismatch at
/// the wall, h = sum w . S - Q, alternates between steps. E = 0 would keep such an oscillation forever with
/// the trapezoidal rule (h^{n+1} + h^n = 0); E* = 0.15 dt/2 (h^n - h^{n-1})/2 leaves 0.61 of it per step.
/// Oscillations below 1e-4 of the flow are ignored, so the volume is exact for smooth motion. lambda follows
/// by Newton's method. dg/dlambda comes from the response to an additional pressure (once per step size, then
/// Broyden updates), one more solve per pass for a linear structure. A fluid requests a level by giving
/// "inflow" [m^3/s] at its faces (shares of Q at the end and start of the step). Levels of several cavities
/// are found together. All calls are collective.
class VolumeLevel {
 public:
  /// Empty if no side gives an inflow. Throws Error unless the schedule iterates in sequence with cavities
  /// before the structures of their walls. `group`: indices into `sides` in the order of a pass.
  VolumeLevel(MPI_Comm comm, const std::vector<Side>& sides, const Links& links, const Schedule& schedule,
              const std::vector<std::size_t>& group);
  bool empty() const { return cavities_.empty(); }
  /// Participants that take the loads of the cavities, in the order of a pass.
  const std::vector<std::size_t>& structures() const { return structures_; }

  void start_step(double dt);
  /// Call after participant `i` was solved: adds the level to the load of a cavity. `taken`: its input.
  void add_level(std::size_t i, const coupling::Exchange& taken, coupling::Exchange& given);
  /// Call after the last structure was solved: finds the levels. `solve_structures` solves all again with the
  /// data in `known`. Throws SolveFailure if no pressure keeps a volume.
  void find(std::vector<coupling::Exchange>& known, const std::function<void()>& solve_structures);
  void accept(const std::vector<coupling::Exchange>& given);

  void visit(io::Archive& archive, const std::vector<Side>& sides);
  /// Data for volume.csv.
  std::vector<std::string> columns() const;
  std::vector<double> row() const;

 private:
  struct Mismatch {
    Eigen::VectorXd value, size;
  };
  CavityFlow flow(const Cavity& cavity, const std::vector<coupling::Exchange>& known) const;
  Mismatch defect(const std::vector<coupling::Exchange>& known) const;
  Mismatch response_to(std::vector<coupling::Exchange>& known, const std::function<void()>& solve_structures);
  void put(const Cavity& cavity, coupling::Exchange& given) const;
  void probe(std::vector<coupling::Exchange>& known, const std::function<void()>& solve_structures,
             const Eigen::VectorXd& now);
  double pressure(const Cavity& cavity, const std::vector<double>& load) const;
  Eigen::VectorXd step_to(const Eigen::VectorXd& g) const;
  std::array<double, 2> inflow(const Cavity& cavity, const std::vector<coupling::Exchange>& known) const;

  MPI_Comm comm_;
  const Links* links_;
  int dim_ = 3;
  bool loads_at_rest_;  // see Schedule
  std::vector<Cavity> cavities_;
  std::vector<std::size_t> structures_;
  double dt_ = 0, slope_dt_ = 0;
  Eigen::MatrixXd slope_;  // dg/dlambda [m^3/(s Pa)], of steps of slope_dt_
};

}  // namespace couplet::coupler
