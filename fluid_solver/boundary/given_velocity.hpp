// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "common/app/program.hpp"
#include "common/fv/expression.hpp"
#include "fluid_solver/boundary/face_rows.hpp"
#include "fluid_solver/parameters/parameters.hpp"
#include "fluid_solver/state/placement.hpp"

namespace couplet::fluid {

/// Speed at the faces of an inlet relative to its mean.
template <int D>
struct InletShape {
  Vec<D> direction = Vec<D>::Zero();  ///< unit vector into the domain
  std::vector<double> speed;          ///< per face of the patch; its mean over the area is 1 to round-off
};

/// Parabolic: 4 s (1 - s) between the two ends of a line (2-D), 1 - (r/R)^2 on a disc (3-D), scaled to the
/// mean. Throws Error if the patch is no straight line or no disc. Collective.
template <int D>
InletShape<D> inlet_shape(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const mesh::Patch& patch,
                          InletProfile profile);

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

/// The velocities of a boundary from its file, in `dimension` components. Throws Error with file:line.
fv::GridTable velocity_table(const std::filesystem::path& file, fv::GridTable::Outside outside,
                             int dimension);

/// For --check: tables of boundaries that are missing or broken.
std::vector<app::ProblemOfKey> problems_of_files(const FluidParameters& parameters,
                                                 const std::filesystem::path& case_folder);

}  // namespace couplet::fluid
