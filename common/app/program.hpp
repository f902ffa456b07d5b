// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <string>

#include "common/app/loop/simulation.hpp"
#include "common/config/section.hpp"
#include "common/coupling/mesh_motion.hpp"
#include "common/coupling/participant.hpp"
#include "common/diagnostics/diagnostics.hpp"
#include "common/diagnostics/effects.hpp"

namespace couplet::app {

/// What a program gets to build its participant from, after configuration was validated and MPI set up.
struct ParticipantContext {
  MPI_Comm comm = MPI_COMM_SELF;        ///< the ranks of this participant
  std::string name;                     ///< its key under `participants:`
  std::filesystem::path case_folder;    ///< folder of the YAML: relative paths start here
  std::filesystem::path output_folder;  ///< <output>/<name>, made already
  SimulationParameters simulation;
  bool coupled = false;  ///< false: standalone run
  coupling::Scheme scheme = coupling::Scheme::standalone;
  /// Intercommunicator to the mesh mover (for a fluid) or to the fluid (for a mover); MPI_COMM_NULL without
  /// one.
  MPI_Comm mesh_peer = MPI_COMM_NULL;
  double restart_time = std::numeric_limits<double>::quiet_NaN();  ///< NaN: fresh start
};

/// A fault of the file that a key of a participant names.
struct ProblemOfKey {
  std::string key;   ///< path below the participant: "ambient.file"
  std::string what;  ///< a sentence, with file:line where it can be said
};

/// One program = its name, the declaration of its parameters, and how to make its participant from them.
struct Program {
  std::string name;         ///< "solid_solver"
  std::string description;  ///< one line for --help
  /// Declares the parameters of `participants.<name>`; called for checking, documentation and reading.
  config::Section::Declare declare;
  /// Called once after reading; the parameters are those that `declare` filled.
  std::function<std::unique_ptr<coupling::Participant>(const ParticipantContext&)> make = {};
  /// Adds the diagnostics of the participant, once that is initialised; empty: it has none.
  std::function<void(coupling::Participant&, diagnostics::Diagnostics&)> diagnose = {};
  /// What the program's libraries need from before the participant is made until after it is gone (petsc_environment());
  /// empty: nothing. A program without one links no PETSc, whose libraries take 60 ms to load.
  std::function<std::shared_ptr<void>(MPI_Comm)> environment = {};
  /// What the program can simulate, looked at with the parameters that `declare` filled; empty: not told.
  std::function<std::vector<diagnostics::Effect>(const diagnostics::CaseScene&)> effects = {};
  /// What `simulation.effects: auto` decides where the YAML leaves it open; empty: nothing.
  std::function<std::vector<diagnostics::EffectChoice>(const diagnostics::CaseScene&)> choose = {};
  /// Memory and time of a step to be expected, for --explain; empty: not told.
  std::function<diagnostics::ExpectedCost(const diagnostics::CaseScene&)> expected = {};
  /// For --check: what is wrong with the files that the parameters name; empty: nothing but what every program's
  /// --check sees.
  std::function<std::vector<ProblemOfKey>(const std::filesystem::path& case_folder)> problems_of_files = {};
  /// Reads `coupling` instead of a participant's section, and makes no participant.
  bool is_coupler = false;
};

/// main() of a physics program:
///   prog case.yaml [--participant NAME] [--check] [--docs] [--schema] [--print-config] [--set a.b=v]
///   [--restart FOLDER] [-v|-q]
/// Runs alone (one program in the MPI job) or as part of a coupled job. Returns the exit code.
int run_program(int argc, char** argv, const Program& program);

}  // namespace couplet::app
