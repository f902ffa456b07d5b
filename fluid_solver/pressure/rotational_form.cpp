// SPDX-License-Identifier: Apache-2.0
// Rotational form of the projection: the friction of the velocity that the projection adds, as a pressure.
#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "fluid_solver/pressure/pressure.hpp"

namespace couplet::fluid {

/// The projection changes the velocity by (dt/rho) grad psi, psi = p - p~, whose friction the implicit predictor did not know. As a
/// pressure it is -a dt nu L psi = -a mu div u^p, up to layers at walls (rotational form [guermond2006]). At an opening its pressure
/// is given, which is unstable, so that it fades where friction reaches within a step.
template <int D>
void PressureProjection<D>::set_rotational() {
  out_.rotational.clear();
  if (prediction_.weight == 0 || !step_.guess || !scene_.has_smooth_excess()) return;
  if (!std::exchange(knows_distances_, true)) set_distances();
  const Placement<D>& at = *step_.to;
  std::vector<double> psi = out_.p;
  for (std::size_t c = 0; c < psi.size(); ++c) psi[c] -= step_.guess->p[c];
  out_.rotational.assign(psi.size(), 0.0);
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
    double flux = at.conductance[f] * (psi[n] - psi[p]);
    if (!at.oblique.empty()) {  // the over-relaxed g would count the oblique part twice
      const double square = at.area[f].squaredNorm();
      flux *= square / (square + at.oblique[f].squaredNorm());
    }
    out_.rotational[p] -= flux;
    out_.rotational[n] += flux;
  }
  const double spread = scene_.fluid.nu * step_.dt;
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
    out_.rotational[c] *=
        prediction_.weight * spread / at.volume[c] * std::min(1., to_opening_[c] / (4 * spread));
  mesh_.cells.update_ghosts(out_.rotational);
}

/// On the mesh as read, and to the box around each opening.
template <int D>
void PressureProjection<D>::set_distances() {
  const mesh::Geometry rest = mesh::compute_geometry(mesh_, scene_.points_at_rest);
  to_opening_.assign(mesh_.cells.n_local(), std::numeric_limits<double>::max());
  for (const mesh::Patch& patch : mesh_.patches) {
    std::vector<Vec3> openings;
    for (Index f = patch.first; f < std::min(patch.first + patch.count, mesh_.n_flux_faces()); ++f)
      if (scene_.boundary.rows().pressure[f - mesh_.n_interior] > 0) openings.push_back(rest.face_centre[f]);
    const mesh::Extent box = mesh::extent_of(mesh_.comm, openings);
    if (!(box.lower.x() <= box.upper.x())) continue;
    for (std::size_t c = 0; c < to_opening_.size(); ++c) {
      const Vec3& x = rest.cell_centre[c];
      to_opening_[c] =
          std::min(to_opening_[c], (x - x.cwiseMax(box.lower).cwiseMin(box.upper)).squaredNorm());
    }
  }
}

template <int D>
void PressureProjection<D>::add_rotational(PressureLevel<D>& level) const {
  for (std::size_t c = 0; c < level.p.size(); ++c) level.p[c] += out_.rotational[c];
  for (const Index b : scene_.boundary.rows().of_flux)
    level.boundary[b] += out_.rotational[mesh_.owner[mesh_.n_interior + b]];
  set_gradient(*step_.to, level, nullptr);
}

template void PressureProjection<2>::set_rotational();
template void PressureProjection<3>::set_rotational();
template void PressureProjection<2>::add_rotational(PressureLevel<2>&) const;
template void PressureProjection<3>::add_rotational(PressureLevel<3>&) const;

}  // namespace couplet::fluid
