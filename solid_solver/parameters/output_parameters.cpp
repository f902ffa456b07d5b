// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/parameters/output_parameters.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/text.hpp"

namespace couplet::solid {
namespace {

const std::vector<std::string> probe_fields{"displacement", "velocity",          "acceleration",
                                            "stress",       "equivalent-stress", "principal-stress",
                                            "strain",       "temperature"};

std::string unknown_field(const std::vector<std::string>& chosen) {
  for (const std::string& field : chosen)
    if (std::ranges::find(probe_fields, field) == probe_fields.end())
      return fmt::format("unknown field '{}'; the fields are {}", field, base::join(probe_fields));
  return chosen.empty() ? "at least one field is needed" : "";
}

const std::vector<std::string> quantity_fields{"displacement", "stress", "equivalent-stress", "temperature",
                                               "heat"};

/// Of a heat flow or a temperature.
std::string wrong_heat(const SolidQuantity& q) {
  if (!q.component.empty()) return fmt::format("a {} has no component", q.field);
  if (q.field == "temperature") return q.point.empty() ? "a temperature needs a 'point'" : "";
  return q.patch.empty() || !q.point.empty() ? "heat flows through a 'patch'; give that and no 'point'" : "";
}

std::string wrong_quantity(const SolidQuantity& q, int dimension) {
  if (std::ranges::find(quantity_fields, q.field) == quantity_fields.end())
    return fmt::format("unknown field '{}'; the fields are {}", q.field, base::join(quantity_fields));
  if (!q.patch.empty() && q.field != "heat") return "only 'field: heat' has a 'patch'";
  if (!q.point.empty() && std::ssize(q.point) != dimension)
    return fmt::format("'point' has {} numbers, one per dimension of the scene", dimension);
  if (q.field == "heat" || q.field == "temperature") return wrong_heat(q);
  const std::vector<std::string> components =
      q.field == "displacement" ? std::vector<std::string>{"x", "y", "z"}
      : q.field == "stress"     ? std::vector<std::string>{"xx", "yy", "zz", "xy", "yz", "xz"}
                                : std::vector<std::string>{""};
  if (std::ranges::find(components, q.component) == components.end())
    return q.field == "equivalent-stress"
               ? "an equivalent stress has no component"
               : fmt::format("a {} has the components {}; give one", q.field, base::join(components));
  return q.point.empty() && q.field != "equivalent-stress" ? fmt::format("a {} needs a 'point'", q.field)
                                                           : "";
}

}  // namespace

void declare(config::Section& s, SolidProbe& p) {
  s.value("fields", p.fields)
      .doc(
          "fields to record: displacement, velocity, acceleration, stress, equivalent-stress, "
          "principal-stress, strain, temperature");
  s.check([&] { return unknown_field(p.fields); }, "fields");
}

void declare(config::Section& s, SolidQuantity& q, int dimension) {
  s.value("point", q.point)
      .unit("m")
      .plausible(1e-9, 1e4)
      .doc("position in the undeformed solid; of an equivalent stress none: where it is largest");
  s.value("patch", q.patch).doc("of a heat flow: the patch through which heat enters the solid");
  s.value("field", q.field)
      .doc("displacement, stress or equivalent-stress; of 'analysis: thermal' temperature or heat");
  s.value("component", q.component).doc("x, y or z of a displacement; xx, yy, zz, xy, yz or xz of a stress");
  s.check([&q, dimension] { return wrong_quantity(q, dimension); }, "field");
}

void declare(config::Section& s, SolidOutputParameters& o) {
  s.value("deformed", o.deformed).doc("write the displaced mesh points");
  s.value("stress", o.stress).doc("write stress components and the equivalent stress");
  s.value("strain", o.strain).doc("write strain components");
  s.value("principal-stress", o.principal_stress).doc("write the principal stresses, largest first");
  s.value("point-stress", o.point_stress).doc("also write stress components at the points");
  s.value("acceleration", o.acceleration).doc("write the acceleration of a dynamic analysis");
  s.value("surfaces", o.surfaces)
      .doc(
          "patches, or [all]: surface-<patch>.xdmf with displacement, stress and traction, temperature and heat flux of a "
          "scene that has them, at each output");
  s.value("moments", o.moments)
      .doc(
          "reactions.csv also has the moment of each patch's force, of large strain that of the deformed body");
  s.value("moment-centre", o.moment_centre)
      .unit("m")
      .plausible(1e-9, 1e4)
      .doc("point about which 'moments' are taken; it rests");
  s.value("energies", o.energies).doc("write the energies after each step to energies.csv");
  s.value("large-strain-estimate", o.large_strain_estimate)
      .doc(
          "for a linear static analysis: change of the displacement that 'kinematics: finite-strain' would "
          "cause, from two more linear solves per step; reported at the end of the run");
  s.value("spectrum", o.spectrum)
      .doc(
          "write the eigenvalues of M^-1 K of a dynamic analysis to spectrum.csv at the start and report "
          "the growth rate of free vibration; for small meshes");
  s.value("modes", o.modes)
      .range(0, 1000)
      .doc(
          "number of lowest free vibrations to compute (face-gradient: symmetric): for a dynamic analysis "
          "at the start and unloaded, for a linear static one at the end, about the loaded equilibrium "
          "whose stress stiffens or softens the body; modes.csv, and in 3-D modes.h5, which plate_modal "
          "reads; 0: none");
  s.value("buckling", o.buckling)
      .range(0, 1000)
      .doc(
          "number of lowest load factors at which the equilibrium of a linear static analysis buckles "
          "(face-gradient: symmetric), computed at the end: buckling.csv and the shapes in buckling.xdmf; "
          "pressures follow the surface, other loads keep their direction; 0: none; with 'analysis: "
          "buckling' 4");
}

}  // namespace couplet::solid
