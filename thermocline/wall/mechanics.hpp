// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "thermocline/wall/shell.hpp"

namespace couplet::thermocline {

/// Inner pressures on the wall at each ring [Pa].
struct InnerPressure {
  std::vector<double> fluid;     ///< p_f = p_ullage + rho_f g depth (5.13); that of the ullage above the bed
  std::vector<double> vertical;  ///< p_v of the buoyant grains (5.14-5.16)
};
/// `temperature`: temperature of the fluid in each bed cell; empty if its density does not depend on it.
InnerPressure inner_pressure(const Rings& rings, const BedGrid& bed, const Medium& htf, const Filler& filler,
                             double ullage_gauge, std::span<const double> temperature = {});

/// Stress in a wall of rings (thesis 5.4): sigma_rr = -p_f, sigma_zz = -(weight above)/(pi D e), sigma_tt = p
/// D/(2 e) (5.23). Tension is positive.
struct WallStress {
  std::vector<double> hoop, axial, radial, equivalent, yield;  ///< [Pa]
};

enum class Contact { active, rigid, passive };

/// Filler as a rigid, perfectly plastic, cohesionless bulk against the wall (thesis figure 5.4). At each
/// height it is
///   active   the wall has moved away and the grains have followed: p_s = K_a p_v (5.17)
///   rigid    the wall cannot shrink below the grains' diameter, which expands thermally (5.18)
///   passive  the grains yield: p_s = p_v/K_a (5.19, 5.20), and their diameter follows the wall
/// Strains are logarithms of diameters relative to the initial state. Let e_w be the wall strain at the end
/// of a step under the old filler pressure, and E e/R the stiffness of the ring (pressure per strain). Then
///   p_s := clamp(p_s + E e/R (e_s - e_w), K_a p_v, p_v/K_a)
/// and outside the rigid range the filler's strain e_s follows the wall. A wall of rings is a membrane, e_w =
/// (p_f + p_s)/(E e/R) + integral of alpha dT, for which this is exact. For an external wall the strain is
/// that at the start of the step plus the change of the integral of alpha dT. Axial coupling by bending is
/// corrected in the next step. The membrane is the stiffest possible wall, so the iteration converges for any
/// load shape.
class FillerMechanics {
 public:
  /// Starts at these temperatures with the active load. `is_external`: another program computes the wall.
  FillerMechanics(const Rings& rings, const Steel& steel, const Filler& filler, const InnerPressure& pressure,
                  std::span<const double> wall, std::span<const double> grains, bool is_external = false);
  /// Sets another weight of fluid and grains, used from the next update on.
  void load(const InnerPressure& pressure);
  /// `wall`, `grains`: temperatures at the end of the step. `radial`: displacement of an external wall [m] at
  /// each ring under the last given load; empty for a membrane.
  void update(std::span<const double> wall, std::span<const double> grains,
              std::span<const double> radial = {});

  std::span<const double> hoop() const { return hoop_; }        ///< of the membrane [Pa]
  std::span<const double> lateral() const { return lateral_; }  ///< p_s [Pa]
  std::span<const double> pressure() const { return total_; }   ///< p_f + p_s [Pa]
  const std::vector<Contact>& contact() const { return contact_; }
  /// Relative reduction of the filler's diameter by passive yielding so far [1]; 0 if it never yielded.
  std::span<const double> slip() const { return slip_; }

  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(begun_);
    visit_values(numbers, strain_, slip_, grains_, lateral_, given_wall_, contact_);
  }
  /// Computes pressure and stress from the state.
  void finish();

 private:
  double stiffness(int ring, double temperature) const;

  const Rings* rings_;
  const Steel* steel_;
  double expansion_, active_ratio_;
  bool begun_;                                    // strains refer to the filler: the wall has responded once
  std::vector<double> fluid_, active_, passive_;  // p_f, K_a p_v, p_v/K_a [Pa]
  std::vector<double> strain_, slip_, grains_;    // strain of the filler [1], its temperature [K]
  std::vector<double> given_wall_;                // temperatures at which the wall was last computed [K]
  std::vector<double> hoop_, lateral_, total_;
  std::vector<Contact> contact_;
};

/// Hoop stress without filler mechanics, from the fluid and the active load.
std::vector<double> active_hoop(const Rings& rings, const Filler& filler, const InnerPressure& pressure);
double rankine_active(const Filler& filler);

/// Computes all stresses from the hoop stress and temperature of the rings.
void wall_stress(const Rings& rings, const Steel& steel, const InnerPressure& pressure,
                 std::span<const double> hoop, std::span<const double> temperature, WallStress& out);

/// Stresses of the rings with bending. The wall is a thin axisymmetric shell [timoshenko1959, chapter 15]
///   d2/dz2 (D d2w/dz2) + E e/a^2 (w - w_m) = 0,   D = E e^3/(12 (1 - nu^2)),
/// with free ends; w_m is the radial displacement of each ring alone (by stress and thermal expansion). The
/// displacement is smoothed over 1/beta, beta^4 = 3 (1 - nu^2)/(a^2 e^2), which bends the wall. A temperature
/// step dT gives an axial stress of 0.293 E alpha dT at both faces (nu = 0.3).
struct WallBending {
  std::vector<double> hoop;   ///< E (w/a - thermal strain), mean over the thickness [Pa]
  std::vector<double> axial;  ///< at the outer face, 6 M/e^2; opposite sign at the inner face [Pa]
};
WallBending wall_bending(const Rings& rings, const Steel& steel, std::span<const double> hoop,
                         std::span<const double> temperature);

/// Largest ratio of equivalent stress to yield strength [1]: of the rings without bending, and of the shell
/// at the worse face, where bending adds -+6 M/e^2 axially and nu times that circumferentially.
struct YieldShares {
  double rings = 0, shell = 0;
};
YieldShares yield_shares(const WallStress& stress, const WallBending& bent, double poissons_ratio);

}  // namespace couplet::thermocline
