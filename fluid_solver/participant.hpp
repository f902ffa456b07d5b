// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/coupling/interface_map.hpp"
#include "common/coupling/mesh_motion.hpp"
#include "common/coupling/participant.hpp"
#include "fluid_solver/diagnostics/view.hpp"
#include "fluid_solver/output/output.hpp"
#include "fluid_solver/step/fluid.hpp"

namespace couplet::fluid {

/// Creates the link to a mesh mover once the mesh is in its final position. Empty for a mesh at rest.
using MotionLink = std::function<std::unique_ptr<coupling::MeshMotionSource>(const mesh::Mesh&,
                                                                             std::span<const Vec3> points)>;

/// Interface of the fluid to a coupling. It takes "velocity" (and "displacement", which the mesh mover uses)
/// at the interface vertices. It gives "pressure-force" and "viscous-force", the forces on the structure, at
/// the interface faces. At conjugate faces it takes a film, "film-coefficient" [W/(m^2 K)] and "ambient-temperature" [K] at
/// t^{n+1}, and gives "heat", the mean of what leaves the fluid [W].
///
///   scheme              what solve() does
///   semi-implicit       every call solves a pressure equation; the first does the rest of the step before
///   implicit, explicit  every call moves the mesh and starts from level n
///   standalone          interfaces are walls at rest; bodies move as the case prescribes, in every scheme
///
/// If a later pass of the semi-implicit scheme changes friction noticeably (see unseen_share()), that pass
/// repeats the first part on the mesh of the first guess. Equal input then gives equal output only between
/// such passes.
template <int D>
class FluidParticipant final : public coupling::Participant {
 public:
  FluidParticipant(mesh::LoadedMesh loaded, const FluidParameters& parameters, FluidContext context,
                   const MotionLink& link);

  coupling::Interface initialise() override;
  double suggest_dt() override;
  void begin_step(const coupling::Step& step) override;
  coupling::Exchange solve(const coupling::Exchange& in) override;
  bool renewed_prediction() const override { return renewed_now_; }
  coupling::StepReport accept_step() override;
  double change() const override;
  void save(io::CheckpointWriter& file) const override;
  void load(io::CheckpointReader& file) override;
  void write_output(double time, int number) override;
  void write_monitors(double time) override;
  std::vector<std::string> finish() override;

  /// View for diagnostics. It refers to this participant, which must outlive it. Call after initialise().
  FluidView<D> view() const {
    return {mesh_,         *fluid_,           fluid_->sizes(), step_, bool(interface_),
            bool(motion_), bool(prescribed_), displacement_};
  }
  const Fluid<D>& fluid() const { return *fluid_; }

 private:
  std::pair<Vectors<D>, Vectors<D>> wall_motion(const coupling::Exchange& in) const;
  std::vector<Vec3> body_velocities(const mesh::Patch& patch) const;
  std::vector<double> wall_load(const coupling::Exchange& in) const;
  /// True if the case moves bodies or a mesh mover moves some of its own accord.
  bool moves_bodies() const { return prescribed_ || (motion_ && !fluid_->boundary().body_patches().empty()); }
  bool yields() const { return interface_ && fluid_->boundary().yields(); }
  double wall_displacement(const coupling::Exchange& in) const;
  bool stands_still() const { return interface_ && !motion_ && step_.scheme != coupling::Scheme::standalone; }
  double answer() const;
  void prepare(const Vectors<D>& w);
  void set_up_motion();
  void set_up_interface(const mesh::Geometry& geometry);
  void log_impulse() const;
  void judge_frozen_flow() const;
  std::vector<Vec3> receive_points();
  void place_structure(const coupling::Exchange& in);
  coupling::Exchange forces() const;
  void take_film(const coupling::Exchange& in);
  void give_heat(coupling::Exchange& out) const;
  void log_sub_steps();

  const mesh::Mesh mesh_;
  std::unique_ptr<Fluid<D>> fluid_;
  std::unique_ptr<coupling::InterfaceMap> interface_;  // nullptr without an interface patch
  std::unique_ptr<coupling::InterfaceMap>
      conjugate_;                           // nullptr without a conjugate patch; else the same if both exist
  coupling::Interface description_;         // this rank's part of the interface
  mesh::Csr interface_vertices_;            // per interface face: entries of interface_->points()
  Vectors<D> interface_area_;               // per interface face, at rest [m^2]
  Vectors<D> structure_area_, trial_area_;  // of the structure at t^n and t^{n+1}, per boundary face [m^2]
  std::vector<double> cell_height_;         // of the cells at the interface faces, at rest [m]
  std::unique_ptr<coupling::MeshMotionSource> motion_;  // from a mesh mover
  std::unique_ptr<fv::PrescribedMotion> prescribed_;    // from the case
  std::optional<RunningStatistics<D>> statistics_;
  const bool loads_at_rest_;  // see FluidContext
  FluidOutput<D> output_;
  coupling::Step step_;
  std::vector<Vec3> points_;  // points of the first guess; semi-implicit only
  bool predicted_ = false;    // prediction of the current step is done
  bool renewed_now_ = false;  // the last pass repeated the prediction
  Renewal<D> renewal_;
  // Largest displacement of an interface on a mesh at rest, over the height of the cell there.
  double displacement_ = 0, trial_displacement_ = 0;
  int told_sub_steps_ = 1;  // number of sub-steps last logged
};

/// Throws Error if a step to these points moves a wall along its normal whose type keeps the fluid there at rest.
/// Collective.
template <int D>
void check_walls_at_rest(const Fluid<D>& fluid, std::span<const Vec3> points, double time, bool coupled);

/// Compares what all walls of a closed incompressible fluid have swept by these points: throws Error if they have changed its
/// volume, beyond the error of faces that stand for curved walls. Sets the walls back along their normals by that error, unless
/// a structure moves them. Collective.
template <int D>
void keep_volume(const Fluid<D>& fluid, std::vector<Vec3>& points, double time);

/// Throws Error for an incompressible fluid with a trapped volume, or with a `volume-level` that it does not
/// need. Without an outlet, walls may change the volume only if something sets the pressure level.
/// Collective.
template <int D>
void check_cavity(const Fluid<D>& fluid, coupling::Scheme scheme);

/// Area shares of the interface faces in the inflow of the given velocities [m^3/s], two values per face: at
/// t^{n+1} and t^n. They sum to the inflows. Collective.
template <int D>
std::vector<double> inflow_shares(const Fluid<D>& fluid, const std::vector<Index>& faces, double time,
                                  double dt);

/// Adds the diagnostics of a participant created by make_participant(). Call after its initialise().
void add_diagnostics(const coupling::Participant& participant, diagnostics::Diagnostics& all);

/// Creates the participant for the dimension given in the parameters.
std::unique_ptr<coupling::Participant> make_participant(mesh::LoadedMesh loaded,
                                                        const FluidParameters& parameters,
                                                        FluidContext context, const MotionLink& link);

}  // namespace couplet::fluid
