// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "coupler/exchange/side.hpp"
#include "coupler/mapping/links.hpp"
#include "coupler/parameters/parameters.hpp"
#include "coupler/parameters/schedule.hpp"

namespace couplet::coupler {

/// Throws SolveFailure on all ranks, with datum, entry and place, for a value that is not finite. Collective.
void require_finite(MPI_Comm comm, const coupling::Exchange& data, const coupling::Interface& interface,
                    const std::vector<coupling::Interface::Datum>& of, const std::string& who);

/// Findings about two coupled surfaces of any meshes, from their places.
struct PlaceReport {
  std::string problem;             ///< empty if there is none
  std::vector<std::string> notes;  ///< information for the user
  bool nests = true;               ///< vertices of one side are vertices of the other
};
/// `from` gives motion to `to`. Compares distances with the local face size of both sides, and the extents
/// with each other. For a map by the nearest, also whether the vertices nest, and several that follow one (a
/// staircase). Collective.
PlaceReport compare_places(MPI_Comm comm, const Side& from, const Side& to, bool by_nearest);

/// Throws Error if a fluid that predicts its walls' response (it takes its own data) precedes them. `group`:
/// in the order of a pass.
void check_anticipation(const std::vector<Side>& sides, const Links& links, const Schedule& schedule,
                        const std::vector<std::size_t>& group);

/// Calls compare_places() before the first step for each giver of motion and its taker. Throws Error.
void check_places(MPI_Comm comm, const std::vector<Side>& sides, const Links& links,
                  const MappingParameters& mapping);

/// Size and position of a surface of one or more participants in the reference configuration.
struct SurfaceFacts {
  std::string names;
  GlobalIndex faces = 0;
  double area = 0;                               ///< [m^2]; 2-D: length [m]
  double face = 0;                               ///< mean extent of the faces [m]
  Vec3 centroid = Vec3::Zero();                  ///< [m]
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();  ///< of the vertices [m]
  double extent() const { return (high - low).norm(); }
};
/// Collective.
SurfaceFacts surface_facts(MPI_Comm comm, const std::vector<const Side*>& sides);

/// Tolerance for the difference of meshes of the same surface: 1 % plus the faceting of a curved surface,
/// (face/extent)^2 of the coarser side. (A circle of n chords gives 10/n^2, of which its length needs
/// 1.6/n^2.)
double faceting(const SurfaceFacts& a, const SurfaceFacts& b);

/// First quantity that differs by more than `limit` relative to the size: area, centroid, bounding
/// box. Empty if the surfaces are the same.
std::string difference_of(const SurfaceFacts& a, const SurfaceFacts& b, double limit);

/// Checks before the first step: reports differences between surfaces that move together. Throws Error if a
/// mesh mover does not move the whole interface of its fluid. Collective.
void compare_surfaces(MPI_Comm comm, const std::vector<Side>& sides, const Links& links,
                      const Schedule& schedule);

}  // namespace couplet::coupler
