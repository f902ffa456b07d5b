// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "common/contact/contact.hpp"
#include "plate_modal/motion/surface.hpp"

namespace couplet::plate {

using contact::ContactParameters;
using contact::ContactRule;

/// Penalty contact of the faces that look at a rigid seat, without friction, thesis (4.32)-(4.33): a face of
/// area S that is delta below the seat is pushed back by kappa delta, kappa = stiffness S.
class Contact final {
 public:
  /// `normal`: direction where the parameters give none; `stiffness`: per area where they give none [N/m^3].
  /// Throws Error if no face of the structure looks at the seat.
  Contact(const Surface& surface, const ContactParameters& parameters, const Vec3& normal, double stiffness);

  struct Result {
    Eigen::VectorXd force;    ///< on the modes
    Eigen::MatrixXd tangent;  ///< - d force / d q
    double energy = 0;        ///< kept in the seat at q [J]
    double penetration = 0;   ///< the deepest at q [m]
    double total = 0;         ///< sum of the forces along the direction [N]
  };
  /// Forces for the displacement q: midpoint rule kappa <delta(q)>; conserving rule the mean force between
  /// `from` and q, (V(q) - V(from)) / (delta(q) - delta(from)) with V = kappa <delta>^2 / 2 of each face, so
  /// that the work is the change of the energy whatever the step [gonzalez2000]. Both grow with q and have
  /// one solution. No allocation once `result` has its size.
  void evaluate(std::span<const double> from, std::span<const double> q, Result& result) const;
  /// Energy, penetration and total alone, at rest in q.
  void look(std::span<const double> q, Result& result) const;

  /// Where the structure stands deepest in the seat with the displacement q.
  struct Place {
    double depth = 0;            ///< [m]; not above 0: nowhere
    Vec3 centre = Vec3::Zero();  ///< of the face, undeformed [m]
  };
  Place deepest(std::span<const double> q) const;
  /// Stiffness of the seat over the mass that an impact moves [1/s^2], in the direction of its force on the modes, of the
  /// faces that touch at either end of the step. 0: none.
  double stiffness_of_impact(std::span<const double> from, std::span<const double> q,
                             const Eigen::VectorXd& force) const;
  /// The largest that any impact can see [1/s^2]: with all faces.
  double largest_stiffness() const;

  std::size_t n_faces() const { return gap_.size(); }
  bool is_conserving() const { return rule_ == ContactRule::conserving; }

 private:
  double penetration(std::size_t face, std::span<const double> q) const;

  void refuse_sliding(const Surface& surface, const Vec3& direction,
                      std::span<const std::size_t> faces) const;

  ContactRule rule_;
  std::vector<Vec3> centre_;
  std::vector<double> gap_, kappa_, shape_;  // per face: at rest [m], [N/m], along the direction (modes)
  int n_modes_;
};

}  // namespace couplet::plate
