// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "coupler/exchange/face_corners.hpp"

namespace couplet::coupler {

/// Of one output: <stem>.<rank>.vtp of as many ranks as the coupler had then.
struct InterfaceFiles {
  double time = 0;
  std::string stem;
  int parts = 0;
};

/// What goes over the interfaces, for ParaView: <participant>.pvd with a VTK file for each output and rank of
/// the coupler. Faces are polygons with the data at faces; data at vertices stand at their corners, each face
/// its own. The surface is the reference configuration; displacements warp it.
class InterfaceOutput {
 public:
  /// `restart_time`: NaN for a fresh start; else later outputs of an earlier run are forgotten. Collective.
  InterfaceOutput(MPI_Comm comm, std::filesystem::path folder, const std::vector<Side>& sides,
                  double restart_time);
  /// What each has given and taken last. Collective.
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
