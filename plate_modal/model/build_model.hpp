// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "common/app/program.hpp"
#include "common/modes/modal_model.hpp"
#include "plate_modal/model/parameters.hpp"

namespace couplet::plate {

/// Communicator, name, folders and time step of a structure.
struct PlateContext {
  MPI_Comm comm = MPI_COMM_SELF;
  std::string name = "plate";
  std::filesystem::path case_folder, output_folder;  ///< no files are written if output_folder is empty
  double restart_time = std::numeric_limits<double>::quiet_NaN();
  double time_step = std::numeric_limits<double>::quiet_NaN();  ///< of the run; NaN if unknown
};

/// Structure described by the configuration.
struct Built {
  modes::ModalModel model;
  std::unique_ptr<PlateModel> plate;  ///< from a mesh, except in a modal analysis; on rank 0
  bool reused = false;                ///< modes come from an earlier run
  /// Ratio of deflection to thickness at which stretching of a plate with two held edges matters; 0 if none.
  double stretch_limit = 0;
  std::vector<double> kinks;  ///< at blunt corners of hinged edges [rad]
  std::string outline;        ///< information about the outline for the user; may be empty
  std::string note;           ///< information for the user; may be empty
};

/// Mesh of the parameters with scaled lengths, only on this rank. A drawing is meshed in this many dimensions.
mesh::RawMesh read_raw(const Parameters& parameters, const std::filesystem::path& case_folder, int dimension);

/// Assigns materials to cells and supports to patches of the mid-surface. Throws Error with zones and patches
/// that are missing in the mesh or have no entry.
PlateModel plate_of(Midsurface surface, const Parameters& parameters, const std::string& name);

/// Computes modes of the mesh, or reads them from modes.h5 of the output folder if mesh and data match, or
/// from the file of the parameters. `raw`: mesh on rank 0 instead of that of the parameters. Collective.
Built build_model(const Parameters& parameters, const PlateContext& context,
                  const mesh::RawMesh* raw = nullptr);

/// Mode files that are missing, corrupt or of no structure, for --check.
std::vector<app::ProblemOfKey> problems_of_files(const Parameters& parameters,
                                                 const std::filesystem::path& case_folder);

/// Modes of another program, with face orientations that define the outside. Throws Error.
modes::ModalModel modes_of_file(const Parameters& parameters, const std::filesystem::path& file);

/// kappa / S of thesis (4.33) for f_SI = 1: bulk modulus over thickness [N/m^3].
double seat_stiffness(const Parameters& parameters);

}  // namespace couplet::plate
