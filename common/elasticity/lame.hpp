// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

namespace couplet::elastic {

/// sigma = mu (grad u + grad u^T) + lambda tr(grad u) I [Pa]. Plane stress: lambda is 2 lambda mu / (lambda +
/// 2 mu).
struct LameConstants {
  double mu = 0, lambda = 0;
};

/// What acts on the strain without its volume part, in three dimensions: sigma = 2 mu dev(e) + K tr(e) I.
inline LameConstants deviatoric(const LameConstants& lame) { return {lame.mu, -2 * lame.mu / 3}; }
inline double bulk_modulus(const LameConstants& lame) { return lame.lambda + 2 * lame.mu / 3; }

/// Whose volume strain the bulk modulus acts on, with the symmetric gradient: that of each face, the mean of a
/// cell's faces, which does not lock as nu goes to 1/2, or both. That of the cells is softer than the body, that of
/// the faces stiffer: a tenth of K at the faces leaves the least error in bending; much above mu / 3 it would lock.
enum class VolumeStrain { faces, cells, shared };
/// The part of the bulk modulus that acts on the volume strain of cells [Pa].
inline double bulk_of_cells(const LameConstants& lame, VolumeStrain by) {
  const double bulk = bulk_modulus(lame);
  if (by == VolumeStrain::shared) return bulk - std::min(bulk / 10, lame.mu / 3);
  return by == VolumeStrain::cells ? bulk : 0;
}
/// What is left for the faces' own strain.
inline LameConstants part_of_faces(const LameConstants& lame, VolumeStrain by) {
  if (by == VolumeStrain::cells) return deviatoric(lame);
  return {lame.mu, lame.lambda - bulk_of_cells(lame, by)};
}

}  // namespace couplet::elastic
