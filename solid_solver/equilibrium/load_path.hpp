// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/mesh/mesh.hpp"
#include "solid_solver/parameters/method_parameters.hpp"

namespace couplet::io {
class Archive;
}

namespace couplet::solid {

/// Maximum or minimum of the load factor along the path, between two equilibria.
struct LimitPoint {
  double factor = 0, time = 0;
  bool is_maximum = true;

  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(factor, time, is_maximum);
  }
};

/// Path of equilibria (u, lambda), A(u) = lambda b, followed by its arc length in a static run. Lengths are
/// volume-averaged (rms) changes in displacement, so independent of the mesh. Getters are not collective.
class LoadPath {
 public:
  /// Keeps references.
  LoadPath(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const LoadStepping& chosen);

  double factor() const { return now_.factor; }
  double trial_factor() const { return trial_.factor; }
  double length() const { return travelled_; }
  /// Largest load factor so far, by absolute value.
  double largest_factor() const { return largest_; }
  /// Lowest stiffness of the accepted equilibrium's tangent relative to the undeformed body.
  double stiffness() const { return now_.stiffness; }
  const std::vector<LimitPoint>& limits() const { return limits_; }

  double product(std::span<const double> a, std::span<const double> b) const;
  /// Predicts the change of the load factor in a step of `dt` with du/dlambda = `tangent`.
  double predict(std::span<const double> tangent, double dt);
  /// Length of the predicted step.
  double step_length() const { return step_; }
  void propose(double factor, std::vector<double> change, int iterations);
  /// Accepts the proposed state at `time`, with this lowest stiffness.
  void accept(double time, double stiffness);

  /// `rows`: operator whose unknowns the changes refer to.
  void visit(io::Archive& archive, const elastic::ElasticOperator& rows);

 private:
  struct Point {
    double factor = 0, stiffness = 1;
    int iterations = 0;
    std::vector<double> change;  // of the displacement, since the previous equilibrium
  };
  void see_limit(double length, double time);

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  LoadStepping chosen_;
  double volume_ = 0;
  Point now_, trial_;
  std::vector<LimitPoint> limits_;
  double factor_before_ = 0, length_before_ = 0;  // of the previous equilibrium; of the step from it
  // Time step of nominal length; first and present nominal length.
  double dt_ = 0, first_ = 0, nominal_ = 0;
  double step_ = 0, travelled_ = 0, largest_ = 0;
};

}  // namespace couplet::solid
