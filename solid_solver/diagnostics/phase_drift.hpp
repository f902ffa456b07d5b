// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace couplet::solid {

/// How far a motion has swung, and with it what a wrong stiffness makes of it. A mesh that is stiffer by a part e swings faster by e/2,
/// so that after an angle w t the displacement is e w t / 2 of its amplitude off, twice the amplitude at most. Loads that a body follows
/// without inertia have no such drift: kinetic over strain energy, means over the run, is 1 of free vibrations and 0 of those.
class PhaseDrift {
 public:
  /// After a step of dt: root mean squares of velocity and displacement, energies of the whole body [J].
  void add(double dt, double speed, double size, double kinetic, double strain);
  /// Of the displacement over its size, with a relative error `stiffness` of the strain energy.
  double over_size(double stiffness) const;
  /// For checkpoints.
  static constexpr std::size_t n_values = 4;
  std::vector<double> state() const { return {way_, size_, kinetic_, strain_}; }
  void restore(std::span<const double> state);

 private:
  double way_ = 0, size_ = 0;        // integral of |v|, largest |u| [m]
  double kinetic_ = 0, strain_ = 0;  // integrals [J s]
};

}  // namespace couplet::solid
