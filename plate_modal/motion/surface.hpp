// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <span>
#include <vector>

#include "common/coupling/participant.hpp"
#include "common/modes/modal_model.hpp"

namespace couplet::plate {

/// What one rank holds of a modal model: a range of its vertices and one of its faces with their shapes, rank
/// by rank in the order of the model, so that no value depends on the number of ranks but by the order of
/// sums.
class Share final {
 public:
  /// `whole`: on rank 0; the small parts of it (frequencies, participation) go to every rank. Collective.
  Share(MPI_Comm comm, const modes::ModalModel& whole);

  int n_modes() const { return static_cast<int>(omega_.size()); }
  const std::vector<double>& omega() const { return omega_; }
  /// Integral of rho phi dV . direction, a mode each.
  std::vector<double> participation(const Vec3& direction) const;
  double mass() const { return mass_; }

  std::size_t n_faces() const { return centres_.size(); }     ///< of this rank
  std::span<const Vec3> centres() const { return centres_; }  ///< of its faces
  std::span<const Vec3> areas() const { return areas_; }
  /// Shapes of a face: component c, mode m at [c modes + m].
  std::span<const double> face_shape(std::size_t face) const {
    const std::size_t n = 3 * omega_.size();
    return {face_shape_.data() + face * n, n};
  }

  /// Adds sum over this rank's faces of force . phi to `load` (modes); `force`: 3 a face [N].
  void add_load(std::span<const double> force, std::span<double> load) const;
  /// Rank 0's values, 3 a face of the whole surface (empty: zeros), to this rank's faces. Collective.
  std::vector<double> scatter_faces(const std::vector<double>& on_root) const;
  /// sum q_m phi_m at this rank's vertices, gathered on rank 0 (empty elsewhere); 3 a vertex. Collective.
  std::vector<double> gather_vertices(std::span<const double> q) const;
  /// Places, areas of the whole surface on rank 0; takes and gives stay empty.
  coupling::Interface describe() const { return interface_; }
  /// Sums over the ranks. Collective.
  void sum(std::span<double> values) const;
  MPI_Comm comm() const { return comm_; }

 private:
  MPI_Comm comm_;
  std::vector<double> omega_, participation_, vertex_shape_, face_shape_;
  std::vector<Vec3> centres_, areas_;
  double mass_ = 0;
  std::vector<int> face_counts_, vertex_counts_;  // entries of each rank
  coupling::Interface interface_;
};

}  // namespace couplet::plate
