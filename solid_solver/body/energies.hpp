// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace couplet::solid {

/// Energies of the solid since the start [J] (2-D: per metre depth), each summed over this rank. With F the
/// loads and x_s the middle of a trapezoidal step, internal work and the others balance to round-off:
///   kinetic - initial kinetic + internal work + damping loss + contact - initial contact = external work.
/// The other schemes lose what is missing. The internal work of a nonsymmetric operator is not the
/// change of the strain energy; their difference shows how far it is from having a potential.
struct SolidEnergies {
  double kinetic = 0, initial_kinetic = 0;
  double strain = 0;         ///< sigma : epsilon / 2 at the accepted time
  double internal_work = 0;  ///< of sigma (without damping) on the change of strain
  double external_work = 0;  ///< of body forces, tractions and moving supports
  double damping_loss = 0;   ///< taken by Rayleigh damping
  bool conserving = true;    ///< the trapezoidal rule, whose internal work is that of its own stress
  double contact = 0, initial_contact = 0;  ///< kept in the springs of a seat
  /// By the scheme. Of a dissipative one what is missing in the state itself, its strain energy counted: the
  /// work of the stress at the end of a step on the change over it is more than what is stored.
  double lost() const {
    return external_work + initial_kinetic - kinetic - (conserving ? internal_work : strain) - damping_loss +
           initial_contact - contact;
  }
};

}  // namespace couplet::solid
