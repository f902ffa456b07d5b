// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/coupling/interface_map.hpp"
#include "common/coupling/participant.hpp"
#include "common/elasticity/elastic_kernel.hpp"
#include "common/elasticity/elasticity.hpp"
#include "common/mesh/mesh.hpp"
#include "common/time/time_scheme.hpp"
#include "solid_solver/boundaries.hpp"
#include "solid_solver/effect.hpp"
#include "solid_solver/energies.hpp"
#include "solid_solver/finite_strain.hpp"
#include "solid_solver/parameters.hpp"
#include "solid_solver/solution_method.hpp"
#include "solid_solver/strain_audit.hpp"
#include "solid_solver/stress.hpp"

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
  std::vector<double> cell_a;                          ///< generalised-alpha alone
  std::vector<double> cell_u_old, cell_v_old;          ///< a step earlier; three-point, Adams's predictor
  std::vector<double> face_a, face_u_old, face_v_old;  ///< the same of faces, where they have inertia
  double stage_dt = 0;                                 ///< of the last stage
  double offset_lag = 0;                               ///< `offset` lives so long before `time`
  std::vector<double> offset;       ///< u_B - u_P of the traction faces where the last stage was solved
  std::vector<double> offset_rate;  ///< v_B - v_P at the middle of the last stage
  SolidEnergies energies;           ///< if they are wanted
  double load_work = 0;             ///< of the loads since the start, dynamic runs, this rank's [J]
  double error = 0;                 ///< estimated for the last step if the step size is controlled, rms [m]
  // If the acceleration is wanted: at `time`, in cells and on faces, and its mean over the last step in
  // cells.
  std::vector<double> acceleration, face_acceleration, mean_acceleration;
};

/// What the solves of the last step took.
struct SolverEffort {
  int solves = 0, iterations = 0, inner_iterations = 0;
  double residual = 0;  ///< norm of the last solve's
};

/// Force on the solid at a constrained patch [N].
struct PatchForce {
  std::string patch;
  Vec3 force = Vec3::Zero();
};

/// Linear elasticity in the reference configuration. A dynamic step runs through the stages of its time
/// scheme (common/time). At the place of a stage x is the displacement, v = c x + v_h the velocity and
/// a = d x + a_h the acceleration, v_h and a_h being known. With Rayleigh damping (2.79), w = x + beta v and
/// s = 1 + beta c, hence x = (w - beta v_h) / s, what is solved is
///   rho V (d + alpha c) / s w - sum_f sigma(w) . S_f =
///       loads - rho V (a_h + alpha v_h - (d + alpha c) / s beta v_h).
/// The trapezoidal rule solves in the middle of the step, where the interface load lives, which keeps the
/// coupled step second order. The other schemes take the interface load of the step in all their stages.
/// Traction faces have no inertia: at n+1 their offset from the cell is extrapolated from the places of this
/// stage and the last one, never fed back into the solution, so that they do not ring.
class Solid final : public Participant {
 public:
  /// Collective over mesh.comm.
  Solid(Mesh mesh, SolidParameters parameters, SolidContext context);
  ~Solid() override;

  Interface initialise() override;
  double suggest_dt() override;
  void begin_step(const Step& step) override;
  Exchange solve(const Exchange& in) override;
  StepReport accept_step() override;
  void save(CheckpointWriter& file) const override;
  void load(CheckpointReader& file) override;
  void write_output(double time, int number) override;
  void write_monitors(double time) override;
  std::vector<EffectVerdict> audit() const override;
  std::vector<std::string> finish() override;

