// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/base/types.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::modes {

/// Linear structure reduced to some of its modes on the surface, which is all that a coupled run needs.
/// Shapes are mass-normalized (modal mass 1 kg), so u(x, t) = sum q_m(t) phi_m(x) with q in sqrt(kg) m.
struct ModalModel {
  std::vector<Vec3> vertices;     ///< of the undeformed surface [m]
  mesh::Csr faces;                ///< vertices of each face (3 or 4), right-handed about the outward normal
  std::vector<double> frequency;  ///< of each mode [Hz], ascending; 0 for a rigid motion
  /// phi at each vertex and its mean over each face. Component c of entry i in mode m is at [(3 i + c) modes
  /// + m] [1/sqrt(kg)].
  std::vector<double> vertex_shape, face_shape;
  /// Integral of rho phi dV: component c, mode m at [c modes + m] [sqrt(kg)].
  std::vector<double> participation;
  double mass = 0;                   ///< of the structure [kg]
  std::vector<double> face_density;  ///< mass represented by a face, over its area [kg/m^2]

  std::size_t n_modes() const { return frequency.size(); }
};

/// Center (mean of the vertices) of each face. face_areas() gives the outward area vectors.
std::vector<Vec3> face_centres(const ModalModel& model);
std::vector<Vec3> face_areas(const ModalModel& model);
/// Extent of the bounding box of the vertices [m].
Vec3 extent_of(const ModalModel& model);

/// Sets face_shape to the mean over the vertices of each face.
void average_faces(ModalModel& model);

/// Largest displacement of a mode's vertices [1/sqrt(kg)].
double largest_displacement(const ModalModel& model, std::size_t mode);

/// Rigid motion u = translation + rotation x (x - center of the vertices) that is closest to a mode.
struct RigidMotion {
  Vec3 translation = Vec3::Zero();  ///< [1/sqrt(kg)]
  Vec3 rotation = Vec3::Zero();     ///< [1/(sqrt(kg) m)]
  double misfit = 0;                ///< rms of the remaining displacement over that of the mode
};

/// Fits a rigid motion by least squares over the vertices. Collinear vertices do not rotate about their line.
RigidMotion rigid_motion(const ModalModel& model, std::size_t mode);

/// Sentence about the shapes that planes of symmetry exclude from a search. Empty without such `patches`. `instead`: condition that
/// finds them, as in the YAML.
std::string missing_by_symmetry(const std::vector<std::string>& patches, const char* instead);

/// Writes a modal model to an HDF5 file (docs/formats.md), which gets its name when it is complete.
/// `key` identifies the source of the modes. Only on this rank. Throws Error.
void write_modes(const std::filesystem::path& file, const ModalModel& model, const std::string& key);

/// Reads a modal model from any source. Throws Error with the file and its problem.
ModalModel read_modes(const std::filesystem::path& file);

/// Key of a file of modes. Empty if there is no such file.
std::string key_of_modes(const std::filesystem::path& file);

}  // namespace couplet::modes
