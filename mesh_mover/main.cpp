// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "common/app/program.hpp"
#include "common/diagnostics/diagnostics.hpp"
#include "common/linalg/petsc.hpp"
#include "mesh_mover/mover.hpp"
#include "mesh_mover/parameters.hpp"

namespace couplet::mesh_mover {
namespace {

/// Smallest scaled Jacobian of the run.
class LeastJacobian final : public diagnostics::Diagnostic {
 public:
  explicit LeastJacobian(const Mover& mover) : mover_(mover) {}
  void look(diagnostics::Report& report) override {
    const auto& least = mover_.least_jacobian();
    if (!least) return;
    report.position.push_back({"least scaled Jacobian", *least, 0, "mover-rotation", true});
    if (*least < 0)
      report.findings.push_back(
          {.id = "distorted-mesh",
           .number = *least,
           .limit = 0,
           .sentence = fmt::format(
               "a cell of the moved mesh is folded at a corner, so that gradients there are wrong: least scaled Jacobian "
               "{:.2g} (limit 0)",
               *least),
           .advice =
               "use 'method: barrier' or a finer mesh near the moving walls; quality.csv names the cell"});
  }

 private:
  const Mover& mover_;
};

}  // namespace
}  // namespace couplet::mesh_mover

int main(int argc, char** argv) {
  using namespace couplet;
  using namespace couplet::mesh_mover;
  Parameters parameters;
  app::Program program{
      .name = "mesh_mover",
      .description =
          "moves the mesh points with the interface or as prescribed, by a Laplacian, an elastic body or rotations",
      .declare = [&](config::Section& s) { declare(s, parameters); },
      .make =
          [&](const app::ParticipantContext& context) {
            return std::make_unique<Mover>(parameters, context);
          },
      .diagnose =
          [](const coupling::Participant& participant, diagnostics::Diagnostics& all) {
            all.add("least-jacobian",
                    std::make_shared<LeastJacobian>(dynamic_cast<const Mover&>(participant)));
          },
      .environment = linalg::petsc_environment};
  return app::run_program(argc, argv, program);
}