  const Mesh& mesh() const { return mesh_; }
  const SolidParameters& parameters() const { return parameters_; }
  const ElasticOperator& elastic() const { return elastic_; }
  const SolidState& state() const { return state_; }
  /// [kg/m^3]
  double density(Index cell) const { return materials_[mesh_.material_of(cell)].density; }
  const std::vector<std::unique_ptr<SolidEffect>>& effects() const { return effects_; }
  const SolverEffort& effort() const { return effort_; }
  /// Of the last solve at large strain.
  const std::vector<NewtonIterate>& newton() const { return finite_->iterates(); }
  /// Packed values of all local points at the accepted time. Collective.
  std::vector<double> point_displacement() const;
  std::vector<double> point_velocity() const;
  /// Needs wants_acceleration().
  std::vector<double> point_acceleration() const;
  /// Packed symmetric tensors (see stress.hpp) of all local points at the accepted time, interpolated from
  /// those in the cells and on the boundary faces. `points`: as point_displacement() gives them. Collective.
  std::vector<double> point_stress(std::span<const double> points) const;
  std::vector<double> point_strain(std::span<const double> points) const;
  /// Stress of the local faces first, first + 1, ... (`count` of them) [Pa]. `points`: as
  /// point_displacement() gives them.
  std::vector<Tensor3> face_stress(Index first, Index count, std::span<const double> points) const;
  /// Stress of the local owned cells [Pa] by cell_gradient(); exact for linear displacements.
  std::vector<Tensor3> cell_stress(std::span<const double> points) const;
  /// The same for strains, of faces and of cells.
  std::vector<Tensor3> face_strain(Index first, Index count, std::span<const double> points) const;
  std::vector<Tensor3> cell_strain(std::span<const double> points) const;
  /// Forces the solid gets at fixed and symmetry patches from the stress at the accepted time. Collective.
  std::vector<PatchForce> reactions(std::span<const double> points) const;
  /// Energies over all ranks at the accepted time; needs output.energies. Collective.
  SolidEnergies energies(std::span<const double> points) const;
  /// Work against strain energy, and, where asked for, one face gradient against another. Collective.
  StrainAudit audit_strain(std::span<const double> points, bool compare_gradients) const;
  /// The last audit of the run; none before the first.
  const std::optional<StrainAudit>& last_audit() const { return audit_; }
  const EnergyAudit& energy_audit() const { return energy_audit_; }
  /// Eigenvalues of M^-1 K [1/s^2] on rank 0, see spectrum.hpp. Collective.
  std::vector<std::complex<double>> eigenvalues() const;
  /// K of free vibrations, with a kernel that has M; none where the kernel has no mass of its own.
  std::optional<SolidProblem> vibration() const;
  /// All loads of the last solve: tractions, pressures, interface, body forces. Collective.
  Vec3 total_load() const;
  /// Largest displacement gradient, strain and rotation at any face. Collective.
  SolidEvidence deformation(std::span<const double> points) const;
  /// Largest norm of the displacement gradient at any face. Collective.
  double largest_gradient(std::span<const double> points) const;
  double share_of_yield(std::span<const double> points) const;

