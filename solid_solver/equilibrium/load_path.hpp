// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/mesh/mesh.hpp"
#include "solid_solver/parameters/method_parameters.hpp"

namespace couplet::io {
class CheckpointReader;
class CheckpointWriter;
}  // namespace couplet::io

namespace couplet::solid {

/// A maximum or minimum of the load factor along the path, between two equilibria.
struct LimitPoint {
  double factor = 0, time = 0;
  bool is_maximum = true;
};

/// The path of equilibria (u, lambda), A(u) = lambda b, that a static run follows by its length: lengths are the root mean square of the
/// change of the displacement over the volume, so that they do not depend on the mesh. All but the plain getters is collective.
class LoadPath {
 public:
  /// By reference.
  LoadPath(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const LoadStepping& chosen);

  double factor() const { return now_.factor; }
  double trial_factor() const { return trial_.factor; }
  double length() const { return travelled_; }
  /// The largest load factor so far, by size.
  double largest_factor() const { return largest_; }
  /// Lowest stiffness of the accepted equilibrium's tangent over that of the undeformed body.
  double stiffness() const { return now_.stiffness; }
  const std::vector<LimitPoint>& limits() const { return limits_; }

  double product(std::span<const double> a, std::span<const double> b) const;
  /// A step of `dt` begins whose tangent is du/dlambda = `tangent`: the change of the load factor that predicts it.
  double predict(std::span<const double> tangent, double dt);
  /// Length of the step that was predicted.
  double step_length() const { return step_; }
  void propose(double factor, std::vector<double> change, int iterations);
  /// What was proposed is the state now, at `time`, with this lowest stiffness.
  void accept(double time, double stiffness);

  /// `rows`: whose unknowns the changes are of.
  void save(io::CheckpointWriter& file, const elastic::ElasticOperator& rows) const;
  void load(io::CheckpointReader& file, const elastic::ElasticOperator& rows);

 private:
  struct Point {
    double factor = 0, stiffness = 1;
    int iterations = 0;
    std::vector<double> change;  // of the displacement, since the equilibrium before
  };
  void see_limit(double length, double time);

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  LoadStepping chosen_;
  double volume_ = 0;
  Point now_, trial_;
  std::vector<LimitPoint> limits_;
  double factor_before_ = 0, length_before_ = 0;  // of the equilibrium before; the step from it
  double dt_ = 0, first_ = 0,
         nominal_ = 0;  // step of time of a nominal length, first and present nominal length
  double step_ = 0, travelled_ = 0, largest_ = 0;
};

}  // namespace couplet::solid
