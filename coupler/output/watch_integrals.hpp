// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "coupler/exchange/face_corners.hpp"
#include "coupler/parameters/parameters.hpp"

namespace couplet::coupler {

/// Integrals over interfaces, or over parts of them, of data that go over them (`coupling.watch`):
///   amounts (N, W)            sum of each component
///   one value a place q       int q dA and its mean
///   a vector q of dim values  int q . n dA, the flux out of the participant: a velocity's is the volume swept [m^3/s]
/// Data at vertices are taken at faces as the mean over the corners. Areas are those of the moved surface where the
/// participant gives or takes a displacement and tells its corners, else those of the reference configuration. 2-D: per metre
/// of depth.
class WatchIntegrals {
 public:
  /// Throws Error for a participant, datum or part that there is not, and for what cannot be integrated. Collective.
  WatchIntegrals(MPI_Comm comm, const std::vector<Side>& sides,
                 const std::map<std::string, WatchParameters>& watched);

  /// "tip force x [N]"
  const std::vector<std::string>& columns() const { return columns_; }
  /// One value a column, the same on all ranks; NaN where a datum has not gone over yet. Collective.
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
