// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/fv/expression.hpp"
#include "fluid_solver/parameters.hpp"
#include "fluid_solver/placement.hpp"

namespace couplet::fluid {

/// What is known at a boundary face. Arrays over "boundary faces" are indexed by f - mesh.n_interior.
enum class FaceKind : unsigned char {
  velocity,  ///< w given: inlets, walls, interface
  slip,      ///< only the normal velocity is given: that of the mesh
  pressure,  ///< p given, velocity from inside
};

template <int D>
class Boundary {
 public:
  /// Throws Error if a patch has no boundary or a boundary names no patch.
  Boundary(const Mesh& mesh, const FluidParameters& parameters);

  const std::vector<FaceKind>& kind() const { return kind_; }
  /// No face of the whole domain has a given pressure: the pressure level is free.
  bool closed() const { return closed_; }
  /// Names of the patches of type interface.
  const std::vector<std::string>& interface_patches() const { return interface_patches_; }
  bool is_interface(Index boundary_face) const { return interface_[boundary_face] != 0; }

  /// w at time t [m/s] at the faces with given velocity; interface faces are left as they are.
  void velocity_at(double t, const std::vector<Vec3>& centres, Vectors<D>& w) const;
  /// p at time t [Pa] at the faces with given pressure; the others are left as they are.
  void pressure_at(double t, const std::vector<Vec3>& centres, std::vector<double>& p) const;
  /// Velocity at all boundary faces from that in the cells: u_b = w, u_P with the normal part of w, or u_P.
  void close(const Mesh& mesh, const Placement<D>& at, const Vectors<D>& u, const Vectors<D>& w,
             Vectors<D>& u_boundary) const;
  /// Largest prescribed speed at time t [m/s] on all ranks.
  double largest_speed(double t, const std::vector<Vec3>& centres) const;

 private:
  struct Given {
    Index first = 0, count = 0;  // boundary faces
    BoundaryParameters parameters;
    std::vector<Expression> velocity;
    Expression pressure;
  };
  MPI_Comm comm_;
  std::vector<FaceKind> kind_;
  std::vector<char> interface_;
  std::vector<std::string> interface_patches_;
  std::vector<Given> velocity_patches_, pressure_patches_;
  bool closed_ = true;
};

}  // namespace couplet::fluid
