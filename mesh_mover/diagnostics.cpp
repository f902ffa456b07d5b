// SPDX-License-Identifier: Apache-2.0
#include "mesh_mover/diagnostics.hpp"

namespace couplet::mesh_mover {
namespace {

/// How near the worst cell of the run came to being inverted.
class LeastJacobian final : public diagnostics::Diagnostic {
 public:
  explicit LeastJacobian(const Mover& mover) : mover_(mover) {}
  void look(diagnostics::Report& report) override {
    if (const auto& least = mover_.least_jacobian())
      report.position.push_back({"least scaled Jacobian", *least, 0, "mover-rotation", true});
  }

 private:
  const Mover& mover_;
};

}  // namespace

void add_diagnostics(const Mover& mover, diagnostics::Diagnostics& all) {
  all.add("least-jacobian", std::make_shared<LeastJacobian>(mover));
}

}  // namespace couplet::mesh_mover
