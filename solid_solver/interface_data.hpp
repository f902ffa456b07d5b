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
  bool temperature = false;      ///< temperature [K], one value a face
  bool surface_density = false;  ///< gives the mass per area behind its faces [kg/m^2]
};
void declare(config::Section& section, InterfaceData& data);

/// The mass of the body over the area of its interface [kg/m^2]: what answers to a pressure that changes on all of
/// these faces at once, the density times the thickness of a wall that is wet on one side and half of it on both.
/// `densities`, `volumes`: of this rank's cells; `areas`: of its faces of the interface. Collective.
double surface_density(MPI_Comm comm, std::span<const double> densities, std::span<const double> volumes,
                       std::span<const Vec3> areas);

/// The data to announce at the faces of the interface.
std::vector<Interface::Datum> taken(const InterfaceData& data);

/// How points of the solid get their temperature from the faces of the interface: that of the nearest face
/// and a gradient along the interface, held within the values of the faces that it is made from.
///   T(x) = T_a + sum_k weight_k (T_k - T_a), between the least and the largest of T_a, T_k
class FaceInterpolation {
 public:
  /// Gradients by least squares over the nearest faces of each face; in directions in which these do not
  /// extend (through the wall, across a strip of one face's width) there is none.
  FaceInterpolation() = default;
  FaceInterpolation(std::span<const Vec3> centres, std::span<const Vec3> points);
  std::size_t size() const { return nearest_.size(); }
  bool empty() const { return nearest_.empty(); }
  double value(std::size_t point, std::span<const double> faces) const;

 private:
  std::vector<Index> nearest_, first_, face_;  // first_: where the faces of a point begin, and one more
  std::vector<double> weight_;
};

/// Temperature given at the faces of the interface, carried into the solid along the interface: for walls
/// so thin, or so well insulated, that they have one temperature through their thickness.
class InterfaceTemperature final {
 public:
  /// `centres`: of this rank's faces of the interface. Collective.
  InterfaceTemperature(MPI_Comm comm, const std::vector<Vec3>& centres);

  std::size_t n_faces() const { return centres_.size(); }
  FaceInterpolation at(std::span<const Vec3> points) const { return {centres_, points}; }
  /// `here`: a value a face of this rank, empty if nothing was given yet; those of all ranks after the call.
  std::vector<double> everywhere(const std::vector<double>& here) const;

 private:
  MPI_Comm comm_;
  std::vector<Vec3> centres_;
};

}  // namespace couplet
