// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/modes/modal_model.hpp"

namespace couplet::modes {

/// What is wrong with the sizes and values of a model; empty: nothing.
std::string problem_of(const ModalModel& model);
/// Whether a sound model can belong to a structure: mass above 0, no shape without motion, effective masses within the
/// mass. Empty: nothing is wrong.
std::string impossible_in(const ModalModel& model);
/// Whether two modes overlap, as far as faces that carry the whole mass show it. Empty: they do not.
std::string overlap_problem_of(const ModalModel& model);
/// Whether its shapes can be mass-normalised, as far as the surface shows the mass (a factor of about three where
/// `face_density` stands for half of the mass or more, of a hundred otherwise). Empty: they can.
std::string scale_problem_of(const ModalModel& model);
/// Whether the rows of the shapes go vertex by vertex: shapes read in another order are rough along the edges. Empty:
/// they do.
std::string order_problem_of(const ModalModel& model);
/// Whether the faces make one surface: each with different vertices, every vertex in a face, neighbours turning alike.
/// Empty: they do. The vertices that the faces name must exist.
std::string surface_problem_of(const ModalModel& model);

/// Volume behind the faces of a surface that has two sides, above 0 where the normals point out of it [m^3]: of a closed
/// one by the divergence theorem, of an open one (a plate's clamped rim is not part of its surface) closed by the cone
/// from the middle of its rim. None: a sheet, of which nothing tells the front from the back.
std::optional<double> volume_behind(const ModalModel& model);

/// Where the normals of a structure's surface must point: out of it, or, of the wall of a cavity, into what it encloses.
enum class Facing { outward, inward };

/// Whether the faces of a surface point to the wrong side: neighbours that do not turn alike, and every part that hangs
/// together (vertices of its own or not) by what lies before and behind its faces: an even number of other faces lies
/// before a face of a body, an odd one behind it, so of two sheets each looks away from the other. Where these do not
/// tell, volume_behind() of the part. Empty: all are right, or nothing tells (a sheet alone).
std::string facing_problem_of(const ModalModel& model, Facing wanted = Facing::outward);

}  // namespace couplet::modes
