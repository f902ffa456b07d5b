// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "coupler/exchange/side.hpp"
#include "coupler/mapping/links.hpp"
#include "coupler/parameters/parameters.hpp"
#include "coupler/parameters/schedule.hpp"

namespace couplet::coupler {

/// Throws SolveFailure on all ranks, naming datum, entry and place, if one of the values is not finite.
/// Collective.
void require_finite(MPI_Comm comm, const coupling::Exchange& data, const coupling::Interface& interface,
                    const std::vector<coupling::Interface::Datum>& of, const std::string& who);

/// Findings about two coupled surfaces that need not match, as far as their places show.
struct PlaceReport {
  std::string problem;             ///< empty: none
  std::vector<std::string> notes;  ///< what the user should know
  bool nests = true;               ///< vertices of one side are vertices of the other
};
/// `from` gives motion to `to`: distances are judged against the local face size of both sides, the extents
/// against each other; several vertices that follow one (a staircase) are said. Collective.
PlaceReport judge_places(MPI_Comm comm, const Side& from, const Side& to);

/// Throws Error where a fluid that foresees its walls' answer (it takes its own data back) is asked before them: `group`
/// in the order of a pass.
void check_foreseen(const std::vector<Side>& sides, const Links& links, const Schedule& schedule,
                    const std::vector<std::size_t>& group);

/// judge_places() before the first step, for every giver of motion and its taker; throws Error.
void check_places(MPI_Comm comm, const std::vector<Side>& sides, const Links& links,
                  const MappingParameters& mapping);

/// Size and place of a surface, in the reference configuration: of one participant or of several together.
struct SurfaceFacts {
  std::string names;
  GlobalIndex faces = 0;
  double area = 0;               ///< [m^2]; 2-D: length [m]
  double face = 0;               ///< extent of a face, their mean [m]
  Vec3 centroid = Vec3::Zero();  ///< [m]
  Vec3 spread = Vec3::Zero();    ///< first moments: means of |x - x_c|, |y - y_c|, |z - z_c| [m]
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();  ///< of the vertices [m]
  double extent() const { return (high - low).norm(); }
};
/// Collective.
SurfaceFacts surface_facts(MPI_Comm comm, const std::vector<const Side*>& sides);

/// By how much two surfaces that are the same may differ as meshes: 1 % and what faceting does to a curved surface,
/// (face / extent)^2 of the coarser side (a circle of n chords: 10 / n^2, of which its length needs 1.6 / n^2).
double faceting(const SurfaceFacts& a, const SurfaceFacts& b);

/// The first way in which they differ by more than `limit` of their size, with numbers: area, centroid, first moments,
/// bounding box. Empty: they are the same surface.
std::string difference_of(const SurfaceFacts& a, const SurfaceFacts& b, double limit);

/// Before the first step: surfaces that move together are flagged where they differ; a mesh mover that does not move all
/// of its fluid's interface is refused by Error. Collective.
void compare_surfaces(MPI_Comm comm, const std::vector<Side>& sides, const Links& links,
                      const Schedule& schedule);

}  // namespace couplet::coupler
