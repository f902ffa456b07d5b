// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <span>
#include <vector>

#include "common/base/types.hpp"
#include "common/config/section.hpp"
#include "common/coupling/participant.hpp"

namespace couplet {

/// What the solid takes through its interface patches.
struct InterfaceData {
  enum class Load {
    forces,    ///< pressure-force and viscous-force [N]
    pressure,  ///< pressure [Pa], one value a face, pushes into the solid
  };
  Load load = Load::forces;
  bool temperature = false;  ///< temperature [K], one value a face
};
void declare(config::Section& section, InterfaceData& data);

/// The data to announce at the faces of the interface.
std::vector<Interface::Datum> taken(const InterfaceData& data);

/// Temperature given at the faces of the interface, carried into the solid from the nearest face: for walls
/// so thin, or so well insulated, that they have one temperature through their thickness.
class InterfaceTemperature final {
 public:
  /// `centres`: of the interface's faces, on rank 0. Collective.
  InterfaceTemperature(MPI_Comm comm, std::vector<Vec3> centres);

  std::size_t n_faces() const { return centres_.size(); }
  /// The nearest face of each point.
  std::vector<Index> nearest(std::span<const Vec3> points) const;
  /// `on_root`: a value a face on rank 0, empty if nothing was given yet; on every rank after the call.
  std::vector<double> broadcast(std::vector<double> on_root) const;

 private:
  MPI_Comm comm_;
  std::vector<Vec3> centres_;
};

}  // namespace couplet
