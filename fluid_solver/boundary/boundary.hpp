// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/app/program.hpp"
#include "common/fv/expression.hpp"
#include "common/fv/table.hpp"
#include "fluid_solver/parameters/parameters.hpp"
#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

/// Consecutive boundary faces of one patch; `count` is 0 on ranks that have none.
struct FaceRange {
  Index first = 0, count = 0;
};

/// FaceRow of every boundary face, and lists of the faces by type, in ascending order. Arrays over "boundary
/// faces" are indexed by f - mesh.n_interior.
struct BoundaryRows {
  std::vector<double> pressure, friction, inflow;  ///< see FaceRow
  std::vector<Index> of_pressure;                  ///< faces with given pressure
  std::vector<Index> of_flux;                      ///< all others: phi = w.S
  std::vector<Index> of_mesh;      ///< those of of_flux where w is the normal velocity of the mesh
  std::vector<Index> of_velocity;  ///< the rest of of_flux
  std::vector<Index> of_mirror;    ///< those of of_flux without friction: symmetry planes and slip walls
  std::vector<char> with_mesh;     ///< per boundary face: w is the normal velocity of the mesh

  explicit BoundaryRows(Index count = 0)
      : pressure(count, 0.0), friction(count, 1.0), inflow(count, 1.0), with_mesh(count, 0) {}
  void set(const FaceRange& faces, const FaceRow& row, bool moves_with_mesh) {
    for (Index b = faces.first; b < faces.first + faces.count; ++b) {
      pressure[b] = row.pressure;
      friction[b] = row.friction;
      inflow[b] = row.inflow;
      with_mesh[b] = moves_with_mesh;
    }
  }
  /// Builds the lists once all rows are set.
  void sort() {
    for (Index b = 0; b < static_cast<Index>(pressure.size()); ++b) {
      (pressure[b] > 0 ? of_pressure : of_flux).push_back(b);
      if (pressure[b] > 0) continue;
      (with_mesh[b] ? of_mesh : of_velocity).push_back(b);
      if (friction[b] == 0) of_mirror.push_back(b);
    }
  }
};

/// Speed at the faces of an inlet relative to the mean speed.
template <int D>
struct InletShape {
  Vec<D> direction = Vec<D>::Zero();  ///< unit vector into the domain
  std::vector<double> speed;          ///< per face of the patch; its mean over the area is 1 to round-off
  double area = 0;                    ///< [m^2] of the whole patch at rest
};

/// Corners of the faces of a patch, relative to the face centers.
using FaceCorners = std::vector<std::vector<Vec3>>;

/// Velocity of a patch as given by the keys of its condition.
template <int D>
class GivenVelocity {
 public:
  /// Throws Error if the keys do not fit the patch. Collective.
  GivenVelocity(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const mesh::Patch& patch,
                const std::map<std::string, BoundaryParameters>& boundaries);

  const FaceRange& faces() const { return faces_; }
  const mesh::Patch& patch() const { return *patch_; }
  /// True for a wall whose velocity varies in space.
  bool turns() const { return turns_; }
  /// Evaluates at points of the patch, in the order of its faces if a profile was made for them [m/s].
  void evaluate(double t, std::span<const Vec3> places, Vec<D>* w) const;
  /// True if the flow rate is given; flow() is then that into the domain [m^3/s].
  bool gives_flow() const { return parameters_.flow_rate.has_value(); }
  double flow(double t) const;
  /// Means over the faces of the patch with these centers [m/s].
  void average(double t, std::span<const Vec3> centres, Vec<D>* w) const;

 private:
  void without_ramp(double t, std::span<const Vec3> places, Vec<D>* w) const;
  FaceRange faces_;
  const mesh::Patch* patch_;
  BoundaryParameters parameters_;
  std::vector<fv::Expression> velocity_;
  fv::Expression mean_speed_;           // [m/s], or the flow rate [m^3/s]
  InletShape<D> shape_;                 // if mean_speed or flow_rate is given
  std::optional<fv::GridTable> table_;  // of the velocity
  fv::Expression turning_;              // [rad/s], if a rotation is given
  bool turns_ = false;
  FaceCorners corners_;  // empty unless the velocity varies in space
  bool steady_ = false;  // but for the ramp
  // Means without the ramp, kept until the faces move or, if not steady, until the next call.
  mutable std::vector<Vec3> mean_at_;
  mutable Vectors<D> mean_;
};

/// Reads the velocities of a boundary from its file, in `dimension` components. Throws Error with file:line.
fv::GridTable velocity_table(const std::filesystem::path& file, const VelocityTableParameters& parameters,
                             int dimension);

/// Missing or invalid tables of boundaries, and walls that nothing moves, for --check.
std::vector<app::ProblemOfKey> problems_of_files(const FluidParameters& parameters,
                                                 const diagnostics::CaseScene& scene);

/// A patch that lets pressure waves out.
struct AbsorbingPatch {
  FaceRange faces;
  bool inlet = false;  ///< given velocity; else given pressure
};

/// Part of a system without a mesh, at one pressure behind openings: a volume upstream of the inlets, or a circuit behind an outlet.
struct LumpedEnd {
  std::string name;  ///< its patch, or "upstream"
  std::vector<FaceRange> faces;
  double volume = 0;                 ///< [m^3]; 0 if it is a circuit
  CircuitParameters circuit;         ///< if it is one
  std::optional<fv::Property> drop;  ///< [Pa], of a circuit with a table of the flow rate
};

