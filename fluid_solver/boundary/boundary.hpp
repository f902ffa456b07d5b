// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "fluid_solver/boundary/face_rows.hpp"
#include "fluid_solver/boundary/given_velocity.hpp"
#include "fluid_solver/parameters/parameters.hpp"
#include "fluid_solver/state/placement.hpp"

namespace couplet::fluid {

/// A patch that lets pressure waves out.
struct AbsorbingPatch {
  FaceRange faces;
  bool inlet = false;  ///< given velocity; else given pressure
};

template <int D>
class Boundary {
 public:
  /// Throws Error if a patch has no boundary or a boundary names no patch.
  Boundary(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const FluidParameters& parameters);

  /// Numbers of the conditions for the loops over boundary faces.
  const FaceRows& rows() const { return rows_; }
  /// No face of the whole domain has a given pressure: the pressure level is free.
  bool closed() const { return closed_; }
  /// Names of the patches of type interface.
  const std::vector<std::string>& interface_patches() const { return interface_patches_; }
  /// Patches of type body.
  const std::vector<const mesh::Patch*>& body_patches() const { return body_patches_; }
  /// A wall whose velocity is given from outside: by the structure or by the prescribed motion.
  bool is_interface(Index boundary_face) const { return interface_[boundary_face] != 0; }

  /// Some walls of the interface have a mass that the pressure equation foresees; the mass per area of each boundary
  /// face [kg/m^2], 0: none.
  bool yields() const { return yields_; }
  const std::vector<double>& wall_mass() const { return wall_mass_; }
  /// Boundary faces whose mass may be that of two sides. None in a closed domain: two sides that move as one say nothing of
  /// the pressure's level, each by itself does.
  std::span<const Index> faces_with_two_sides() const {
    return closed_ ? std::span<const Index>{} : std::span<const Index>(two_sided_);
  }
  /// The structure says these masses (`impedance: structure`), for all its faces of the interface or some.
  bool asks_for_mass() const { return asks_for_mass_; }
  /// What it said, at boundary faces [kg/m^2]; counts where it was asked. Whether one of this rank's has changed. Throws
  /// Error if one is not above 0.
  bool set_wall_mass(std::span<const Index> boundary_faces, std::span<const double> masses);

  /// Pressure that gave walls which yield their velocity, per boundary face [Pa].
  void set_wall_load(std::vector<double> load) { wall_load_ = std::move(load); }
  const std::vector<double>& wall_load() const { return wall_load_; }

  /// w at time t [m/s] at the faces with given velocity; interface faces are left as they are.
  void velocity_at(double t, const std::vector<Vec3>& centres, Vectors<D>& w) const;
  /// Some walls may turn or stretch: the same on all ranks.
  bool walls_turn() const { return turns_; }
  /// The turn (see turn_of()) of the walls whose velocity the case gives and that differs from place to place, at
  /// their faces of `turn`, which has all boundary faces. `points`: of the mesh at time t.
  void add_turn(const mesh::Mesh& mesh, std::span<const Vec3> points, double t, Vectors<D>& turn) const;
  /// p at time t [Pa] at the faces with given pressure; the others are left as they are.
  void pressure_at(double t, const std::vector<Vec3>& centres, std::vector<double>& p) const;
  /// Velocity at all boundary faces from that in the cells, see FaceRow.
  void close(const mesh::Mesh& mesh, const Placement<D>& at, const Vectors<D>& u, const Vectors<D>& w,
             Vectors<D>& u_boundary) const;
  /// w one sub-step further at convective outlets, from w and u at its begin: dw/dt + U dw/dn = 0, implicit,
  /// U the mean outflow speed of the patch. Collective.
  void convect(const mesh::Mesh& mesh, const Placement<D>& at, const Vectors<D>& u, const Vectors<D>& w_begin,
               double dt, Vectors<D>& w) const;
  /// Faces that take up what a closed domain would let out or in: convective outlets, else interfaces.
  bool is_adjustable(Index boundary_face) const {
    return convective_patches_.empty() ? is_interface(boundary_face) : convective_[boundary_face] != 0;
  }
  bool has_convective_outlet() const { return !convective_patches_.empty(); }
  /// Absorbing patches, in the same order on all ranks.
  const std::vector<AbsorbingPatch>& absorbing_patches() const { return absorbing_patches_; }
  /// Inlets of a compressible fluid behind which a volume lies: faces of given pressure, that of the volume, whose given
  /// velocity is what flows into the volume.
  const std::vector<FaceRange>& upstream_patches() const { return upstream_patches_; }
  bool is_convective(Index boundary_face) const { return convective_[boundary_face] != 0; }

 private:
  struct GivenPressure {
    FaceRange faces;
    fv::Expression value;
  };
  void add_patch(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const mesh::Patch& patch,
                 const BoundaryParameters& b);
  void add_interface(const mesh::Patch& patch, const FaceRange& faces, const BoundaryParameters& b);
  void add_openings(const mesh::Mesh& mesh, const FluidParameters& parameters);
  MPI_Comm comm_;
  FaceRows rows_;
  std::vector<char> interface_, convective_;
  std::vector<std::string> interface_patches_;
  std::vector<const mesh::Patch*> body_patches_;
  std::vector<GivenVelocity<D>> velocity_patches_;
  std::vector<GivenPressure> pressure_patches_;
  std::vector<FaceRange> convective_patches_;  // also empty ones
  bool closed_ = true, yields_ = false, asks_for_mass_ = false, turns_ = false;
  std::vector<AbsorbingPatch> absorbing_patches_;
  std::vector<FaceRange> upstream_patches_;
  std::vector<double> wall_mass_, wall_load_;
  std::vector<Index> two_sided_;
  std::vector<char> asked_;  // by boundary face: its mass is the structure's word
};

}  // namespace couplet::fluid
