// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/fv/expression.hpp"
#include "fluid_solver/boundary/face_rows.hpp"
#include "fluid_solver/boundary/inlet_profile.hpp"

namespace couplet::fluid {

/// The velocity that the keys of a condition give to the faces of a patch.
template <int D>
class GivenVelocity {
 public:
  /// Throws Error if the keys do not fit the patch. Collective.
  GivenVelocity(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const mesh::Patch& patch,
                const BoundaryParameters& parameters);

  const FaceRange& faces() const { return faces_; }
  const mesh::Patch& patch() const { return *patch_; }
  /// A wall whose velocity differs from place to place.
  bool turns() const { return turns_; }
  /// At places of the patch, in the order of its faces where a profile was made for them [m/s].
  void evaluate(double t, std::span<const Vec3> places, Vec<D>* w) const;

 private:
  FaceRange faces_;
  const mesh::Patch* patch_;
  BoundaryParameters parameters_;
  std::vector<fv::Expression> velocity_;
  fv::Expression mean_speed_;
  InletShape<D> shape_;                 // with mean_speed
  std::optional<fv::GridTable> table_;  // of the velocity
  fv::Expression turning_;              // [rad/s], with a rotation
  bool turns_ = false;
};

}  // namespace couplet::fluid
