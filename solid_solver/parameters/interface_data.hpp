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

/// Data that the solid takes and gives at its interface patches.
struct InterfaceData {
  enum class Load {
    forces,    ///< pressure-force and viscous-force [N]
    pressure,  ///< pressure [Pa], one value per face, positive into the solid
  };
  Load load = Load::forces;
  bool temperature = false;  ///< temperature [K], one value per face
};
void declare(config::Section& section, InterfaceData& data);

/// Data to declare at the interface faces.
std::vector<coupling::Interface::Datum> taken(const InterfaceData& data);

/// Interpolates the temperature from interface faces to points of the solid. Uses the nearest face and a
/// gradient along the interface, limited to the values of the faces involved.
///   T(x) = T_a + sum_k weight_k (T_k - T_a), between the smallest and the largest of T_a, T_k
class FaceInterpolation {
 public:
  /// Computes gradients by least squares over the nearest faces of each face. The gradient is zero in
  /// directions without extent (through the wall, across a strip one face wide).
  FaceInterpolation() = default;
  FaceInterpolation(const std::vector<Vec3>& centres, std::span<const Vec3> points);
  std::size_t size() const { return nearest_.size(); }
  double value(std::size_t point, std::span<const double> faces) const;
  /// Calls `change` with each face used by a value; it may renumber the face.
  template <class Change>
  void for_each_face(const Change& change) {
    for (std::vector<Index>* faces : {&nearest_, &face_})
      for (Index& f : *faces) change(f);
  }

 private:
  std::vector<Index> nearest_, first_, face_;  // first_: start of the faces of each point, and the end
  std::vector<double> weight_;
};

/// Temperature at interface faces, continued into the solid along the interface. Suitable for walls so thin
/// or so well insulated that the temperature is constant through the thickness. A rank stores its own faces
/// and those of other ranks near its places.
class InterfaceTemperature final {
 public:
  /// `centres`: centers of this rank's interface faces; some rank must have some. `places`: groups of this rank's
  /// points that need a temperature. Collective.
  InterfaceTemperature(MPI_Comm comm, const std::vector<Vec3>& centres,
                       const std::vector<std::span<const Vec3>>& places);

  /// `here`: one value per face of this rank. Returns these and the values needed from other ranks; empty if
  /// no rank has any. Throws Error on all ranks for a wrong number. Collective.
  std::vector<double> with_others(const std::vector<double>& here) const;
  /// Number of values that with_others() returns.
  std::size_t n_faces() const { return std::size_t(faces_.n_local()); }
  /// Interpolation for the places of a group, from the result of with_others().
  const FaceInterpolation& at(std::size_t group) const { return at_[group]; }

 private:
  MPI_Comm comm_;
  parallel::IndexMap faces_;
  std::vector<FaceInterpolation> at_;
};

}  // namespace couplet::solid
