// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/base/types.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::modes {

/// A linear structure reduced to some of its modes, as its surface shows them: all that a coupled run needs
/// of it. Shapes are mass-normalised (modal mass 1 kg), so u(x, t) = sum q_m(t) phi_m(x) with q in sqrt(kg)
/// m.
struct ModalModel {
  std::vector<Vec3> vertices;  ///< of the surface, undeformed [m]
  mesh::Csr faces;  ///< vertices of each face (3 or 4), turning right-handed about the outward normal
  std::vector<double> frequency;  ///< of each mode [Hz], ascending; 0: a rigid motion
  /// phi at each vertex and its mean over each face: component c of entry i in mode m stands at
  /// [(3 i + c) modes + m] [1/sqrt(kg)].
  std::vector<double> vertex_shape, face_shape;
  /// Integral of rho phi dV: component c, mode m at [c modes + m] [sqrt(kg)].
  std::vector<double> participation;
  double mass = 0;                   ///< of the structure [kg]
  std::vector<double> face_density;  ///< mass a face stands for, over its area [kg/m^2]

  std::size_t n_modes() const { return frequency.size(); }
};

/// Centre (mean of the vertices) and area vector, outwards, of each face.
std::vector<Vec3> face_centres(const ModalModel& model);
std::vector<Vec3> face_areas(const ModalModel& model);
/// Sides of the box around the vertices [m].
Vec3 extent_of(const ModalModel& model);

/// Sets face_shape to the mean over the vertices of each face.
void average_faces(ModalModel& model);

/// The largest displacement of a mode's vertices [1/sqrt(kg)].
double largest_displacement(const ModalModel& model, std::size_t mode);

/// The rigid motion u = translation + rotation x (x - centre of the vertices) that is nearest to a mode.
struct RigidMotion {
  Vec3 translation = Vec3::Zero();  ///< [1/sqrt(kg)]
  Vec3 rotation = Vec3::Zero();     ///< [1/(sqrt(kg) m)]
  double misfit = 0;                ///< rms of what is left of the mode's vertices, over their rms
};

/// By least squares over the vertices. A surface whose vertices lie on one line does not turn about it.
RigidMotion rigid_motion(const ModalModel& model, std::size_t mode);

/// Writes a modal model to one HDF5 file (docs/formats.md, "Modes"), under a temporary name that is renamed
/// when it is complete. `key` tells what the modes were made of. On this rank alone. Throws Error.
void write_modes(const std::filesystem::path& file, const ModalModel& model, const std::string& key);

/// Reads one, whoever wrote it. Throws Error naming the file and what is wrong with it.
ModalModel read_modes(const std::filesystem::path& file);

/// The key of a file of modes; empty if there is no such file or it is none of modes.
std::string key_of_modes(const std::filesystem::path& file);

}  // namespace couplet::modes
