// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <string>

#include "common/app/loop/step_loop.hpp"
#include "common/config/section.hpp"
#include "common/coupling/mesh_motion.hpp"
#include "common/coupling/participant.hpp"
#include "common/diagnostics/choices.hpp"
#include "common/diagnostics/diagnostics.hpp"
#include "common/mesh/distributed/mesh_block.hpp"

namespace couplet::app {

/// Data for building a participant, after the configuration was validated and MPI set up.
struct ParticipantContext {
  MPI_Comm comm = MPI_COMM_SELF;        ///< the ranks of this participant
  std::string name;                     ///< its key under `participants:`
  std::filesystem::path case_folder;    ///< folder of the YAML; relative paths refer to it
  std::filesystem::path output_folder;  ///< <output>/<name>, exists
  SimulationParameters simulation;
  bool coupled = false;  ///< false in a standalone run
  coupling::Scheme scheme = coupling::Scheme::standalone;
  /// Intercommunicator to the mesh mover (for a fluid) or to the fluid (for a mover), or MPI_COMM_NULL.
  MPI_Comm mesh_peer = MPI_COMM_NULL;
  double restart_time = std::numeric_limits<double>::quiet_NaN();  ///< NaN for a fresh start
  bool loads_at_rest = false;                                      ///< see Job::has_linear_structures()
};

/// Problem with a file that a participant's key names.
struct ProblemOfKey {
  std::string key;   ///< path below the participant: "ambient.file"
  std::string what;  ///< a sentence, with file:line if available
};

/// Program: its name, the declaration of its parameters and a factory of its participant.
struct Program {
  std::string name;         ///< "solid_solver"
  std::string description;  ///< one line for --help
  /// Declares the parameters of `participants.<name>`. Called for checking, documentation and reading.
  config::Section::Declare declare;
  /// Creates the participant. Called once after reading with the parameters that `declare` filled.
  std::function<std::unique_ptr<coupling::Participant>(const ParticipantContext&)> make = {};
  /// Adds the diagnostics of an initialized participant. Empty if there are none.
  std::function<void(coupling::Participant&, diagnostics::Diagnostics&)> diagnose = {};
  /// Holds libraries while the participant exists (petsc_environment()), or is empty. Programs without it do
  /// not link PETSc, which takes 60 ms to load.
  std::function<std::shared_ptr<void>(MPI_Comm)> environment = {};
  /// Facts of the mesh that the parameters name in this folder. Empty if the program has no mesh.
  std::function<mesh::MeshFacts(const std::filesystem::path&)> mesh = {};
  /// Makes the decisions of `simulation.effects: auto` that the YAML leaves open. Empty if there are none.
  std::function<std::vector<diagnostics::EffectChoice>(const mesh::MeshFacts&, const diagnostics::CaseScene&)>
      choose = {};
  /// Finds problems of the files that the parameters name, for --check. If empty, only the general checks are
  /// done.
  std::function<std::vector<ProblemOfKey>(const diagnostics::CaseScene&)> problems_of_files = {};
  /// Reads `coupling` instead of a participant's section and creates no participant.
  bool is_coupler = false;
};

/// Entry point of a physics program, which runs alone or as part of a coupled job:
///   prog case.yaml [--participant NAME] [--check] [--docs] [--schema] [--print-config] [--set a.b=v]
///   [--restart FOLDER] [-v|-q]
/// Returns the exit code.
int run_program(int argc, char** argv, const Program& program);

}  // namespace couplet::app
