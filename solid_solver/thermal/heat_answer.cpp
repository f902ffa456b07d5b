// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/thermal/heat_answer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/error.hpp"

namespace couplet::solid {

HeatState HeatAnswer::field(std::vector<double> sources, std::vector<double> known) const {
  if (!heat_.is_steady() || heat_.properties_vary_ || heat_.state_.steps == 0)
    throw Error("Only a steady temperature that was solved for, with constant conductivity, has a dual.");
  HeatState answer;
  answer.known = std::move(known);
  heat_.conduction_.subtract_known({heat_.conductivity_, heat_.transfer_, heat_.capacity_, 1}, answer.known,
                                   sources);
  std::vector<double> unknowns(sources.size(), 0);
  heat_.solver_->solve(sources, unknowns);
  const auto n_owned = std::size_t(heat_.mesh_->cells.n_owned());
  answer.cells.assign(std::size_t(heat_.mesh_->cells.n_local()), 0);
  answer.boundary.assign(std::size_t(heat_.mesh_->boundary.n_local()), 0);
  std::copy_n(unknowns.begin(), n_owned, answer.cells.begin());
  const auto& faces = heat_.conduction_.flux_faces();
  for (std::size_t i = 0; i < faces.size(); ++i)
    answer.boundary[std::size_t(faces[i] - heat_.mesh_->n_interior)] = unknowns[n_owned + i];
  const auto& fixed = heat_.conduction_.known_faces();
  for (std::size_t i = 0; i < fixed.size(); ++i)
    answer.boundary[std::size_t(fixed[i] - heat_.mesh_->n_interior)] =
        answer.known[heat_.conduction_.known_points().size() + i];
  heat_.mesh_->cells.update_ghosts(answer.cells);
  heat_.mesh_->boundary.update_ghosts(answer.boundary);
  heat_.conduction_.join_twins(answer.boundary);
  return answer;
}

std::vector<double> HeatAnswer::transfer() const {
  std::vector<double> all = heat_.transfer_;
  for (std::size_t i = 0; i < all.size(); ++i)
    all[i] *= heat_.geometry_->face_area[heat_.conduction_.flux_faces()[i]].norm();
  return all;
}

// The mean of the values at the faces, by the volumes of their pyramids, is 3 / dim times as far from the centre's value as that of a
// source of second order in a regular cell.
std::vector<double> HeatAnswer::source_missed() const {
  std::vector<double> missed;
  if (heat_.source_.is_zero()) return missed;
  missed.assign(std::size_t(heat_.mesh_->cells.n_owned()), 0);
  const mesh::Geometry& g = *heat_.geometry_;
  const auto add = [&](Index c, Index f, const Vec3& shift) {
    if (c >= heat_.mesh_->cells.n_owned()) return;
    const Vec3 at = g.face_centre[f] - shift;
    const double pyramid = std::abs(g.face_area[f].dot(at - g.cell_centre[c])) / heat_.mesh_->dim;
    missed[std::size_t(c)] +=
        heat_.mesh_->dim / 3. * pyramid *
        (heat_.source_(at, heat_.state_.time) - heat_.source_(g.cell_centre[c], heat_.state_.time));
  };
  for (Index f = 0; f < heat_.mesh_->n_flux_faces(); ++f) {
    add(heat_.mesh_->owner[f], f, Vec3::Zero());
    if (f < heat_.mesh_->n_interior) add(heat_.mesh_->neighbour[f], f, heat_.mesh_->shift(f));
  }
  return missed;
}

}  // namespace couplet::solid
