// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/io/checkpoint.hpp"
#include "coupler/exchange/face_corners.hpp"
#include "coupler/mapping/links.hpp"
#include "coupler/parameters/schedule.hpp"

namespace couplet::coupler {

/// The pressure level of closed fluids. An incompressible fluid without an outlet knows its pressure up to a
/// constant lambda only, which is what holds its volume: in each pass the structure's answer is moved by lambda
/// until its wall lets through what the fluid lets in,
///   g = 2 (E - E*) / dt = 0,   load + lambda S                                                              (16)
/// with E the volume gained by the end of the step over the inflow's. E* is zero but where the flux through the wall,
/// h = sum w . S - Q, swings from step to step: E = 0 alone would let a swing go on for ever under the trapezoidal rule
/// (h^{n+1} + h^n = 0), E* = 0.15 dt/2 (h^n - h^{n-1})/2 makes it 0.61 of itself a step. A swing of less than a
/// hundred thousandth of what has flowed is left alone, so that the volume is exact wherever the motion is smooth.
/// lambda follows from g by Newton's method with dg/dlambda from the structure's answer to
/// a further pressure (once a step size, then by Broyden's updates): one solve of the structure more a pass where
/// that is linear. A fluid asks for it by giving "inflow" [m^3/s] at its faces (shares of Q at the end and at the
/// begin of the step). Several cavities have a level each, found together. All calls are collective.
class VolumeLevel {
 public:
  /// Empty if no side gives an inflow. Throws Error where the schedule does not iterate one after the other, the
  /// cavities before what their walls stand on. `group`: indices into `sides` in the order of a pass.
  VolumeLevel(MPI_Comm comm, const std::vector<Side>& sides, const Links& links, const Schedule& schedule,
              const std::vector<std::size_t>& group);
  bool empty() const { return cavities_.empty(); }
  /// Who takes the loads of the cavities, in the order of a pass.
  const std::vector<std::size_t>& structures() const { return structures_; }

  void start_step(double dt);
  /// After participant `i` has answered: its load, if it is a cavity, gets the level. `taken`: what it answered to.
  void loaded(std::size_t i, const coupling::Exchange& taken, coupling::Exchange& given);
  /// After the last structure's answer: finds the levels. `answer` asks all structures again with what is in
  /// `known`. Throws SolveFailure if no pressure holds a volume.
  void find(std::vector<coupling::Exchange>& known, const std::function<void()>& answer);
  void accept(const std::vector<coupling::Exchange>& given);

  void save(io::CheckpointWriter& file, const std::vector<Side>& sides) const;
  void load(io::CheckpointReader& file, const std::vector<Side>& sides);
  /// For volume.csv.
  std::vector<std::string> columns() const;
  std::vector<double> row() const;

 private:
  struct Cavity {
    std::size_t side;
    std::string name;
    CavityWall wall;
    double level = 0, accepted_level = 0;  // [Pa]
    double change = 0, inflow = 0;         // of the volume since the start [m^3]
    std::array<double, 2> swing{};         // h at t^n and t^{n-1} [m^3/s]
    double flow = 0;              // the largest of the last steps through its wall and openings [m^3/s]
    double allowed = 0;           // E* of the step under way [m^3]
    bool begun = false;           // a step has been accepted
    std::vector<double> place{};  // displacement of its vertices at t^n
    std::vector<double> load{};   // without the level, of this pass [N]
    std::vector<Vec3> areas{};    // that the level acts on in this pass
  };
  struct Defect {
    Eigen::VectorXd value, size;
  };
  /// Of one cavity's wall and openings, where all have given what they gave; over all ranks.
  struct Flow {
    double mismatch, size;  ///< h; all that flows [m^3/s]
    double end, begin;      ///< Q [m^3/s]
    double swept;           ///< since t^n [m^3]
  };
  Flow flow(const Cavity& cavity, const std::vector<coupling::Exchange>& known) const;
  Defect defect(const std::vector<coupling::Exchange>& known) const;
  Defect answer_to(std::vector<coupling::Exchange>& known, const std::function<void()>& answer);
  void put(const Cavity& cavity, coupling::Exchange& given) const;
  void probe(std::vector<coupling::Exchange>& known, const std::function<void()>& answer,
             const Eigen::VectorXd& now);
  double pressure(const Cavity& cavity, const std::vector<double>& load) const;
  Eigen::VectorXd step_to(const Eigen::VectorXd& g) const;
  std::array<double, 2> inflow(const Cavity& cavity, const std::vector<coupling::Exchange>& known) const;

  MPI_Comm comm_;
  const Links* links_;
  int dim_ = 3;
  std::vector<Cavity> cavities_;
  std::vector<std::size_t> structures_;
  double dt_ = 0, slope_dt_ = 0;
  Eigen::MatrixXd slope_;  // dg/dlambda [m^3/(s Pa)], of steps of slope_dt_
};

}  // namespace couplet::coupler
