// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "coupler/exchange/face_corners.hpp"
#include "coupler/parameters/parameters.hpp"

namespace couplet::coupler {

/// Integrals of transferred data over interfaces or parts of them (`coupling.watch`):
///   amounts (N, W)            sum of each component
///   one value q per place     int q dA and its mean
///   a vector q of dim values  int q . n dA, flux out of the participant; for a velocity the swept volume [m^3/s]
/// Vertex data are averaged over the corners of faces. Areas are those of the moved surface if the
/// participant has a displacement and lists its corners, otherwise of the reference configuration. 2-D: per
/// meter of depth.
class WatchIntegrals {
 public:
  /// Throws Error for a missing participant, datum or part or data without an integral. Collective.
  WatchIntegrals(MPI_Comm comm, const std::vector<Side>& sides,
                 const std::map<std::string, WatchParameters>& watched);

  /// For example "tip force x [N]".
  const std::vector<std::string>& columns() const { return columns_; }
  /// One value per column, equal on all ranks; NaN for a datum not yet transferred. Collective.
  std::vector<double> row(const std::vector<coupling::Exchange>& given,
                          const std::vector<coupling::Exchange>& taken) const;

 private:
  enum class Kind { amount, scalar, flux };
  struct Surface {
    std::size_t side;
    int dim;
    FaceCorners corners;
    bool moves;  // areas follow the displacement
  };
  struct Integral {
    std::size_t surface;
    Kind kind;
    coupling::Interface::Datum datum;
    std::vector<bool> counts;  // by face (vertex for amounts there) of this rank
    std::size_t columns;
  };
  Integral integral_of(const std::string& name, const WatchParameters& p, const Side& side,
                       const Surface& surface) const;
  std::vector<Vec3> areas(const Surface& s, const coupling::Exchange& given,
                          const coupling::Exchange& taken) const;
  void add_up(const Integral& i, const std::vector<double>& values, const std::vector<Vec3>& areas,
              double* sums) const;

  MPI_Comm comm_;
  std::vector<Surface> surfaces_;
  std::vector<Integral> integrals_;
  std::vector<std::string> columns_;
};

}  // namespace couplet::coupler
