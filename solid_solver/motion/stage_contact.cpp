// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/motion/stage_contact.hpp"

namespace couplet::solid {

namespace {

/// Part of a displacement independent of w, from levels `shown` of x = (w - beta v_h)/s.
std::vector<double> known_part(const SolidBody& body, const StageWork& work, const time::Levels& shown,
                               const SolidState& now, const SolidState& start) {
  const mesh::Mesh& mesh = body.mesh();
  const double beta = body.parameters().damping ? body.parameters().damping->stiffness : 0;
  const time::Levels rest = time::Levels{0, shown.u, shown.v, shown.a, shown.u_old, shown.v_old} -
                            (shown.x * beta / work.damping_scale) * work.stage.rate;
  std::vector<double> cells(std::size_t(mesh.cells.n_local()) * mesh.dim, 0),
      faces(std::size_t(mesh.boundary.n_local()) * mesh.dim, 0);
  const History of_cells(now, start, false), of_faces(now, start, true);
  for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = of_cells(rest, i);
  for (std::size_t i = 0; i < faces.size(); ++i) faces[i] = of_faces(rest, i);
  return body.unknowns_of(cells, faces);
}

}  // namespace

std::optional<Pressing> pressing_of(const SolidBody& body, const StageWork& work, const SolidState& now,
                                    const SolidState& start) {
  const Seat* seat = body.seat();
  if (!seat) return {};
  const std::size_t n_known = body.prescribed().size() * body.mesh().dim;
  std::vector<double> known_before(n_known, 0), known_shown(n_known, 0);
  if (!body.is_dynamic()) {
    const std::vector<double> still(body.elastic().n_unknowns(), 0);
    return Pressing(*seat, 1, seat->penetration(still, {}), {});
  }
  const bool conserves = seat->is_conserving();
  const time::Levels shown = conserves ? work.stage.end_value : time::Levels{1, 0, 0, 0, 0, 0};
  const double factor = shown.x / work.damping_scale;
  if (!body.prescribed().is_zero()) {
    body.prescribed().evaluate(work.start_time, known_before);
    body.prescribed().evaluate(work.end_time, known_shown);
    const double place = conserves ? 1 : work.stage.place;
    for (std::size_t i = 0; i < n_known; ++i)
      known_shown[i] = known_before[i] + place * (known_shown[i] - known_before[i]) - factor * work.known[i];
  }
  std::vector<double> base = seat->penetration(known_part(body, work, shown, now, start), known_shown),
                      before;
  if (conserves) before = seat->penetration(body.unknowns_of(now.cell_u, now.face_u), known_before);
  return Pressing(*seat, factor, std::move(base), std::move(before));
}

}  // namespace couplet::solid
