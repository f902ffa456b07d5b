// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <span>
#include <vector>

#include "common/base/types.hpp"
#include "common/config/section.hpp"
#include "common/coupling/participant.hpp"
#include "common/parallel/index_map.hpp"

namespace couplet::solid {

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

/// What answers to a pressure that changes on all faces of the interface at once.
struct WallImpedance {
  double mass = 0;      ///< of the body over the area of its interface [kg/m^2]
  double crossing = 0;  ///< thickness (volume over that area) over the speed of pressure waves [s]

  /// What of the mass answers within a step [kg/m^2]: mass tanh(x)/x, x = 2 crossing / dt. That is Z dt/2 with the impedance
  /// Z(s) = rho c tanh(s h/c) of a layer of thickness h, free behind, at s = 2/dt: all of it in long steps, rho c dt/2
  /// where the wave does not get through.
  double in_step(double dt) const;
};
/// The density times the thickness of a wall that is wet on one side, half of it on both. `densities`, `speeds` (of pressure
/// waves; infinite: rigid), `volumes`: of this rank's cells; `areas`: of its faces of the interface. Collective.
WallImpedance wall_impedance(MPI_Comm comm, std::span<const double> densities, std::span<const double> speeds,
                             std::span<const double> volumes, std::span<const Vec3> areas);

/// The data to announce at the faces of the interface.
std::vector<coupling::Interface::Datum> taken(const InterfaceData& data);

/// How points of the solid get their temperature from the faces of the interface: that of the nearest face
/// and a gradient along the interface, held within the values of the faces that it is made from.
///   T(x) = T_a + sum_k weight_k (T_k - T_a), between the least and the largest of T_a, T_k
class FaceInterpolation {
 public:
  /// Gradients by least squares over the nearest faces of each face; in directions in which these do not
  /// extend (through the wall, across a strip of one face's width) there is none.
  FaceInterpolation() = default;
  FaceInterpolation(const std::vector<Vec3>& centres, std::span<const Vec3> points);
  std::size_t size() const { return nearest_.size(); }
  double value(std::size_t point, std::span<const double> faces) const;
  /// Calls `change` with each face that a value is made from; it may give it another number.
  template <class Change>
  void for_each_face(const Change& change) {
    for (std::vector<Index>* faces : {&nearest_, &face_})
      for (Index& f : *faces) change(f);
  }

 private:
  std::vector<Index> nearest_, first_, face_;  // first_: where the faces of a point begin, and one more
  std::vector<double> weight_;
};

/// Temperature given at the faces of the interface, carried into the solid along the interface: for walls
/// so thin, or so well insulated, that they have one temperature through their thickness. A rank holds the values
/// of its own faces and of those others' that its places are near to.
class InterfaceTemperature final {
 public:
  /// `centres`: of this rank's faces of the interface, of which there are some on some rank; `places`: groups of this
  /// rank's points that want a temperature. Collective.
  InterfaceTemperature(MPI_Comm comm, const std::vector<Vec3>& centres,
                       const std::vector<std::span<const Vec3>>& places);

  /// `here`: a value a face of this rank. Returns these and those of other ranks that the places need; empty if no rank
  /// was given any. Throws Error on all ranks where the number is wrong. Collective.
  std::vector<double> with_others(const std::vector<double>& here) const;
  /// Values that with_others() returns.
  std::size_t n_faces() const { return std::size_t(faces_.n_local()); }
  /// For the places of a group, from what with_others() returned.
  const FaceInterpolation& at(std::size_t group) const { return at_[group]; }

 private:
  MPI_Comm comm_;
  parallel::IndexMap faces_;
  std::vector<FaceInterpolation> at_;
};

}  // namespace couplet::solid
