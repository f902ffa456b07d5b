// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "common/linalg/acceleration.hpp"
#include "fluid_solver/motion/step_work.hpp"
#include "fluid_solver/pressure/absorbing.hpp"
#include "fluid_solver/pressure/compression.hpp"
#include "fluid_solver/pressure/pressure.hpp"
#include "fluid_solver/pressure/upstream_volume.hpp"
#include "fluid_solver/pressure/yielding_walls.hpp"
#include "fluid_solver/state/face_sums.hpp"

namespace couplet::fluid {

/// The second part of a fractional step: sum g (p_N - p_P) = (rho/dt) sum phi^p, p = p^{n+1/2}, in passes on oblique
/// meshes, with what walls and bodies are to it.
template <int D>
class PressureProjection {
 public:
  /// `moving`: the mesh will move.
  PressureProjection(StepWork<D>& work, bool moving);

  /// p~, the guess of the solve, and the gradient that its non-orthogonal part starts with.
  void extrapolate_pressure();
  /// What pressure waves of a compressible fluid need of the work's step; nothing without. Collective.
  void prepare_waves(const State<D>& from) {
    if (compression_) set_waves(from);
  }
  /// Of the level that becomes n+1, and of one that no step made. Collective.
  void commit_waves(State<D>& state) const {
    if (absorbing_) absorbing_->commit(state);
  }
  void start_level(const Placement<D>& at, PressureLevel<D>& level) const {
    set_gradient(at, level);
    if (upstream_) upstream_->start(at, level);
  }
  void start_waves(State<D>& state) const {
    if (absorbing_) absorbing_->start(state);
  }
  /// What the solves depend on beside the level they start from, as of the last accept(). load(): collective.
  void accept();
  void save(io::CheckpointWriter& file) const;
  void load(io::CheckpointReader& file);
  /// The matrix of the work's step, if that of another placement is there. Collective.
  void assemble();
  /// p and p_b for the given velocities w at t^{n+1}. Collective.
  /// `answer`: PressureEquation::solve().
  void project(const State<D>& from, const Vectors<D>& w, double answer);
  /// psi in p for the boundary fluxes of w: the potential that makes phi^p free of divergence. Collective.
  void solve_initial(const Placement<D>& at);
  /// phi^p at the boundary from w. Collective.
  void set_boundary_flux(const Vectors<D>& w);
  void set_obliqueness(const Placement<D>& at);
  /// The result of the last project() as a level of history; `correction`: made of fluxes by the way. Collective.
  std::shared_ptr<PressureLevel<D>> pressure_level(const FluxCorrection* correction = nullptr) const;
  /// Fills level.gradient from p and boundary. Collective.
  void set_gradient(const Placement<D>& at, PressureLevel<D>& level,
                    const FluxCorrection* correction = nullptr) const;
  void mark_bodies(double time);
  /// Of the work's step: which cells of gaps are blocked; the matrix that follows. Collective.
  void mark_gaps();
  void block_gaps(std::vector<double>& phi) const;
  PressureEquation<D>& equation() { return pressure_; }

 private:
  void balance_closed_domain();
  void make_waves();
  void set_waves(const State<D>& from);
  std::span<const double> storage() const;
  bool stores() const { return compression_ && compression_->active(); }
  std::array<double, 3> matrix_rule() const;
  double add_waves();
  std::vector<double> admittance() const;
  void add_oblique_pressure();
  bool mix_gradients(int pass);
  void solve_pressure(const State<D>& from, const Vectors<D>& w, double tolerance, double answer);
  void set_boundary_pressure(const State<D>& from);
  void pressure_gradient(const Placement<D>& at, const std::vector<double>& p,
                         const std::vector<double>& boundary, const FluxCorrection* correction,
                         Vectors<D>& sum) const;
  void fill_pressure_in_bodies();
  void clear_gaps(std::vector<double>& b) const;
  void part_from_gaps(const Placement<D>& at, const std::vector<double>& p, Vectors<D>& sum) const;
  void clear_bodies(std::vector<double>& values) const;
  void clear_bodies(Vectors<D>& values) const;

  StepWork<D>& k_;
  std::unique_ptr<YieldingWalls<D>> walls_;  // null: none yields
  PressureEquation<D> pressure_;
  std::vector<double> b_;
  bool assembled_yielding_ = false;
  std::unique_ptr<Compression<D>> compression_;        // null: incompressible; what follows then, too
  std::unique_ptr<AbsorbingBoundaries<D>> absorbing_;  // null: none
  std::unique_ptr<UpstreamVolume<D>> upstream_;        // null: none
  std::array<double, 3> assembled_rule_{};             // matrix_rule()
  // Very oblique meshes only.
  Vectors<D> gradient_before_;
  std::unique_ptr<linalg::Accelerator> accelerator_;
};

}  // namespace couplet::fluid
