// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <span>
#include <vector>

#include "common/coupling/messages.hpp"
#include "coupler/exchange/side.hpp"

namespace couplet::coupler {

/// Sparse matrix between two lists of places distributed over the coupler's ranks. It is built once,
/// including the communication pattern.
class Transfer {
 public:
  struct Entry {
    GlobalIndex target, source;  ///< positions in the lists
    double weight;
  };
  Transfer() = default;
  /// Entries may be given on any rank; equal ones are summed. Collective.
  Transfer(MPI_Comm comm, const coupling::Starts& targets, const coupling::Starts& sources,
           std::vector<Entry> entries);

  /// Maps values at this rank's sources to its targets, `components` each. Collective.
  std::vector<double> apply(std::span<const double> values, int components) const;

 private:
  std::vector<double> fetch(std::span<const double> values, int components) const;

  MPI_Comm comm_ = MPI_COMM_SELF;
  std::size_t n_sources_ = 0;
  std::vector<std::size_t> first_{0};  // start of each target's entries
  std::vector<Index> column_;          // this rank's sources, then those received
  std::vector<double> weight_;
  std::vector<std::vector<std::size_t>> give_;  // by rank: sources of this rank that it needs
  std::vector<int> take_;                       // by rank: number of values received from it
  bool alone_ = true, same_ = false;  // same: each target equals the source at its place, on one rank
};

/// Orders by target, then by source.
inline bool by_row(const Transfer::Entry& a, const Transfer::Entry& b) {
  return a.target != b.target ? a.target < b.target : a.source < b.source;
}

/// Sends each entry to the rank of its target, sorted; equal ones are summed. Collective.
std::vector<Transfer::Entry> by_owner(MPI_Comm comm, const coupling::Starts& targets,
                                      std::vector<Transfer::Entry> entries);
/// Exchanges targets and sources; the weights remain.
std::vector<Transfer::Entry> transposed(std::vector<Transfer::Entry> entries);

/// Entries of the map `first` followed by `second`, where the targets of the former are the sources of the
/// latter, distributed over the ranks as `between`. Entries may be on any rank. Those of the product are on
/// the ranks of `second`, each pair once there. It works row by row, so that each rank stores only its rows
/// of the maps and the product. Collective.
std::vector<Transfer::Entry> product(MPI_Comm comm, const coupling::Starts& between,
                                     const std::vector<Transfer::Entry>& second,
                                     const std::vector<Transfer::Entry>& first);

/// Corners of this rank's faces of a side, in order of the faces, with vertices of any rank.
class FaceCorners {
 public:
  FaceCorners() = default;
  /// Collective.
  FaceCorners(MPI_Comm comm, const Side& side);
  /// False if the participant does not list the corners of its faces. Equal on all ranks.
  bool known() const { return known_; }
  const std::vector<Vec3>& points() const { return points_; }  ///< reference configuration [m]
  Index begin(std::size_t face) const { return offset_[face]; }
  Index end(std::size_t face) const { return offset_[face + 1]; }
  /// Distributes values at vertices to the corners; an empty vector stands for zeros. Collective.
  std::vector<double> values(const std::vector<double>& at_vertices, int components) const;
  const std::vector<Vec3>& reference_areas() const { return areas_; }  ///< out of the participant [m^2]
  /// Face areas out of the participant [m^2] (2-D: edges of 1 m depth) with vertices displaced by
  /// `displacement` [m]. Collective.
  std::vector<Vec3> areas(const std::vector<double>& displacement) const;

 private:
  int dim_ = 3;
  bool known_ = false;
  std::size_t n_vertices_ = 0;
  std::vector<Index> offset_;  // of the corners of each face
  std::vector<Vec3> points_, areas_;
  Transfer to_corners_;
};

/// Interface of a fluid as the wall of a cavity: its flux and swept volume. A fluid with a fixed mesh uses
/// the reference areas.
class CavityWall {
 public:
  /// Throws Error if the side does not list the corners of its faces. Collective.
  CavityWall(MPI_Comm comm, const Side& side, bool moves);

  /// Areas of this rank's faces, out of the fluid [m^2]. Collective.
  std::vector<Vec3> areas(const std::vector<double>& displacement) const {
    return moves_ ? corners_.areas(displacement) : corners_.reference_areas();
  }
  /// Sums over this rank's faces of w . S and |w . S| [m^3/s], with w the mean of a face's corners.
  /// Collective.
  struct Flux {
    double net = 0, size = 0;
  };
  Flux flux(const std::vector<double>& velocity, const std::vector<Vec3>& areas) const;
  /// Volume between two positions of this rank's faces [m^3]: dx . S integrated along straight paths (exact
  /// in 2-D and for triangles). Collective.
  double swept(const std::vector<double>& from, const std::vector<double>& to) const;

 private:
  int dim_;
  bool moves_;
  std::size_t n_values_;  // of a vector at this rank's vertices
  FaceCorners corners_;
};

}  // namespace couplet::coupler
