// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/config/section.hpp"
#include "common/io/fields/mesh_part.hpp"

namespace couplet::app {

/// Parameters of `simulation:` in the YAML for every program.
struct SimulationParameters {
  std::string name = "case";
  double end_time = 0, time_step = 0;  // [s]
  int max_step_halvings = 6;           // halvings of a failed step
  std::vector<std::string> accept;     // ids of findings that do not cause exit code 4
  double neglected_share = 0.05;       // of the result, from which a neglected effect matters
  std::string output_folder = "out";   // relative to the YAML's folder unless absolute
  double output_interval = 0;          // [s]; 0 means only at the start and at the end
  bool output_steps = true;            // steps.csv
  io::FieldChoice fields;              // volume fields
  double checkpoint_interval = 0;      // [s]; 0 for only at the end
  int checkpoints_kept = 2;
  double hang_timeout = 600;    // [s]; 0 for never
  bool error_estimate = true;   // at the end of the run
  bool choose_effects = false;  // estimates of the scene decide what the case leaves open
  std::string keys;             // case as text, stored with every checkpoint (see case_keys)
};
void declare(config::Section& section, SimulationParameters& parameters);

}  // namespace couplet::app
