// SPDX-License-Identifier: Apache-2.0
// A body of one rigid motion on a seat, for the tests of contact.
#pragma once

#include <fmt/format.h>

#include <array>
#include <utility>

#include "plate_modal/motion/oscillators.hpp"

namespace couplet::plate::test {

/// A square of 1 kg that can only rise and fall: one face of 1 m^2 looks down.
inline modes::ModalModel block() {
  modes::ModalModel model;
  model.vertices = {{0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, 0, 0}};
  model.faces.push_row(std::array<Index, 4>{0, 1, 2, 3});
  model.frequency = {0};
  for (int v = 0; v < 4; ++v) model.vertex_shape.insert(model.vertex_shape.end(), {0, 0, 1});
  model.participation = {0, 0, 1};
  model.mass = 1;
  modes::average_faces(model);
  return model;
}

/// It, on a seat `gap` below it at the start, with a speed at the start and an acceleration of gravity.
struct Bounce {
  Surface surface;
  Contact contact;
  Oscillators body;
  ModalState now, next;

  Bounce(double stiffness, double gap, double v, ContactRule rule, double gravity = 0)
      : surface(block()),
        contact(surface, parameters(stiffness, gap, rule), Vec3::UnitZ(), 0),
        body({0}, {0}, {gravity}, {time::TimeScheme::trapezoidal}, &contact),
        now(body.start({0}, {v})),
        next(now) {}
  static ContactParameters parameters(double stiffness, double gap, ContactRule rule) {
    ContactParameters p;
    p.height.text = fmt::format("{}", -gap);
    p.stiffness = stiffness;
    p.rule = rule;
    return p;
  }
  void step(double dt) {
    body.step(
        now, dt, [](double, std::span<double> load) { load[0] = 0; }, next);
    std::swap(now, next);
  }
};

}  // namespace couplet::plate::test
