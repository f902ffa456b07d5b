// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "common/time/time_scheme.hpp"
#include "solid_solver/body/solid_body.hpp"
#include "solid_solver/body/solid_state.hpp"
#include "solid_solver/boundary/seat.hpp"

namespace couplet::solid {

/// Linear combinations of time levels per component of cells or faces. `start`: state at the start of the
/// step, which is the old level of a second stage.
class History {
 public:
  History(const SolidState& now, const SolidState& start, bool of_faces)
      : u_(of_faces ? now.face_u : now.cell_u),
        v_(of_faces ? now.face_v : now.cell_v),
        a_(of_faces ? now.face_a : now.cell_a),
        u_old_(&now == &start ? (of_faces ? now.face_u_old : now.cell_u_old)
                              : (of_faces ? start.face_u : start.cell_u)),
        v_old_(&now == &start ? (of_faces ? now.face_v_old : now.cell_v_old)
                              : (of_faces ? start.face_v : start.cell_v)) {}
  double operator()(const time::Levels& l, std::size_t i, double x = 0) const {
    double value = l.x * x + l.u * u_[i] + l.v * v_[i];
    if (!a_.empty()) value += l.a * a_[i];
    if (!u_old_.empty()) value += l.u_old * u_old_[i] + l.v_old * v_old_[i];
    return value;
  }

 private:
  std::span<const double> u_, v_, a_, u_old_, v_old_;
};

/// Response of the seat to the unknown w = x + beta v of a stage. The conserving rule uses the penetration at
/// the end of the step, other schemes that at the stage's equilibrium. `now`: start of the stage, `start`:
/// start of the step. Empty without a seat. Collective.
std::optional<Pressing> pressing_of(const SolidBody& body, const StageWork& work, const SolidState& now,
                                    const SolidState& start);

}  // namespace couplet::solid
