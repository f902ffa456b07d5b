// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/coupling/interface_map.hpp"
#include "common/coupling/participant.hpp"
#include "common/fv/elasticity.hpp"
#include "common/mesh/mesh.hpp"
#include "solid_solver/boundaries.hpp"
#include "solid_solver/effect.hpp"
#include "solid_solver/parameters.hpp"

namespace couplet {

class SolidOutput;

/// Where a solid stands among the other programs.
struct SolidContext {
  std::string name = "solid";
  std::filesystem::path output_folder;  ///< empty: nothing is written
  double restart_time = std::numeric_limits<double>::quiet_NaN();
};

/// One accepted time: `dim` values a local cell or boundary face (ghosts up to date).
struct SolidState {
  double time = 0, dt = 0;  ///< dt: of the step that ended here
  int steps = 0;            ///< accepted so far
  std::vector<double> cell_u, cell_v, face_u, face_v;
  std::vector<double> offset;       ///< u_B - u_P of the traction faces at the middle of the last step
  std::vector<double> offset_rate;  ///< v_B - v_P there
};

/// Force on the solid at a constrained patch [N].
struct PatchForce {
  std::string patch;
  Vec3 force = Vec3::Zero();
};

/// Linear elasticity in the reference configuration. A dynamic step is the trapezoidal rule, thesis (2.45)
/// with its erratum, in mid-point form: with ubar at t^{n+1/2}, s = 1 + 2 beta / dt (stiffness-proportional
/// damping beta), and w = ubar + beta v(t^{n+1/2}), hence ubar = u^n + (w - u^n) / s,
///   rho V / s (4 / dt^2 + 2 alpha / dt) (w - u^n) - 2 rho V v^n / dt = sum_f sigma(w) . S_f +
///   loads(t^{n+1/2}) u^{n+1} = 2 ubar - u^n,   v^{n+1} = 4 (ubar - u^n) / dt - v^n
/// Loads enter at t^{n+1/2} only, where the interface load lives, which keeps the coupled step second order.
/// Traction faces have no inertia: at n+1 their offset from the cell is extrapolated from the middles of this
/// step and the last one, never fed back into the solution, so that they do not ring.
class Solid final : public Participant {
 public:
  /// Collective over mesh.comm.
  Solid(Mesh mesh, SolidParameters parameters, SolidContext context);
  ~Solid() override;

  Interface initialise() override;
  void begin_step(const Step& step) override;
  Exchange solve(const Exchange& in) override;
  void accept_step() override;
  void save(CheckpointWriter& file) const override;
  void load(CheckpointReader& file) override;
  void write_output(double time, int number) override;
  void write_monitors(double time) override;
  std::vector<std::string> judge_left_out_effects() override;

  const Mesh& mesh() const { return mesh_; }
  const SolidParameters& parameters() const { return parameters_; }
  const ElasticOperator& elastic() const { return elastic_; }
  const SolidState& state() const { return state_; }
  const std::vector<std::unique_ptr<SolidEffect>>& effects() const { return effects_; }
  /// Packed values of all local points at the accepted time. Collective.
  std::vector<double> point_displacement() const;
  std::vector<double> point_velocity() const;
  /// Stress of the local faces first, first + 1, ... (`count` of them) [Pa]. `points`: as
  /// point_displacement() gives them.
  std::vector<Tensor3> face_stress(Index first, Index count, std::span<const double> points) const;
  /// Stress of the local owned cells [Pa], mean of the face values by the pyramids over the faces; exact for
  /// linear displacements.
  std::vector<Tensor3> cell_stress(std::span<const double> points) const;
  /// Forces the solid gets at fixed and symmetry patches from the stress at the accepted time. Collective.
  std::vector<PatchForce> reactions(std::span<const double> points) const;
  /// All loads of the last solve: tractions, pressures, interface, body forces. Collective.
  Vec3 total_load() const;
  /// Largest norm of the displacement gradient at any face. Collective.
  double largest_gradient(std::span<const double> points) const;

 private:
  struct System;
  bool is_dynamic() const { return parameters_.analysis == SolidParameters::Analysis::dynamic; }
  void check_supports() const;
  void start_from_rest();
  System& system_for(double dt);
  void prepare_prescribed();
  void add_body_forces(double t);
  void add_interface_load(const Exchange& in);
  void finish_dynamic(const System& system);
  void finish_static();
  void set_prescribed_faces();
  void update_trial_ghosts();
  Exchange interface_values() const;
  std::vector<double> to_points(std::span<const double> cells, std::span<const double> faces,
                                std::span<const double> known) const;
  void judge_inertia();

  const Mesh mesh_;
  const SolidParameters parameters_;
  const SolidContext context_;
  SolidBoundaries boundaries_;
  ElasticOperator elastic_;
  PrescribedDisplacement prescribed_;
  std::unique_ptr<InterfaceMap> interface_;  // none: no interface patch
  Interface description_;
  std::vector<Expression> body_force_;
  std::vector<std::unique_ptr<SolidEffect>> effects_;  // those that the scene has
  std::vector<std::unique_ptr<System>> systems_;       // the two time steps used last, latest first

  SolidState state_, trial_;
  Step step_;
  // Known displacements at the end of the accepted and of the trial step, in the stress of the step, and
  // rates.
  std::vector<double> known_accepted_, known_rate_accepted_, known_, known_rate_, known_in_stress_;
  std::vector<double> face_force_;  // loads but the interface's, per boundary face of owned cells
  Vec3 body_load_ = Vec3::Zero();   // this rank's sum of body forces
  Vec3 face_load_ = Vec3::Zero();   // this rank's sum of face forces of the last solve
  std::vector<double> base_rhs_, rhs_, unknowns_;
  double largest_gradient_ = 0, inertia_over_load_ = 0;
  std::unique_ptr<SolidOutput> output_;
};

}  // namespace couplet
