// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/model/body_parameters.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/text.hpp"

namespace couplet::plate {
namespace {

constexpr std::array free_words{"x", "y", "z", "rotation-x", "rotation-y", "rotation-z"};

/// Declares the limits of one coordinate, whose units these are.
void declare_stop(config::Section& s, Stop& stop, const char* length, const char* stiffness) {
  const bool is_angle = std::string(length) == "rad";
  const double lowest = is_angle ? 1e-6 : 1e-9, highest = is_angle ? 100 : 1e4;
  s.value("least", stop.least)
      .unit(length, lowest, highest)
      .doc("least value, 0 or below; it counts from the position at the start");
  s.value("most", stop.most).unit(length, lowest, highest).doc("largest value, 0 or above");
  s.value("stiffness", stop.stiffness)
      .unit(stiffness)
      .any_magnitude("bodies range from a hair to a ship")
      .positive()
      .required()
      .doc("stiffness of the stop, an elastic spring beyond the limit");
  s.value("restitution", stop.restitution)
      .range(0.01, 1)
      .doc("speed after an impact over that before it, by a damper that acts during contact; 1: elastic");
  s.check([&] { return stop.least || stop.most ? "" : "a stop needs 'least', 'most' or both"; }, "stiffness");
  s.check(
      [&] {
        return stop.least && *stop.least > 0 ? "the body would start beyond it: 0 or below is needed" : "";
      },
      "least");
  s.check(
      [&] {
        return stop.most && *stop.most < 0 ? "the body would start beyond it: 0 or above is needed" : "";
      },
      "most");
}

void declare_stops(config::Section& s, std::optional<Stops>& stops) {
  s.optional_section<Stops>(
      "stops", stops,
      [](config::Section& t, Stops& v) {
        const auto along = [&](const char* name, std::optional<Stop>& stop, const char* doc) {
          t.optional_section<Stop>(
              name, stop, [](config::Section& one, Stop& of) { declare_stop(one, of, "m", "N/m"); }, doc);
        };
        along("x", v.x, "limits of the displacement of the reference point along x");
        along("y", v.y, "limits of the displacement of the reference point along y");
        along("z", v.z, "limits of the displacement of the reference point along z");
        t.optional_section<Stop>(
            "rotation", v.rotation,
            [](config::Section& one, Stop& of) { declare_stop(one, of, "rad", "N m/rad"); },
            "limits of the angle of a body that rotates about one axis only");
      },
      "elastic limits of the motion");
}

void declare_springs(config::Section& s, BodyParameters& p) {
  s.optional_section<Springs>(
      "springs", p.springs,
      [](config::Section& q, Springs& v) {
        q.value("translation", v.translation)
            .unit("N/m")
            .any_magnitude("bodies range from a hair to a ship")
            .doc("stiffnesses along x, y, z");
        q.value("rotation", v.rotation)
            .unit("N m/rad")
            .any_magnitude("bodies range from a hair to a ship")
            .not_negative()
            .doc("stiffnesses about x, y, z, or one about the only axis of rotation");
        q.value("rest-translation", v.rest_translation)
            .unit("m", 1e-9, 1e4)
            .doc("displacement from the start at which the springs are relaxed");
        q.value("rest-rotation", v.rest_rotation)
            .unit("rad", 1e-9, 100)
            .doc("rotation vector from the start, or one angle, at which the springs are relaxed");
      },
      "linear springs between the reference point and the ground, along and about fixed axes");
  s.optional_section<Dampers>(
      "dampers", p.dampers,
      [](config::Section& q, Dampers& v) {
        q.value("translation", v.translation)
            .unit("N s/m")
            .any_magnitude("bodies range from a hair to a ship")
            .doc("damping along x, y, z");
        q.value("rotation", v.rotation)
            .unit("N m s/rad")
            .any_magnitude("bodies range from a hair to a ship")
            .not_negative()
            .doc("damping about x, y, z, or about the only axis of rotation");
      },
      "linear dampers between the reference point and the ground");
}

/// Problem of a list of values about axes, or an empty text.
std::string problem_of_axes(const BodyParameters& p, const std::vector<double>& values) {
  if (values.empty() || values.size() == 3) return "";
  if (values.size() == 1)
    return p.rotations().size() == 1 ? "" : "one number needs a body with one axis of rotation; give three";
  return "one or three numbers are needed";
}

std::string problem_of_inertia(const BodyParameters& p) {
  const std::size_t axes = p.rotations().size(), n = p.inertia.size();
  if (n == 0) return axes == 0 ? "" : "a body that rotates needs it";
  if (n != 1 && n != 3 && n != 6) return "1, 3 or 6 numbers are needed";
  if (n == 1 && axes > 1) return "one number needs a body with one axis of rotation; give three or six";
  const Eigen::SelfAdjointEigenSolver<Tensor3> solver(p.inertia_tensor(), Eigen::EigenvaluesOnly);
  const Vec3 moments = solver.eigenvalues();
  if (!(moments[0] > 0)) return "the moments of inertia must be above 0";
  // The integral of rho x^2 is not negative.
  if (n > 1 && moments[2] > (moments[0] + moments[1]) * (1 + 1e-9))
    return fmt::format(
        "no body has the principal moments {:.6g}, {:.6g}, {:.6g}: the largest is at most the sum of the others",
        moments[0], moments[1], moments[2]);
  return "";
}

std::string problem_of_held(const BodyParameters& p) {
  for (const std::string& word : p.held)
    if (std::ranges::find(free_words, word) == free_words.end())
      return fmt::format("'{}' is no degree of freedom; allowed are {}", word,
                         base::join(std::vector<std::string>(free_words.begin(), free_words.end())));
  if (p.hinge && !p.held.empty())
    return "a hinge holds everything but the rotation about its axis; remove 'held'";
  if (p.rotations().size() == 2) return "hold no rotation, two of them, or all three";
  if (p.rotations().empty() && p.translations().empty()) return "no degree of freedom is left";
  return "";
}

void check_body_together(config::Section& s, const BodyParameters& p) {
  s.check([&p] { return problem_of_held(p); }, p.hinge ? "hinge" : "held");
  s.check(
      [&p] {
        if (!p.hinge) return "";
        if (!(p.hinge->axis.stableNorm() > 0)) return "its axis must not be 0";
        return p.dimension == 2 && p.hinge->axis.stableNormalized().head<2>().norm() > 1e-9
                   ? "the axis of a planar body is [0, 0, 1]"
                   : "";
      },
      "hinge");
  s.check([&p] { return problem_of_inertia(p); }, "inertia");
  s.check(
      [&p] {
        return p.hinge && !p.reference_point.empty() ? "a hinge is the reference point; remove it" : "";
      },
      "reference-point");
  s.check(
      [&p] {
        if (!p.springs) return std::string();
        if ((p.springs->translation.array() < 0).any()) return std::string("stiffnesses must not be below 0");
        const std::string problem = problem_of_axes(p, p.springs->rotation);
        return problem.empty() ? problem_of_axes(p, p.springs->rest_rotation) : problem;
      },
      "springs");
  s.check(
      [&p] {
        if (!p.dampers) return std::string();
        if ((p.dampers->translation.array() < 0).any()) return std::string("damping must not be below 0");
        return problem_of_axes(p, p.dampers->rotation);
      },
      "dampers");
  s.check(
      [&p]() -> std::string {
        if (!p.stops) return "";
        if (p.stops->rotation && p.rotations().size() != 1)
          return "a stop of the rotation needs a body with one axis of rotation";
        const std::array<const std::optional<Stop>*, 3> along{&p.stops->x, &p.stops->y, &p.stops->z};
        for (int c = 0; c < 3; ++c)
          if (*along[c] && std::ranges::none_of(p.translations(), [&](const Vec3& e) { return e[c] > 0; }))
            return fmt::format("the body does not move along {}", free_words[c]);
        return "";
      },
      "stops");
  s.check(
      [&p]() -> std::string {
        Vec3 left = p.initial_angular_velocity;
        for (const Vec3& axis : p.rotations()) left -= axis.dot(left) * axis;
        return left.norm() > 1e-9 * p.initial_angular_velocity.norm()
                   ? "the body is held against this rotation"
                   : "";
      },
      "initial-angular-velocity");
}

}  // namespace

bool BodyParameters::holds(const std::string& word) const {
  if (hinge || std::ranges::find(held, word) != held.end()) return true;
  return dimension == 2 && (word == "z" || word == "rotation-x" || word == "rotation-y");
}

Vec3 BodyParameters::reference() const {
  if (hinge) return hinge->point;
  return reference_point.empty() ? center_of_mass : Vec3(reference_point.data());
}

std::vector<Vec3> BodyParameters::translations() const {
  std::vector<Vec3> free;
  for (int c = 0; c < 3; ++c)
    if (!holds(free_words[c])) free.push_back(Vec3::Unit(c));
  return free;
}

std::vector<Vec3> BodyParameters::rotations() const {
  if (hinge) return {hinge->axis.stableNormalized()};
  std::vector<Vec3> free;
  for (int c = 0; c < 3; ++c)
    if (!holds(free_words[3 + c])) free.push_back(Vec3::Unit(c));
  return free;
}

Tensor3 BodyParameters::inertia_tensor() const {
  if (inertia.size() < 3) return (inertia.empty() ? 1 : inertia[0]) * Tensor3::Identity();
  Tensor3 tensor = Vec3(inertia.data()).asDiagonal();
  if (inertia.size() < 6) return tensor;
  tensor(0, 1) = tensor(1, 0) = inertia[3];
  tensor(0, 2) = tensor(2, 0) = inertia[4];
  tensor(1, 2) = tensor(2, 1) = inertia[5];
  return tensor;
}

std::string problem_of_velocity(const BodyParameters& body, const Vec3& velocity) {
  Vec3 left = velocity;
  for (const Vec3& direction : body.translations()) left -= direction.dot(left) * direction;
  return left.norm() > 1e-9 * velocity.norm() ? "the body is held against this translation" : "";
}

void declare(config::Section& s, BodyParameters& p) {
  s.value("dimension", p.dimension)
      .range(2, 3)
      .doc("2: a planar body, 1 m deep, which moves along x and y and rotates about z; 3");
  s.value("surface", p.surface)
      .doc(
          "patches of 'mesh' that are the surface of the body. The mesh is that of the fluid around it or of the "
          "body; without one the body has no surface and runs alone");
  s.value("mass", p.mass)
      .unit("kg")
      .any_magnitude("bodies range from a hair to a ship")
      .positive()
      .required()
      .doc("mass; of a planar body, per meter of depth");
  s.value("center-of-mass", p.center_of_mass).unit("m", 1e-9, 1e4).doc("center of mass at the start");
  s.value("inertia", p.inertia)
      .unit("kg m^2")
      .any_magnitude("bodies range from a hair to a ship")
      .doc(
          "moments of inertia about the center of mass: [Ixx, Iyy, Izz], or with the products [..., Ixy, Ixz, Iyz] "
          "(Ixy = -integral of rho x y), or one number about the only axis of rotation");
  s.value("reference-point", p.reference_point)
      .unit("m", 1e-9, 1e4)
      .size(3)
      .doc(
          "point of the body that 'held', springs, dampers, stops and body.csv refer to; default: center of mass");
  s.value("held", p.held)
      .doc("degrees of freedom that are held: x, y, z, rotation-x, rotation-y, rotation-z");
  s.optional_section<Hinge>(
      "hinge", p.hinge,
      [](config::Section& h, Hinge& v) {
        h.value("point", v.point).unit("m", 1e-9, 1e4).required().doc("point that does not move");
        h.value("axis", v.axis).doc("direction of the axis, of any length; default: z");
      },
      "the body only rotates about this axis");
  declare_springs(s, p);
  declare_stops(s, p.stops);
  s.value("initial-angular-velocity", p.initial_angular_velocity)
      .unit("rad/s", 1e-9, 1e6)
      .doc("initial angular velocity about fixed axes");
  check_body_together(s, p);
}

}  // namespace couplet::plate
