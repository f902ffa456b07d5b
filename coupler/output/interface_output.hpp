// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "coupler/exchange/face_corners.hpp"

namespace couplet::coupler {

/// Files of one output: <stem>.<rank>.vtp for each rank of the coupler at that time.
struct InterfaceFiles {
  double time = 0;
  std::string stem;
  int parts = 0;
};

/// Writes interface data for ParaView: <participant>.pvd with a VTK file per output and rank of the coupler.
/// Faces are polygons with the face data; vertex data are at corners, separately for each face. The surface
/// is the reference configuration, for warping by displacements.
class InterfaceOutput {
 public:
  /// `restart_time`: NaN for a fresh start; else later outputs of a previous run are removed. Collective.
  InterfaceOutput(MPI_Comm comm, std::filesystem::path folder, const std::vector<Side>& sides,
                  double restart_time);
  /// Writes the data last given and taken. Collective.
  void write(double time, int number, const std::vector<coupling::Exchange>& given,
             const std::vector<coupling::Exchange>& taken);

 private:
  struct Surface {
    const Side* side;
    std::size_t index;  // among all sides
    FaceCorners corners;
    std::vector<InterfaceFiles> files;
  };
  void write_piece(const Surface& surface, const std::filesystem::path& file, const coupling::Exchange& given,
                   const coupling::Exchange& taken) const;
  void write_list(const Surface& surface) const;

  MPI_Comm comm_;
  std::filesystem::path folder_;
  std::vector<Surface> surfaces_;
};

}  // namespace couplet::coupler
