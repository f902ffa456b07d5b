// SPDX-License-Identifier: Apache-2.0
#include "thermocline/ambient.hpp"

namespace couplet::thermocline {

void declare(config::Section& section, AmbientParameters& p) {
  using Type = AmbientParameters::Type;
  const auto constant = [&p](config::Section& s) {
    Ambient& a = p.constant;
    s.value("temperature", a.temperature).unit("K").positive().doc("of the air, and of the deep soil");
    s.value("wind", a.wind).unit("m/s").not_negative().doc("speed of the wind");
    s.value("dni", a.dni).unit("W/m^2").not_negative().doc("direct normal irradiance");
    s.value("humidity", a.humidity).range(0, 1).doc("relative humidity");
    s.value("pressure", a.pressure).unit("Pa").positive().doc("of the air");
  };
  section.variant<Type>("type", p.type, {{"constant", Type::constant, constant}},
                        "where the weather comes from");
}

std::unique_ptr<AmbientSource> make_ambient(const AmbientParameters& p, const std::filesystem::path&) {
  return std::make_unique<ConstantAmbient>(p.constant);
}

}  // namespace couplet::thermocline
