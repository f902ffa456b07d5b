// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "solid_solver/thermal/heat.hpp"

namespace couplet::solid {

/// The matrix of a steady field, conductivities that do not vary, with other data: what the dual problem needs of Heat.
class HeatAnswer final {
 public:
  /// By reference.
  explicit HeatAnswer(const Heat& heat) : heat_(heat) {}

  bool properties_vary() const { return heat_.properties_vary_; }
  const HeatBoundaries& boundaries() const { return heat_.boundaries_; }
  /// Of the last step, per local face [W/(m K)].
  std::span<const double> conductivity() const { return heat_.conductivity_; }
  /// h |S| of the flux faces [W/K], entry by entry of conduction().flux_faces(); empty: no convection.
  std::vector<double> transfer() const;
  /// What the value at a cell's centre leaves out of the source in the cell [W], accepted time; empty: no source.
  std::vector<double> source_missed() const;
  /// The field of other `sources` [W], one a row, and known values. Throws SolveFailure. Collective.
  HeatState field(std::vector<double> sources, std::vector<double> known) const;

 private:
  const Heat& heat_;
};

/// A quadratic around a cell, fitted to the cells that share a vertex with it, of its zone, and to their boundary faces:
/// T(x) = value + slope . (x - x_P) + (x - x_P) . second . (x - x_P) / 2
struct LocalHeat {
  double value = 0;
  Vec3 slope = Vec3::Zero();
  Tensor3 second = Tensor3::Zero();
  double at(const Vec3& from_centre) const {
    return value + slope.dot(from_centre) + 0.5 * from_centre.dot(second * from_centre);
  }
};

/// Of all local cells. Collective.
std::vector<LocalHeat> local_heat(const Heat& heat, const HeatState& field);

/// The fluxes of the scheme have a defect tau_f = exact - scheme's on the exact field. A number that answers to a source by z ([becker2001];
/// for finite volumes: Venditti and Darmofal, J. Comput. Phys. 164 (2000) 204) errs by -S + sum_P z_P s_P with s the defect of the source,
///   S = sum_f tau_f (z_N - z_P)
/// Of a quadratic with the second derivatives H of T around the face tau_f is what its gradient (2.53)-(2.58) is wrong by. It is
/// 0 between regular cells; there the third derivatives count, which summed by parts are
///   dim/6 sum_P sum_f V_fP k (d_n d'_n - d_t . d'_t) - sum_b k |S| d_b^2 / 6 H_nn dz/dn,   d = H (x_f - x_P), d' that of z
/// with n and t across and along the face, d_b the distance of the cell from a boundary face: exact for regular cells.
/// Values prescribed at boundaries count as exact between face centres. Collective.
double weighted_defect(const Heat& heat, std::span<const LocalHeat> of_t, const HeatState& z);

}  // namespace couplet::solid
