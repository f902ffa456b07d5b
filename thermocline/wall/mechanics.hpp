// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "thermocline/wall/shell.hpp"

namespace couplet::thermocline {

/// What presses on the wall from inside, at each ring [Pa].
struct InnerPressure {
  std::vector<double> fluid;     ///< p_f = p_ullage + rho_f g depth (5.13); the ullage's above the bed
  std::vector<double> vertical;  ///< p_v of the buoyant grains (5.14-5.16)
};
/// `temperature`: of the fluid in each cell of the bed, for a fluid whose density follows it; else empty.
InnerPressure inner_pressure(const Rings& rings, const BedGrid& bed, const Fluid& fluid, const Filler& filler,
                             double ullage_gauge, std::span<const double> temperature = {});

/// Stress in the wall of rings (thesis 5.4): sigma_rr = -p_f, sigma_zz = -(weight above)/(pi D e), sigma_tt =
/// p D/(2 e) (5.23). Tension is positive.
struct WallStress {
  std::vector<double> hoop, axial, radial, equivalent, yield;  ///< [Pa]
};

enum class Contact { active, rigid, passive };

/// The filler as a rigid, perfectly plastic, cohesionless bulk (thesis figure 5.4). At each height:
///   active   the wall has moved away and the grains have slumped after it: p_s = K_a p_v (5.17)
///   rigid    the wall cannot shrink below the grains' diameter, which follows their own expansion (5.18)
///   passive  the grains yield: p_s = p_v/K_a (5.19, 5.20), and their diameter follows the wall
/// Strains are logarithms of diameters, from the initial state. The wall's is e = sigma/E + integral of alpha
/// dT, so in contact sigma = E (e_filler - integral of alpha dT), held between the active and the passive
/// value.
class FillerMechanics {
 public:
  /// The wall starts at these temperatures with the active load.
  FillerMechanics(const Rings& rings, const Steel& steel, const Filler& filler, const InnerPressure& pressure,
                  std::span<const double> wall, std::span<const double> grains);

  void update(std::span<const double> wall, std::span<const double> grains);
  /// Another weight of fluid and grains from the next update on.
  void load(const InnerPressure& pressure);
  std::span<const double> hoop() const { return hoop_; }        ///< [Pa]
  std::span<const double> lateral() const { return lateral_; }  ///< p_s [Pa]
  const std::vector<Contact>& contact() const { return contact_; }
  /// What passive yielding has taken from the filler's diameter so far, relative [1]; 0 where it never
  /// yielded.
  std::span<const double> slip() const { return slip_; }
  int ever_passive() const;  ///< rings that have yielded
  /// Radius increase of the filler since the start, relative [1].
  std::span<const double> filler_strain() const { return strain_; }

  std::vector<double> state() const;
  void restore(std::span<const double> state);

 private:
  const Rings* rings_;
  const Steel* steel_;
  double expansion_, active_ratio_;
  std::vector<double> per_pressure_;              // D/(2e) [1]
  std::vector<double> fluid_, active_, passive_;  // p_f, p_f + K_a p_v, p_f + p_v/K_a [Pa]
  std::vector<double> strain_, slip_, grains_;    // of the filler [1], its temperature [K]
  std::vector<double> hoop_, lateral_;
  std::vector<Contact> contact_;
};

/// Without filler mechanics the hoop stress is that of the fluid and the active load.
std::vector<double> active_hoop(const Rings& rings, const Filler& filler, const InnerPressure& pressure);
double rankine_active(const Filler& filler);

/// All stresses from the hoop stress and the temperature of the rings.
void wall_stress(const Rings& rings, const Steel& steel, const InnerPressure& pressure, double roof_pressure,
                 std::span<const double> hoop, std::span<const double> temperature, WallStress& out);

}  // namespace couplet::thermocline
