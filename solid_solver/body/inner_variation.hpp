// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/mesh/mesh.hpp"
#include "solid_solver/body/solid_body.hpp"

namespace couplet::solid {

/// How stiff the strains of a quadrilateral's four faces make it beside their mean. Over n cells across a bar that bends, the second
/// moment of area is 1 + 1/(2 n^2) of the right one by the faces' strains and 1 - 1/n^2 by the cells' mean: a third of what they
/// differ is what the symmetric gradient with the volume strain of faces errs, in energy and so in displacement. The difference of
/// two face gradients does not see it. In space x-, y- and z-faces cancel.
class InnerVariation {
 public:
  /// Keeps both by reference.
  InnerVariation(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows);
  /// The plane, isotropic or not, where the operator takes the volume strain of faces.
  static bool is_needed(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows);
  /// Strain of a flux face; those of partition faces on both ranks.
  void add(Index face, const Tensor3& strain);
  /// Over the strain energy of all cells; 0 where there is none. Collective.
  double missed() const;
  /// What is missed of twice the strain energy [J]: a square of the strains. Collective.
  double energy() const;

 private:
  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const elastic::ElasticOperator& rows_;
  std::vector<double> energy_;   // of owned cells: sum V_fP e : C : e
  std::vector<Tensor3> strain_;  // sum V_fP e
  std::vector<double> volume_;   // sum V_fP
};

/// The strains of the flux faces that two face gradients make of one displacement.
struct StrainGap {
  double missed = 0;              ///< sum V mu |e1 - e2|^2 / sum V mu |e1|^2
  double variation = 0;           ///< InnerVariation::missed() of e1 where it is needed
  std::vector<Tensor3> strain{};  ///< e1, of the gradient in use
};
/// `strain`: of a displacement gradient. Collective.
StrainGap strain_gap(const SolidBody& body, std::span<const double> unknowns, std::span<const double> known,
                     Tensor3 (*strain)(const Tensor3&));

}  // namespace couplet::solid
