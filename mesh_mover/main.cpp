// SPDX-License-Identifier: Apache-2.0
#include "common/app/program.hpp"
#include "common/diagnostics/diagnostics.hpp"
#include "common/linalg/petsc.hpp"
#include "mesh_mover/mover.hpp"
#include "mesh_mover/parameters.hpp"

namespace {

/// How near the worst cell of the run came to being inverted.
class LeastJacobian final : public couplet::diagnostics::Diagnostic {
 public:
  explicit LeastJacobian(const couplet::mesh_mover::Mover& mover) : mover_(mover) {}
  void look(couplet::diagnostics::Report& report) override {
    if (const auto& least = mover_.least_jacobian())
      report.position.push_back({"least scaled Jacobian", *least, 0, "mover-rotation", true});
  }

 private:
  const couplet::mesh_mover::Mover& mover_;
};

}  // namespace

int main(int argc, char** argv) {
  couplet::mesh_mover::Parameters parameters;
  couplet::app::Program program{
      .name = "mesh_mover",
      .description =
          "moves the mesh points with the interface or as prescribed, by a Laplacian, an elastic body or "
          "rotations",
      .declare = [&](couplet::config::Section& s) { couplet::mesh_mover::declare(s, parameters); },
      .make =
          [&](const couplet::app::ParticipantContext& context) {
            return std::make_unique<couplet::mesh_mover::Mover>(parameters, context);
          },
      .diagnose =
          [](const couplet::coupling::Participant& participant, couplet::diagnostics::Diagnostics& all) {
            all.add("least-jacobian", std::make_shared<LeastJacobian>(
                                          dynamic_cast<const couplet::mesh_mover::Mover&>(participant)));
          },
      .environment = couplet::linalg::petsc_environment,
      .effects =
          [&](const couplet::effects::EffectScene&) {
            return couplet::effects::effects_of("mesh_mover", couplet::mesh_mover::effect_cards(),
                                                parameters);
          }};
  return couplet::app::run_program(argc, argv, program);
}
