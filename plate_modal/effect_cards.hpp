// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>

#include "common/effects/card.hpp"
#include "plate_modal/model/parameters.hpp"
#include "plate_modal/motion/resolution.hpp"

namespace couplet::plate {

/// What the cards look at: the parameters, and whether a coupler gives the forces of a fluid.
struct PlateScene {
  Parameters parameters;
  bool coupled = false;
  double time_step = std::numeric_limits<double>::quiet_NaN();  ///< [s]; NaN: not known
};

/// What a run has seen. NaN: not seen, or no question for this structure.
struct PlateEvidence {
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  double displacement_over_size = unknown;       ///< of a structure that is held
  double displacement_over_thickness = unknown;  ///< of a plate that is held on two edges or more
  double stretch_limit = 0.5;                    ///< what it may be there
  bool load_lost = false;  ///< prescribed pressures, which were 0 wherever they were taken
  double load_on_modes =
      unknown;  ///< loads of the pressures on the modes over what they would be along their motion
  double rotation = unknown;  ///< of a structure with rigid motions, as a whole [rad]
  double in_plane_share =
      unknown;  ///< of gravity or of the initial velocity of a plate, that no mode answers
  /// Static: difference by modes over the deflection itself; dynamic: share of the loads' compliance without modes.
  double modes_apart = unknown;
  double velocity_lost = unknown;  ///< share of the energy of the initial velocity that no mode has
  double within_faces =
      unknown;                ///< of prescribed pressures, rms over the modes: what the midpoint rule misses
  double mesh_gap = unknown;  ///< corners of a cell against its mean deflection, rms over the motion
  double thickness_over_wave =
      unknown;  ///< over half the wave length of the highest mode that moves, or that is kept
  double energy_mismatch = unknown;  ///< of the largest energy, thesis (4.29)-(4.31)
  StepEvidence step{};
};

using PlateCard = effects::EffectCard<PlateScene, PlateEvidence>;
/// All that a modal structure can simulate beside its modes, in the order in which it is told.
std::span<const PlateCard> plate_effect_cards();

}  // namespace couplet::plate
