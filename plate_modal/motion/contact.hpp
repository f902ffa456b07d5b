// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "common/contact/contact.hpp"
#include "plate_modal/motion/surface.hpp"

namespace couplet::plate {

using contact::ContactParameters;
using contact::ContactRule;

/// Frictionless penalty contact of faces oriented towards a rigid seat, thesis (4.32)-(4.33). A face of area
/// S at a depth delta below the seat gets the force kappa delta, kappa = stiffness S.
class Contact final {
 public:
  /// `normal`: default direction. `stiffness`: default per area [N/m^3]. Throws Error if no face of the
  /// structure is oriented towards the seat.
  Contact(const Surface& surface, const ContactParameters& parameters, const Vec3& normal, double stiffness);

  struct ContactResult {
    Eigen::VectorXd force;    ///< on the modes
    Eigen::MatrixXd tangent;  ///< - d force / d q
    double energy = 0;        ///< stored in the seat at q [J]
    double penetration = 0;   ///< largest at q [m]
    double total = 0;         ///< sum of the forces along the direction [N]
  };
  /// Forces for the displacement q. The midpoint rule uses kappa <delta(q)>. The conserving rule uses the
  /// mean force between `from` and q, (V(q) - V(from)) / (delta(q) - delta(from)) with V = kappa <delta>^2 /
  /// 2 of each face, whose work equals the change of energy for any step [gonzalez2000]. Both grow with q, so
  /// the solution is unique. No allocation once `result` has its size.
  void evaluate(std::span<const double> from, std::span<const double> q, ContactResult& result) const;
  /// Energy, penetration and total force for a structure at rest in q.
  void find(std::span<const double> q, ContactResult& result) const;

  /// Position of the deepest penetration for the displacement q.
  struct DeepestPoint {
    double depth = 0;            ///< [m]; not positive if there is none
    Vec3 centre = Vec3::Zero();  ///< of the face, undeformed [m]
  };
  DeepestPoint deepest(std::span<const double> q) const;
  /// Seat stiffness over the mass moved by an impact [1/s^2], in the direction of its modal force, for the
  /// faces in contact at either end of the step. 0 if there are none.
  double stiffness_of_impact(std::span<const double> from, std::span<const double> q,
                             const Eigen::VectorXd& force) const;
  /// Largest value for any impact [1/s^2], with all faces.
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
