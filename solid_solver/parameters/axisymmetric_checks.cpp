// SPDX-License-Identifier: Apache-2.0
// Settings incompatible with a body of revolution, reported at the key to change.
#include <algorithm>

#include "solid_solver/parameters/parameter_checks.hpp"

namespace couplet::solid {
namespace {

using Method = MethodParameters;

bool has_supported_conditions(const SolidParameters& p) {
  return p.point_loads.empty() && std::ranges::all_of(p.boundaries, [](const auto& entry) {
           return can_be_revolved(entry.second) && std::ranges::all_of(entry.second.parts, can_be_revolved);
         });
}

bool has_supported_method(const SolidParameters& p) {
  return (p.method.type == Method::Type::automatic || p.method.type == Method::Type::newton_krylov) &&
         p.method.volume_strain != Method::VolumeStrain::cells &&
         p.method.volume_strain != Method::VolumeStrain::shared &&
         (p.method.face_gradient == Method::FaceGradient::automatic ||
          p.method.face_gradient == Method::FaceGradient::symmetric) &&
         (p.method.preconditioner == Method::Preconditioner::automatic ||
          p.method.preconditioner == Method::Preconditioner::factors);
}

}  // namespace

void check_axisymmetric(config::Section& s, SolidParameters& p) {
  const auto refuse = [&](const char* key, const auto& is_wrong, const char* why) {
    s.check(
        [&p, is_wrong, why] { return is_axisymmetric(p) && is_wrong(p) ? std::string(why) : std::string(); },
        key);
  };
  refuse(
      "kinematics",
      [](const SolidParameters& q) { return q.kinematics == SolidParameters::Kinematics::finite_strain; },
      "'plane: axisymmetric' supports small strain only; model a wedge in 3-D");
  refuse(
      "boundaries", [](const SolidParameters& q) { return !has_supported_conditions(q); },
      "'plane: axisymmetric' supports 'fixed-displacement', 'traction', 'pressure', 'hydrostatic-pressure', "
      "'symmetry', 'frictionless', 'roller' and 'free', without point loads; model a wedge in 3-D for others");
  refuse(
      "solution-method", [](const SolidParameters& q) { return !has_supported_method(q); },
      "'plane: axisymmetric' is solved with 'face-gradient: symmetric', 'volume-strain: faces', 'type: "
      "newton-krylov' and 'preconditioner: factors' (or 'auto' each)");
  refuse(
      "heat", [](const SolidParameters& q) { return q.heat.has_value(); },
      "'plane: axisymmetric' does not conduct heat; give 'temperature' as an expression, or model a wedge in "
      "3-D");
  refuse(
      "interface", [](const SolidParameters& q) { return q.interface_data.has_value(); },
      "'plane: axisymmetric' does not couple; model a wedge in 3-D");
  refuse(
      "output",
      [](const SolidParameters& q) {
        return q.output.spectrum || q.output.modes > 0 || q.output.buckling > 0;
      },
      "'plane: axisymmetric' supports none of 'spectrum', 'modes' and 'buckling'; "
      "model the body in 3-D");
  s.check(
      [&p]() -> std::string {
        const bool is_orthotropic = std::ranges::any_of(
            materials_of(p), [](const SolidMaterial& m) { return m.orthotropic.has_value(); });
        return is_axisymmetric(p) && is_orthotropic
                   ? "'plane: axisymmetric' supports isotropic materials only; model a wedge in 3-D"
                   : "";
      },
      p.materials.empty() ? "material" : "materials");
}

}  // namespace couplet::solid
