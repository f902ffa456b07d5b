// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "common/time/time_scheme.hpp"
#include "solid_solver/solid.hpp"
#include "solid_solver/solution_method.hpp"

namespace couplet {

/// What belongs to one size of the inertia term: factors and preconditioners are made once for it.
struct Solid::System {
  double mass_factor;                      ///< (d + alpha c) / s, see Solid [1/s^2]; 0: static
  std::vector<double> inertia;             ///< per owned cell: mass factor times mass [N/m]; empty: static
  std::unique_ptr<SolutionMethod> method;  ///< null: finite strain has its own
  std::vector<double> node_inertia;        ///< of finite strain: of the unknown nodes; empty: static
};

/// A stage of the step under way, with all that does not depend on the interface load.
struct Solid::StageWork {
  Stage stage;
  double damping_scale = 1;  ///< s = 1 + beta c
  System* system = nullptr;
  double start_time = 0, place_time = 0, end_time = 0;
  std::vector<double> rhs;          ///< loads and prescribed displacements, without face forces and inertia;
                                    ///< empty: none
  std::vector<double> known_force;  ///< what `rhs` holds of the prescribed displacements; empty: none
  std::vector<double> known;        ///< prescribed w, one a known column
  // If energies are wanted: rows of body forces and effects, change of the prescribed displacements.
  std::vector<double> loads, known_change;
  std::vector<double> face_force;  ///< loads but the interface's, per boundary face of owned cells
};

}  // namespace couplet