 private:
  struct System;
  struct StageWork;
  /// Displacements at all local cells, boundary faces and points.
  struct Placed {
    std::vector<double> cells, faces, points;
  };
  // Of large strain, finite_fields.cpp.
  SolveStatistics solve_finite(const StageWork& work);
  void linearise_accepted() const;
  std::vector<Tensor3> finite_face_stress(Index first, Index count) const;
  std::vector<Tensor3> finite_cell_stress() const;
  void add_finite_work(const StageWork& work, const SolidState& before);
  void audit_finite();
  bool is_dynamic() const { return parameters_.analysis == SolidParameters::Analysis::dynamic; }
  /// The acceleration is written or watched, so that it is kept.
  bool wants_acceleration() const;
  void finish_acceleration();
  void judge_step();
  std::vector<double> known_acceleration() const;
  void visit_gradients(std::span<const double> cells, std::span<const double> faces,
                       std::span<const double> points, const ElasticKernel::TakeGradient& take) const;
  std::vector<Tensor3> face_gradients(Index first, Index count, std::span<const double> cells,
                                      std::span<const double> faces, std::span<const double> points) const;
  double stress_work(const Placed& stressed, std::span<const double> cell_change,
                     std::span<const double> face_change, double* on_boundary) const;
  double kinetic_energy(const SolidState& state, std::span<const double> known_rate) const;
  void add_symmetric_work(const StageWork& work, const SolidState& before);
  void mean_of_ends(const StageWork& work);
  double known_work(const StageWork& work, const SolidState& before) const;
  SolidEnergies summed(SolidEnergies local) const;
  Placed place_unknowns(const StageWork& work) const;
  void add_work(const StageWork& work, const SolidState& before);
  std::vector<Tensor3> cell_gradient(std::span<const double> points) const;
  const PointTensors& point_tensors() const;
  void check_supports() const;
  void start_from_rest();
  void apply_stiffness();
  std::vector<Stage> stages_of(double dt) const;
  System& system_for(double mass_factor);
  /// Null: it has none.
  static ResidualProjection* projection_of(const System& system);
  void announce(const System& system);
  void prepare_stage(StageWork& work);
  void subtract_prescribed(StageWork& work);
  void add_body_forces(double t, std::span<double> rhs);
  std::vector<double> body_forces(double t) const;
  ElasticLoads loads_now() const;
  SolidProblem problem_of(const System& system) const;
  void find_mass();
  void add_kernel_inertia(const StageWork& work, const SolidState& now, const Levels& known);
  std::vector<double> known_inertia(const StageWork& work) const;
  void finish_faces(const StageWork& work, const SolidState& now);
  std::vector<double> interface_load(const Exchange& in) const;
  void prepare_stages();
  void take_temperature(const Exchange& in);
  void solve_stage(const StageWork& work, std::span<const double> interface_load, bool first);
  void add_inertia(const StageWork& work, const SolidState& now);
  void add_face_forces(const StageWork& work, std::span<const double> interface_load);
  void guess(const StageWork& work, const SolidState& now);
  void finish_offsets(const Stage& stage, const SolidState& now);
  void finish_cells(const StageWork& work, const SolidState& now);
  void update_trial_ghosts();
  Exchange interface_values() const;
  std::vector<double> to_points(std::span<const double> cells, std::span<const double> faces,
                                std::span<const double> known) const;
  bool is_corrected() const { return kernel_.scheme() == FaceGradientScheme::corrected; }
  bool is_thesis() const { return kernel_.scheme() == FaceGradientScheme::thesis; }
  std::vector<double> unknowns_of(std::span<const double> cells, std::span<const double> faces) const;
  std::vector<double> known_of(std::span<const double> faces, std::span<const double> points) const;
  std::vector<double> corrected_points(std::span<const double> cells, std::span<const double> faces,
                                       std::span<const double> known) const;
  void judge_inertia();
  void audit_answer();
  void judge_energy(double strain, const char* cure);
  double residual_work(std::span<const double> unknowns) const;
  void add_load_work(const StageWork& work, std::span<const double> interface_load,
                     std::span<const double> cells_before, std::span<const double> faces_before);
  void save_projections(CheckpointWriter& file) const;
  void load_projections(CheckpointReader& file);

  const Mesh mesh_;
  const SolidParameters parameters_;
  const SolidContext context_;
  const std::vector<SolidMaterial> materials_;
  SolidBoundaries boundaries_;
  ElasticOperator elastic_;
  ElasticKernel kernel_;                  // the rows of elastic_ with the face gradient that was chosen
  std::unique_ptr<FiniteStrain> finite_;  // large strain: in place of the kernel's Hooke's law; null: small
  bool has_mass_ = false;                 // the kernel has its own, and all its nodes inertia
  PrescribedDisplacement prescribed_;
  std::unique_ptr<InterfaceMap> interface_;  // none: no interface patch
  Interface description_;
  std::unique_ptr<InterfaceTemperature> interface_temperature_;  // none: not taken
  std::vector<Expression> body_force_;
  std::vector<std::unique_ptr<SolidEffect>> effects_;  // those that the scene has
  std::vector<std::unique_ptr<System>> systems_;       // those used last, latest first
  std::vector<StageWork> stages_;                      // of the step under way
  std::string method_announced_;                       // what the log said last

  SolidState state_, trial_;
  Step step_;
  SolverEffort effort_;
  // Known displacements and rates at the end of the accepted and of the trial step.
  std::vector<double> known_accepted_, known_rate_accepted_, known_, known_rate_;
  Vec3 body_load_ = Vec3::Zero();  // this rank's sum of body forces
  Vec3 face_load_ = Vec3::Zero();  // this rank's sum of face forces of the last solve
  std::vector<double> rhs_, unknowns_;
  std::vector<double> last_interface_load_;
  std::vector<double>
      load_rows_;  // of the last solve, without inertia and prescribed motion; kernels with mass
  double largest_gradient_ = 0, inertia_over_load_ = 0;
  std::optional<StrainAudit> audit_;
  EnergyAudit energy_audit_;
  bool strain_doubted_ = false, energy_doubted_ = false;
  std::unique_ptr<SolidOutput> output_;
  mutable std::unique_ptr<PointTensors> point_tensors_;  // made when first asked for
};

}  // namespace couplet
