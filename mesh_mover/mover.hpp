// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/app/program.hpp"
#include "common/coupling/interface_map.hpp"
#include "common/coupling/mesh_motion.hpp"
#include "common/coupling/participant.hpp"
#include "common/io/fields/field_writer.hpp"
#include "common/io/series.hpp"
#include "common/mesh/periodic_points.hpp"
#include "mesh_mover/measures.hpp"
#include "mesh_mover/methods.hpp"
#include "mesh_mover/parameters.hpp"
#include "mesh_mover/patches.hpp"

namespace couplet::mesh_mover {

/// Mesh mover as a participant. Takes "displacement" at the interface vertices, moves other patches as the
/// case prescribes, and sends the displacement of all points to the fluid, rank to rank. In a run of its own
/// it writes the moved mesh. It has no state except the last accepted motion (a warm start).
class Mover final : public coupling::Participant {
 public:
  Mover(const Parameters& parameters, const app::ParticipantContext& context);

  coupling::Interface initialise() override;
  void begin_step(const coupling::Step& step) override;
  coupling::Exchange solve(const coupling::Exchange& in) override;
  coupling::StepReport accept_step() override;
  void save(io::CheckpointWriter& file) const override;
  void load(io::CheckpointReader& file) override;
  void write_output(double time, int number) override;
  void write_monitors(double time) override;
  std::vector<std::string> finish() override;
  /// Smallest scaled Jacobian of the run; empty before the first check.
  const std::optional<double>& least_jacobian() const { return least_jacobian_; }

  const mesh::Mesh& mesh() const { return mesh_; }
  /// Geometry of the mesh as read.
  const mesh::Geometry& geometry() const { return geometry_; }
  /// dim values per local point from the last solve [m].
  const std::vector<double>& displacement() const { return displacement_; }
  /// Quality measures of the mesh of the last solve. Collective.
  MeshState state();

 private:
  Mover(mesh::LoadedMesh loaded, const Parameters& parameters, const app::ParticipantContext& context);
  void make_method();
  void log_choice() const;
  void choose_method(const app::SimulationParameters& simulation);
  void move(const coupling::Exchange& in);
  std::string place_and_check(bool by_corners = false);
  std::vector<double> prescribed(const coupling::Exchange& in) const;
  void refuse_torn() const;
  /// Computes the geometry for displacement_, once per motion. Collective.
  void place();

  std::string name_;
  Parameters parameters_;
  const mesh::Mesh mesh_;
  const mesh::Geometry geometry_;
  mesh::PeriodicPoints periodic_;
  CellMeasures measures_;
  CurvedSlide curved_;
  MovingPatches moving_;
  std::unique_ptr<MotionMethod> method_;
  bool chooses_;        // method: auto
  bool sound_ = false;  // as read no cell is folded at a corner, so that auto lets none fold
  bool ahead_ = false;  // a prescribed motion of the run needs the barrier
  std::string reason_;  // why it uses the barrier
  std::unique_ptr<MotionMethod> laplacian_;  // kept while the barrier moves a step that is not accepted yet
  coupling::InterfaceMap interface_;
  std::unique_ptr<coupling::MeshMotionSink> sink_;
  coupling::Step step_;
  std::vector<double> displacement_, accepted_;
  bool placed_ = false;  // moved_ corresponds to displacement_
  mesh::Geometry moved_;
  std::unique_ptr<io::Series> quality_;
  MeshState quality_now_;                    // of the accepted mesh
  std::optional<double> least_jacobian_;     // of the run
  std::unique_ptr<io::FieldWriter> fields_;  // only without a fluid
};

}  // namespace couplet::mesh_mover
