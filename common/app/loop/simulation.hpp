// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/config/section.hpp"
#include "common/io/fields/mesh_part.hpp"

namespace couplet::app {

/// What `simulation:` in the YAML says to every program.
struct SimulationParameters {
  std::string name = "case";
  double end_time = 0, time_step = 0;  // [s]
  int max_step_halvings = 6;           // of a step that fails
  std::vector<std::string> accept;     // ids of findings that may not end the run with exit code 4
  std::string output_folder = "out";   // relative to the YAML's folder unless absolute
  double output_interval = 0;          // [s]; 0: only the start and the end
  bool output_steps = true;            // steps.csv
  io::FieldChoice fields;              // in the volume
  double checkpoint_interval = 0;      // [s]; 0: only at the end
  int checkpoints_kept = 2;
  double hang_timeout = 600;    // [s]; 0: never
  bool error_estimate = true;   // at the end of the run
  bool choose_effects = false;  // what the case leaves open is decided by estimates of the scene
  std::string keys;             // no parameter: the case as text, kept with every checkpoint (see case_keys)
};
void declare(config::Section& section, SimulationParameters& parameters);

}  // namespace couplet::app
