// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/conditions/keys.hpp"

namespace couplet::fluid {

void declare_velocity(config::Section& s, BoundaryParameters& b) {
  s.value("velocity", b.velocity)
      .unit("m/s")
      .plausible(1e-9, 1e4)
      .doc("one expression of x, y, z [m] and t [s] per component");
}

void declare_ramp(config::Section& s, BoundaryParameters& b) {
  s.value("ramp", b.ramp)
      .unit("s")
      .plausible(1e-12, 1e10)
      .positive()
      .doc("the velocity grows from 0 as (1 - cos(pi t/ramp))/2 until t = ramp; absent: no ramp");
}

void declare_rotation(config::Section& r, RotationParameters& rotation) {
  r.value("speed", rotation.speed)
      .unit("rad/s")
      .plausible(1e-6, 1e6)
      .required()
      .doc("expression of t [s] in rad/s; a ramp applies to it as well");
  r.value("centre", rotation.centre).unit("m").plausible(1e-9, 1e4).doc("a point on the axis");
  r.value("axis", rotation.axis).size(3).doc("3-D; a 2-D scene rotates about z");
  r.check([&rotation] { return rotation.axis.norm() > 0 ? std::string() : "'axis' must not be zero"; },
          "axis");
}

void declare_table_and_rotation(config::Section& s, BoundaryParameters& b) {
  s.optional_section<VelocityTableParameters>(
      "table", b.table,
      [](config::Section& t, VelocityTableParameters& table) {
        t.value("file", table.file)
            .required()
            .doc(
                "CSV file next to the case; its first line names the columns: some of x, y, z [m], t [s], "
                "and u, v, w [m/s]; its lines form a full grid with linear interpolation");
        t.choice("outside", table.outside,
                 {{"error", fv::GridTable::Outside::error}, {"clamp", fv::GridTable::Outside::clamp}})
            .doc("for values beyond the ends: error, or clamp (hold the end values)");
      },
      "velocity from a file, instead of 'velocity'");
  s.optional_section<RotationParameters>(
      "rotation", b.rotation, declare_rotation,
      "omega x (r - centre) added to the other velocity: a rotating inlet or wall; absent: none");
}

void declare_absorbing(config::Section& s, BoundaryParameters& b) {
  s.value("absorbing", b.absorbing)
      .doc(
          "with `compressibility`: lets pressure waves out (characteristic); what is prescribed then holds for the mean "
          "over its mean-time");
}

}  // namespace couplet::fluid
