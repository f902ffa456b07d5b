// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/boundary_parameters.hpp"

#include "common/fv/expression.hpp"

namespace couplet {

void declare(config::Section& s, SolidBoundary& b, const int& dimension) {
  using Type = SolidBoundary::Type;
  const auto displacement = [&b, &dimension](config::Section& v) {
    v.value("value", b.value).required().doc("displacement, one expression of x, y, z, t a component [m]");
    v.check([&] { return problem_of(b.value, dimension); }, "value");
  };
  const auto traction = [&b, &dimension](config::Section& v) {
    v.value("value", b.value).required().doc("force per area, one expression of x, y, z, t a component [Pa]");
    v.check([&] { return problem_of(b.value, dimension); }, "value");
  };
  const auto pressure = [&b](config::Section& v) {
    v.value("value", b.pressure).required().doc("pressure that pushes into the solid, of x, y, z, t [Pa]");
    v.check([&] { return problem_of(b.pressure); }, "value");
  };
  const auto nothing = [](config::Section&) {};
  s.variant<Type>("type", b.type,
                  {{"fixed-displacement", Type::fixed_displacement, displacement},
                   {"traction", Type::traction, traction},
                   {"pressure", Type::pressure, pressure},
                   {"symmetry", Type::symmetry, nothing},
                   {"free", Type::free, nothing},
                   {"interface", Type::interface_, nothing}},
                  "what is known on the patch; 'interface' takes its load from the coupler", true);
}

}  // namespace couplet
