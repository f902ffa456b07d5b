// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

namespace couplet::elastic {

/// Constants of sigma = mu (grad u + grad u^T) + lambda tr(grad u) I [Pa]. In plane stress lambda is 2 lambda
/// mu / (lambda + 2 mu).
struct LameConstants {
  double mu = 0, lambda = 0;
};

/// Constants of the deviatoric part in 3-D: sigma = 2 mu dev(e) + K tr(e) I.
inline LameConstants deviatoric(const LameConstants& lame) { return {lame.mu, -2 * lame.mu / 3}; }
inline double bulk_modulus(const LameConstants& lame) { return lame.lambda + 2 * lame.mu / 3; }

/// Volume strain on which the bulk modulus acts in the symmetric gradient: that of each face, the mean over a
/// cell's faces (no locking as nu approaches 1/2), or both. The first is too stiff, the second too soft. A
/// tenth of K at the faces gives the least error in bending. Much more than mu / 3 would lock.
enum class VolumeStrain { faces, cells, shared };
/// Part of the bulk modulus that acts on the volume strain of cells [Pa].
inline double bulk_of_cells(const LameConstants& lame, VolumeStrain by) {
  const double bulk = bulk_modulus(lame);
  if (by == VolumeStrain::shared) return bulk - std::min(bulk / 10, lame.mu / 3);
  return by == VolumeStrain::cells ? bulk : 0;
}
/// Remaining constants for the strain of the faces.
inline LameConstants part_of_faces(const LameConstants& lame, VolumeStrain by) {
  if (by == VolumeStrain::cells) return deviatoric(lame);
  return {lame.mu, lame.lambda - bulk_of_cells(lame, by)};
}

}  // namespace couplet::elastic
