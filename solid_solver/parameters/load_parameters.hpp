// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/base/types.hpp"
#include "common/config/section.hpp"

namespace couplet::solid {

/// Loads by their total: of the patches of type force, remote-load, bearing-load and hydrostatic-pressure. In 2-D forces and
/// moments are those of one metre of depth.
struct TotalLoad {
  std::vector<config::ExpressionText> force;  ///< [N], of t, one a component; empty: none
  std::vector<config::ExpressionText>
      moment;                    ///< about `point` [N m], of t: 3 components, in 2-D 1; empty: none
  Vec3 point = Vec3::Zero();     ///< remote-load: where the force acts [m]
  bool is_rigid = false;         ///< remote-load: the faces move as a rigid body
  double density = 0;            ///< hydrostatic-pressure: of the liquid [kg/m^3]
  std::vector<double> gravity;   ///< hydrostatic-pressure: [m/s^2]
  config::ExpressionText level;  ///< hydrostatic-pressure: height of the free surface [m], of t
};

/// A force and a moment at a point of the surface.
struct PointLoad : TotalLoad {
  double radius = 0;  ///< of the faces that take it [m]; 0: the nearest one does
};

/// `dimension`: of the scene; read before the loads, so it is a reference.
void declare_total_force(config::Section& section, TotalLoad& load, const int& dimension);
void declare_remote_load(config::Section& section, TotalLoad& load, const int& dimension);
void declare_bearing_load(config::Section& section, TotalLoad& load, const int& dimension);
void declare_hydrostatic_pressure(config::Section& section, TotalLoad& load, const int& dimension);
void declare(config::Section& section, PointLoad& load, const int& dimension);

}  // namespace couplet::solid
