// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace couplet {

/// Energies of the solid since the start [J] (2-D: per metre depth), each summed over this rank. With F the
/// loads and x_s the middle of a trapezoidal step, internal work and the others balance to round-off:
///   kinetic - initial kinetic + internal work + damping loss = external work.
/// The other schemes lose (or gain) what is missing. The internal work of a nonsymmetric operator is not the
/// change of the strain energy; their difference shows how far it is from having a potential.
struct SolidEnergies {
  double kinetic = 0, initial_kinetic = 0;
  double strain = 0;         ///< sigma : epsilon / 2 at the accepted time
  double internal_work = 0;  ///< of sigma (without damping) on the change of strain
  double external_work = 0;  ///< of body forces, tractions and moving supports
  double damping_loss = 0;   ///< taken by Rayleigh damping
  double lost() const { return external_work + initial_kinetic - kinetic - internal_work - damping_loss; }
};

}  // namespace couplet
