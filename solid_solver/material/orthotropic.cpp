// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/material/orthotropic.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/error.hpp"

namespace couplet::solid {
namespace {

std::string problem_of_numbers(const std::vector<double>& values, bool positive, const char* what) {
  if (values.size() != 3) return fmt::format("{} numbers are given, but {} are needed", values.size(), what);
  if (positive && !std::ranges::all_of(values, [](double v) { return v > 0; }))
    return "all three must be positive";
  return "";
}

std::string problem_of_constants(const Orthotropic& m) {
  if (!problem_of_numbers(m.youngs_moduli, true, "").empty() || m.poissons_ratios.size() != 3 ||
      !problem_of_numbers(m.shear_moduli, true, "").empty())
    return "";  // said already
  return elastic::is_positive(matrix_of(m))
             ? ""
             : "these moduli violate positive strain energy: |nu_ij| must be below sqrt(E_i / E_j), and 1 - "
               "nu12 nu21 - nu23 nu32 - nu13 nu31 - 2 nu21 nu32 nu13 positive (nu_ji = nu_ij E_j / E_i)";
}

std::string problem_of_axis(const std::vector<config::ExpressionText>& axis) {
  return axis.empty() ? std::string() : fv::problem_of(axis, static_cast<int>(axis.size()));
}

}  // namespace

void declare(config::Section& s, Orthotropic& m) {
  s.value("youngs-moduli", m.youngs_moduli).unit("Pa").plausible(100, 2e12).required().doc("E1, E2, E3");
  s.check([&m] { return problem_of_numbers(m.youngs_moduli, true, "three (E1, E2, E3)"); }, "youngs-moduli");
  s.value("poissons-ratios", m.poissons_ratios)
      .required()
      .doc("nu12, nu23, nu13; nu12: contraction along 2 under tension along 1, nu21 = nu12 E2 / E1");
  s.check([&m] { return problem_of_numbers(m.poissons_ratios, false, "three (nu12, nu23, nu13)"); },
          "poissons-ratios");
  s.value("shear-moduli", m.shear_moduli).unit("Pa").plausible(100, 2e12).required().doc("G12, G23, G13");
  s.check([&m] { return problem_of_numbers(m.shear_moduli, true, "three (G12, G23, G13)"); }, "shear-moduli");
  s.check([&m] { return problem_of_constants(m); }, "poissons-ratios");
  s.value("first-axis", m.first_axis)
      .doc("direction of axis 1, one expression of x, y, z per component, any length; absent: x");
  s.check([&m] { return problem_of_axis(m.first_axis); }, "first-axis");
  s.value("second-axis", m.second_axis)
      .doc(
          "axis 2, of which only the part normal to axis 1 counts; absent: y; in two dimensions it follows "
          "from axis 1");
  s.check([&m] { return problem_of_axis(m.second_axis); }, "second-axis");
}

elastic::ElasticMatrix matrix_of(const Orthotropic& m) {
  elastic::OrthotropicConstants c;
  std::copy_n(m.youngs_moduli.begin(), 3, c.youngs_modulus.begin());
  std::copy_n(m.poissons_ratios.begin(), 3, c.poissons_ratio.begin());
  std::copy_n(m.shear_moduli.begin(), 3, c.shear_modulus.begin());
  return elastic::orthotropic_matrix(c);
}

MaterialAxes::MaterialAxes(const Orthotropic& m, int dimension) : dimension_(dimension) {
  if (!m.first_axis.empty())
    first_ = fv::make_expressions(m.first_axis, dimension, "material.orthotropic.first-axis");
  if (!m.second_axis.empty() && dimension == 2)
    throw Error(
        "material.orthotropic.second-axis: in two dimensions the second axis follows from the first "
        "(rotated by 90 degrees); remove it.");
  if (!m.second_axis.empty())
    second_ = fv::make_expressions(m.second_axis, dimension, "material.orthotropic.second-axis");
  for (const auto* axis : {&first_, &second_})
    for (const fv::Expression& e : *axis) is_constant_ = is_constant_ && !e.uses_space();
}

Tensor3 MaterialAxes::at(const Vec3& place) const {
  const auto value = [&](const std::vector<fv::Expression>& axis, Vec3 absent) {
    for (std::size_t a = 0; a < axis.size(); ++a) absent[Index(a)] = axis[a](place, 0);
    return absent;
  };
  const Vec3 first = value(first_, Vec3::UnitX());
  Vec3 second = dimension_ == 2 ? Vec3(-first[1], first[0], 0) : value(second_, Vec3::UnitY());
  const double length = first.norm(), size = second.norm();
  if (length > 0) second -= first * (first.dot(second) / (length * length));
  if (!(length > 0) || !(second.norm() > 1e-6 * size))
    throw Error(
        "material.orthotropic: at ({:.4g}, {:.4g}, {:.4g}) m 'first-axis' and 'second-axis' are zero or "
        "parallel; they must span a plane.",
        place[0], place[1], place[2]);
  Tensor3 axes;
  axes.col(0) = first / length;
  axes.col(1) = second.normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

}  // namespace couplet::solid
