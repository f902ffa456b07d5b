// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/fv/expression.hpp"
#include "plate_modal/model/parameters.hpp"
#include "plate_modal/motion/surface.hpp"

namespace couplet::plate {

/// Prescribed pressures on the two sides of a structure, as modal loads. A uniform pressure uses the load of
/// 1 Pa, which is computed once.
class PressureLoad final {
 public:
  /// A side consists of the faces with normals within 60 degrees of `normal` (upper) or its opposite (lower).
  /// Throws Error if a side with a pressure has no face. `name`: name of the participant, for messages.
  PressureLoad(const Surface& surface, const Load& load, const Vec3& normal, std::string name = "plate");

  const std::optional<fv::Expression>& upper() const { return upper_; }
  const std::optional<fv::Expression>& lower() const { return lower_; }
  bool changes_in_time() const;
  bool is_uniform() const;  ///< in space, so inexpensive
  /// Modal loads at t [N/sqrt(kg)]. Throws Error with key, time and place where a pressure is undefined or
  /// unrealistically large.
  void at(double t, std::span<double> load) const;

  /// Pressure of one side at a place and time [Pa]. Throws as at().
  double value(const fv::Expression& side, const Vec3& x, double t) const;
  /// Pressures at x on a face of this area that act against its normal [Pa].
  double push(const Vec3& area, const Vec3& x, double t) const;

 private:
  void add_faces(const fv::Expression& side, double sign, double t, std::span<double> load) const;

  const Surface& surface_;
  Vec3 normal_;
  std::string name_;
  std::optional<fv::Expression> upper_, lower_;
  /// On this rank's faces: upper, lower; empty if not uniform.
  std::array<std::vector<double>, 2> of_one_pascal_;
};

/// Pressures on the cells of a plate at t, along its normal, its weight included [Pa]. `load` may be nullptr. `fluid`: forces of a
/// partner on the faces of the surface [N], 3 each; may be empty. On rank 0. Throws Error where a pressure has no value.
std::vector<double> cell_pressures(const PlateModel& plate, const Parameters& parameters,
                                   const PressureLoad* load, std::span<const double> fluid, double t);

}  // namespace couplet::plate
