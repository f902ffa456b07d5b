// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "common/app/program.hpp"
#include "common/coupling/interface_map.hpp"
#include "common/coupling/mesh_motion.hpp"
#include "common/coupling/participant.hpp"
#include "common/io/series.hpp"
#include "mesh_mover/laplacian.hpp"
#include "mesh_mover/parameters.hpp"

namespace couplet::mesh_mover {

/// The mesh mover as a participant: takes "displacement" at the interface vertices and sends the displacement
/// of every point to the fluid, rank to rank. The motion depends on the given displacement alone, so there is
/// no state but the last accepted motion (a warm start).
class Mover final : public Participant {
 public:
  Mover(const Parameters& parameters, const ParticipantContext& context);

  Interface initialise() override;
  void begin_step(const Step& step) override;
  Exchange solve(const Exchange& in) override;
  StepReport accept_step() override { return {.dt = step_.dt, .iterations = laplacian_.last().iterations}; }
  void save(CheckpointWriter& file) const override;
  void load(CheckpointReader& file) override;
  void write_output(double, int) override {}
  void write_monitors(double time) override;

  const Mesh& mesh() const { return mesh_; }
  /// dim values per local point, of the last solve [m].
  const std::vector<double>& displacement() const { return displacement_; }

 private:
  void refuse_bad_cells(const Geometry& moved);

  std::string name_;
  Mesh mesh_;
  double smallest_volume_ratio_;
  Laplacian laplacian_;
  InterfaceMap interface_;
  std::unique_ptr<MeshMotionSink> sink_;
  Step step_;
  std::vector<double> displacement_;
  double least_volume_ratio_ = 1;
  std::unique_ptr<Series> quality_;
};

}  // namespace couplet::mesh_mover
