// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

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

}  // namespace couplet::modes