template <int D>
class Boundary {
 public:
  /// Throws Error if a patch has no boundary or a boundary names no patch.
  Boundary(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const FluidParameters& parameters);

  /// Coefficients of the conditions for the loops over boundary faces.
  const BoundaryRows& rows() const { return rows_; }
  /// True if no face of the whole domain has a given pressure, so that the pressure level is free.
  bool closed() const { return closed_; }
  /// No fluid passes the boundary: walls surround it.
  bool sealed() const { return sealed_; }
  /// Names of the patches of type interface.
  const std::vector<std::string>& interface_patches() const { return interface_patches_; }
  /// Patches of type body.
  const std::vector<const mesh::Patch*>& body_patches() const { return body_patches_; }
  /// True at a wall whose velocity is given from outside, by the structure or the prescribed motion.
  bool is_interface(Index boundary_face) const { return interface_[boundary_face] != 0; }

  /// True if the pressure equation accounts for the mass of some interface walls. wall_mass() is the mass per
  /// area of each boundary face [kg/m^2], 0 if none.
  bool yields() const { return yields_; }
  const std::vector<double>& wall_mass() const { return wall_mass_; }

  /// Sets the pressure that gave walls of known mass their velocity, per boundary face [Pa].
  void set_wall_load(std::vector<double> load) { wall_load_ = std::move(load); }
  const std::vector<double>& wall_load() const { return wall_load_; }

  /// Sets w at time t [m/s] at faces with given velocity; interface faces keep their value.
  void velocity_at(double t, const std::vector<Vec3>& centres, Vectors<D>& w) const;
  /// Sets w likewise, and where a flow rate is given, scales it to the area of the patch at that time. Collective.
  void velocity_at(double t, const mesh::Mesh& mesh, const Placement<D>& at, Vectors<D>& w) const;
  /// True on all ranks if some walls may rotate or stretch.
  bool walls_turn() const { return turns_; }
  /// Adds the turn (see turn_of()) of walls whose velocity the case gives and varies in space, at their faces
  /// of `turn`, which has all boundary faces. `points`: points of the mesh at time t.
  void add_turn(const mesh::Mesh& mesh, std::span<const Vec3> points, double t, Vectors<D>& turn) const;
  /// Sets p at time t [Pa] at faces with given pressure; the others keep their value.
  void pressure_at(double t, const std::vector<Vec3>& centres, std::vector<double>& p) const;
  /// Given pressure at time t that is nearest to zero [Pa]: a second outlet may drive the flow or send a pulse. 0 if none is
  /// given. Collective.
  double pressure_of_rest(double t, const std::vector<Vec3>& centres) const;
  /// Computes the velocity at all boundary faces from that in the cells, see FaceRow.
  void close(const mesh::Mesh& mesh, const Placement<D>& at, const Vectors<D>& u, const Vectors<D>& w,
             Vectors<D>& u_boundary) const;
  /// Advances w at convective outlets by one sub-step, from w and u at its beginning: dw/dt + U dw/dn = 0,
  /// implicit. U is the mean outflow speed of the patch. Collective.
  void convect(const mesh::Mesh& mesh, const Placement<D>& at, const Vectors<D>& u, const Vectors<D>& w_begin,
               double dt, Vectors<D>& w) const;
  /// True for faces that balance the net flux of a closed domain: convective outlets, else interfaces.
  bool is_adjustable(Index boundary_face) const {
    return convective_patches_.empty() ? is_interface(boundary_face) : convective_[boundary_face] != 0;
  }
  bool has_convective_outlet() const { return !convective_patches_.empty(); }
  /// Absorbing patches, in the same order on all ranks.
  const std::vector<AbsorbingPatch>& absorbing_patches() const { return absorbing_patches_; }
  /// Lumped ends, in the same order on all ranks. Their pressure is given at their faces. Inlets of a compressible fluid may have a
  /// volume upstream, into which their given velocity flows.
  const std::vector<LumpedEnd>& ends() const { return ends_; }
  bool is_convective(Index boundary_face) const { return convective_[boundary_face] != 0; }

 private:
  struct GivenPressure {
    FaceRange faces;
    fv::Expression value;
    FaceCorners corners;  // empty unless it varies in space
  };
  void add_patch(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const mesh::Patch& patch,
                 const std::map<std::string, BoundaryParameters>& boundaries);
  void add_interface(const mesh::Patch& patch, const FaceRange& faces, const BoundaryParameters& b);
  void add_openings(const mesh::Mesh& mesh, const FluidParameters& parameters);
  MPI_Comm comm_;
  BoundaryRows rows_;
  std::vector<char> interface_, convective_;
  std::vector<std::string> interface_patches_;
  std::vector<const mesh::Patch*> body_patches_;
  std::vector<GivenVelocity<D>> velocity_patches_;
  std::vector<GivenPressure> pressure_patches_;
  std::vector<FaceRange> convective_patches_;  // also empty ones
  bool closed_ = true, sealed_ = true, yields_ = false, turns_ = false;
  std::vector<AbsorbingPatch> absorbing_patches_;
  std::vector<LumpedEnd> ends_;
  std::vector<double> wall_mass_, wall_load_;
};

}  // namespace couplet::fluid
