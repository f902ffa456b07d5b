// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "common/app/program.hpp"
#include "common/modes/modal_model.hpp"
#include "plate_modal/model/parameters.hpp"

namespace couplet::plate {

/// Where a structure runs.
struct PlateContext {
  MPI_Comm comm = MPI_COMM_SELF;
  std::string name = "plate";
  std::filesystem::path case_folder, output_folder;  ///< output empty: nothing is written
  double restart_time = std::numeric_limits<double>::quiet_NaN();
  double time_step = std::numeric_limits<double>::quiet_NaN();  ///< of the run; NaN: not known
};

/// Structure that the configuration describes.
struct Built {
  modes::ModalModel model;
  std::unique_ptr<PlateModel> plate;  ///< of a mesh, but for a modal analysis; on rank 0
  bool reused = false;                ///< modes of an earlier run
  /// Deflection over thickness from which the stretch of a plate with two held edges matters; 0 if there are none.
  double stretch_limit = 0;
  std::vector<double> kinks;  ///< at blunt corners of hinged edges [rad]
  std::string outline;        ///< what the user should know of the outline, or nothing
  std::string note;           ///< something the user should know, or nothing
};

/// Cells of the mid-surface with their materials, supports of its patches. Throws Error naming zones and
/// patches that the mesh does not have, or that have no entry.
PlateModel plate_of(Midsurface surface, const Parameters& parameters, const std::string& name);

/// Modes of the mesh (from modes.h5 of the output folder if they belong to the same mesh and data), or those
/// of the file that the parameters name. `raw`: mesh on rank 0 in place of that of the parameters.
/// Collective.
Built build_model(const Parameters& parameters, const PlateContext& context,
                  const mesh::RawMesh* raw = nullptr);

/// For --check: modes that are missing, broken or of no structure.
std::vector<app::ProblemOfKey> problems_of_files(const Parameters& parameters,
                                                 const std::filesystem::path& case_folder);

/// Modes of another program, whose surface says by its faces alone where its outside is. Throws Error.
modes::ModalModel modes_of_file(const Parameters& parameters, const std::filesystem::path& file);

/// kappa / S of thesis (4.33) for f_SI = 1: bulk modulus over thickness [N/m^3].
double seat_stiffness(const Parameters& parameters);

}  // namespace couplet::plate
