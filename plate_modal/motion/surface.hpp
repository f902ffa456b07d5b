// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/coupling/participant.hpp"
#include "common/fv/expression.hpp"
#include "common/modes/modal_model.hpp"
#include "plate_modal/model/parameters.hpp"

namespace couplet::plate {

/// Modal model as loads and motion see it. Every rank stores all of it and computes the same, so that results
/// do not depend on the number of ranks. The cost is dominated by rank 0, which distributes forces.
class Surface final {
 public:
  explicit Surface(modes::ModalModel model);

  const modes::ModalModel& model() const { return model_; }
  int n_modes() const { return static_cast<int>(omega_.size()); }
  const std::vector<double>& omega() const { return omega_; }
  /// Integral of rho phi dV . direction, per mode.
  std::vector<double> participation(const Vec3& direction) const;

  std::size_t n_faces() const { return centres_.size(); }
  const std::vector<Vec3>& centres() const { return centres_; }
  const std::vector<Vec3>& areas() const { return areas_; }
  /// Shapes of a face: component c, mode m at [c modes + m].
  std::span<const double> face_shape(std::size_t face) const {
    const std::size_t n = 3 * omega_.size();
    return {model_.face_shape.data() + face * n, n};
  }

  /// Adds the sum of force . phi over the faces to `load` (modes); `force`: 3 values per face [N].
  void add_load(std::span<const double> force, std::span<double> load) const;
  /// sum q_m phi_m at the vertices, 3 each.
  std::vector<double> motion(std::span<const double> q) const;
  /// Places and areas; takes and gives remain empty.
  coupling::Interface describe() const;

 private:
  modes::ModalModel model_;
  std::vector<double> omega_;
  std::vector<Vec3> centres_, areas_;
};

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

/// A surface with these faces, whole on rank 0, as a mesh for output; other ranks write none of it.
mesh::Mesh mesh_of_surface(MPI_Comm comm, std::size_t n_vertices, const mesh::Csr& faces);

/// Pressures on the cells of a plate at t, along its normal, its weight included [Pa]. `load` may be nullptr. `fluid`: forces of a
/// partner on the faces of the surface [N], 3 each; may be empty. On rank 0. Throws Error where a pressure has no value.
std::vector<double> cell_pressures(const PlateModel& plate, const Parameters& parameters,
                                   const PressureLoad* load, std::span<const double> fluid, double t);

}  // namespace couplet::plate
