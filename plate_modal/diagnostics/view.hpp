// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/coupling/participant.hpp"
#include "common/diagnostics/diagnostics.hpp"
#include "plate_modal/model/build_model.hpp"
#include "plate_modal/motion/contact.hpp"
#include "plate_modal/motion/oscillators.hpp"
#include "plate_modal/motion/surface.hpp"

namespace couplet::plate {

/// State of a structure after the last accepted step, as diagnostics see it.
struct PlateView {
  const Parameters& parameters;
  MPI_Comm comm;
  const Built& built;
  const Surface& surface;
  const Oscillators& oscillators;
  const Contact* contact;        ///< nullptr if there is no seat
  const PressureLoad* pressure;  ///< nullptr if the case prescribes no pressures
  const coupling::Step& step;
  const ModalState &before, &state;         ///< at the start and at the end of the step
  const std::vector<double>& displacement;  ///< of the vertices [m], 3 each
  const std::optional<Deflection>& deflection;
  const std::vector<double>& fluid_force;  ///< on the faces [N], 3 each; may be empty

  bool is_dynamic() const { return parameters.analysis == Parameters::Analysis::dynamic; }
  const modes::ModalModel& model() const { return surface.model(); }
  /// Square of the first angular frequency above 0 [1/s^2]; 1 if there is none.
  double first_elastic() const;
  /// Number of cells of the mid-surface, which are the first faces of the surface.
  std::size_t n_cells() const;
};

/// Time at which to examine the loads of the accepted step. In a dynamic analysis it is mid-step, at growing
/// intervals. In a static analysis it is the end, if the result changes.
std::optional<double> sample_time(const PlateView& view);

class Motion;

/// Structure and the motion of its modes, which several diagnostics share.
struct RunOfPlate {
  const PlateView& view;
  std::shared_ptr<Motion> motion;  ///< nullptr in a static or modal analysis
};

// Each makes a diagnostic, or nullptr if it does not apply to the structure.
diagnostics::Made balance_of_energies(const RunOfPlate& run);
diagnostics::Made motion_of_modes(const RunOfPlate& run);
diagnostics::Made impact_on_seat(const RunOfPlate& run);
diagnostics::Made plate_theory(const RunOfPlate& run);
diagnostics::Made truncated_modes(const RunOfPlate& run);
diagnostics::Made mesh_of_modes(const RunOfPlate& run);
diagnostics::Made prescribed_pressures(const RunOfPlate& run);
diagnostics::Made step_error(const RunOfPlate& run);

/// Adds all diagnostics of a structure.
void add_diagnostics(const PlateView& view, diagnostics::Diagnostics& all);

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
/// Reports a neglected effect unless its number is unknown. `share`: see diagnostics::Finding. `limit`: of the number, from which
/// an unknown share is a warning. `id` of the finding, unless it is the name of the effect.
void report_neglected(diagnostics::Report& report, const char* effect, double number, std::string what,
                      std::string advice, double share, double limit = 0, const char* id = "");
/// Reports an effect of the case unless its number is unknown.
void report_present(diagnostics::Report& report, const char* effect, double number, double limit,
                    std::string what, std::string advice,
                    double wrong_from = std::numeric_limits<double>::infinity(), const char* id = "");

}  // namespace couplet::plate
