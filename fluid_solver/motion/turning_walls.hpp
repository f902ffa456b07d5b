// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "common/fv/prescribed_motion.hpp"
#include "fluid_solver/boundary/boundary.hpp"

namespace couplet::fluid {

/// What a wall's motion along itself and its turning add to the friction on it: the integral of (grad u)^T.n over
/// a face [m^2/s] from the velocities of its corners alone. Where div u = 0, (grad u)^T.n = (n x grad) x u, and by
/// Stokes' theorem its integral is that of dl x u around the face: exact for linear velocities (w x r gives -w x S),
/// and the edges of a closed wall cancel. `corners` [m], `velocities` [m/s]: one after the other around the face, as
/// the mesh has them; in two dimensions the places do not count.
template <int D>
Vec<D> turn_of(std::span<const Vec3> corners, std::span<const Vec3> velocities);

/// Sets `turn` at the faces of a patch from the velocities of their corners, face by face. `points`: of the mesh.
template <int D>
void set_turn(const mesh::Mesh& mesh, const mesh::Patch& patch, std::span<const Vec3> points,
              std::span<const Vec3> velocities, Vectors<D>& turn);

/// Sets w at the faces of a patch to the means of the velocities of their corners, which stand face by face.
template <int D>
void set_face_means(const mesh::Mesh& mesh, const mesh::Patch& patch, std::span<const Vec3> velocities,
                    Vectors<D>& w);

/// Force on what is outside by the transposed gradient, -mu T; that by du/dn is the flux of Loads.
template <int D>
Vec<D> turning_force(double viscosity, const Vec<D>& turn) {
  return -viscosity * turn;
}

/// Sets w [m/s] at the faces of bodies to the velocity with which their motion begins at `time`, and, where it is not
/// empty, the turn of these faces (see turn_of()); both per boundary face. Gives the largest speed. Collective.
template <int D>
double set_body_start(const mesh::Mesh& mesh, std::span<const Vec3> points, const Boundary<D>& boundary,
                      const fv::MotionParameters& motion, double time, Vectors<D>& w, Vectors<D>& turn);

}  // namespace couplet::fluid
