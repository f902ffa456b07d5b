// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/coupling/participant.hpp"
#include "thermocline/wall/mechanics.hpp"

namespace couplet::thermocline {

/// The wall as another program (a solid of its own) instead of the rings' membrane.
struct ExternalWallParameters {
  int sections = 400;   ///< along the height of the wall
  double angle = 0.01;  ///< of the wedge of the wall that the other program computes [rad]
};
void declare(config::Section& section, ExternalWallParameters& parameters);

/// The inner side of the wall as the coupler sees it: a strip of the cylinder, a face a section, symmetric
/// about the plane y = 0; z from the tank's bottom. Gives at the faces
///   temperature  K   of the ring (t^{n+1})
///   pressure     Pa  fluid and filler, pushes outwards
/// and takes `displacement` at the vertices, relative to the unloaded wall at the solid's reference
/// temperature.
class WallInterface {
 public:
  WallInterface(const ExternalWallParameters& parameters, const Rings& rings);
  int sections() const { return sections_; }
  coupling::Interface describe() const;  ///< places only

  /// Mean of a ring quantity over each section.
  std::vector<double> to_sections(std::span<const double> rings) const;
  /// Radial displacement [m] of each ring from the displacement of the vertices (3 components each).
  std::vector<double> radial(std::span<const double> displacement) const;
  /// Amounts of the sections, shared out to the rings by height.
  std::vector<double> to_rings(std::span<const double> amounts) const;

 private:
  double radius_, angle_, height_;
  int sections_;
  std::vector<double> ring_z_, ring_dz_;
};

/// The filler against a wall whose radius somebody else computes. Its radial strain e_w was computed at t^n
/// under the pressure and the temperatures given then; at t^{n+1} under the same pressure it will be e_w' =
/// e_w + change of the integral of alpha dT. The filler's pressure follows by relaxation with the stiffness
/// of the ring, E e/R (pressure per strain):
///   p_s := clamp(p_s + E e/R (e_s - e_w'), K_a p_v, p_v/K_a)
/// and e_s follows the wall outside the rigid range, as in FillerMechanics. A membrane would answer exactly
/// so; what bending spreads along z is corrected in the next step. The membrane is the stiffest answer a wall
/// can give, so the iteration contracts for any shape of the load.
class ContactMechanics {
 public:
  ContactMechanics(const Rings& rings, const Steel& steel, const Filler& filler,
                   const InnerPressure& pressure, std::span<const double> wall,
                   std::span<const double> grains);

  /// `radial`: the wall's displacement [m] at each ring under what was given last; empty: a membrane's.
  /// `wall`, `grains`: temperatures at the end of the step, those that are given next.
  void update(std::span<const double> radial, std::span<const double> wall, std::span<const double> grains);
  /// Another weight of fluid and grains from the next update on.
  void load(const InnerPressure& pressure);
  std::span<const double> pressure() const { return total_; }   ///< p_f + p_s [Pa]
  std::span<const double> hoop() const { return hoop_; }        ///< of the membrane under it [Pa]
  std::span<const double> lateral() const { return lateral_; }  ///< p_s [Pa]
  const std::vector<Contact>& contact() const { return contact_; }
  /// What passive yielding has taken from the filler's diameter so far, relative [1].
  std::span<const double> slip() const { return slip_; }

  std::vector<double> state() const;
  void restore(std::span<const double> state);

 private:
  void finish();

  const Rings* rings_;
  const Steel* steel_;
  double expansion_, active_ratio_;
  bool begun_ = false;  // has seen a displacement: strains are the wall's own from then on
  std::vector<double> fluid_, active_, passive_;  // p_f; K_a p_v; p_v/K_a [Pa]
  std::vector<double> strain_, slip_, grains_, lateral_, total_, hoop_;
  std::vector<double> given_wall_;  // temperatures under which the wall was last computed [K]
  std::vector<Contact> contact_;
};

}  // namespace couplet::thermocline
