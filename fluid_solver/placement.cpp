// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/placement.hpp"

#include <algorithm>
#include <cmath>

namespace couplet::fluid {
namespace {

// Cosine of the angle between S and d below which the over-relaxed coefficient is no longer raised.
constexpr double least_cosine = 0.05;

template <int D>
void set_face(Placement<D>& p, Index f, const Vec<D>& d) {
  const Vec<D>& s = p.area[f];
  const double size = s.norm();
  const double projected = std::max(s.dot(d), least_cosine * size * d.norm());
  p.conductance[f] = size * size / projected;
  p.oblique[f] = s - p.conductance[f] * d;
  p.obliqueness = std::max(p.obliqueness, p.oblique[f].norm() / size);
}

}  // namespace

template <int D>
std::shared_ptr<const Placement<D>> make_placement(const Mesh& mesh, const Geometry& geometry) {
  auto placement = std::make_shared<Placement<D>>();
  Placement<D>& p = *placement;
  const Index n_faces = mesh.n_flux_faces();
  p.volume = geometry.volume;
  p.centre.resize(mesh.cells.n_local());
  for (Index c = 0; c < mesh.cells.n_local(); ++c) p.centre[c] = geometry.cell_centre[c].template head<D>();
  p.area.resize(n_faces);
  for (Index f = 0; f < n_faces; ++f) p.area[f] = geometry.face_area[f].template head<D>();
  p.conductance.resize(n_faces);
  p.oblique.resize(n_faces);
  p.weight.resize(mesh.n_interior);
  p.boundary_centre.assign(geometry.face_centre.begin() + mesh.n_interior,
                           geometry.face_centre.begin() + n_faces);
  for (Index f = 0; f < mesh.n_interior; ++f) {
    const Vec<D>& from = p.centre[mesh.owner[f]];
    const Vec<D> to = p.centre[mesh.neighbour[f]] + mesh.shift(f).template head<D>();
    set_face<D>(p, f, to - from);
    const Vec<D> centre = geometry.face_centre[f].template head<D>();
    const double before = std::abs(p.area[f].dot(centre - from)),
                 after = std::abs(p.area[f].dot(to - centre));
    p.weight[f] = after / (before + after);
  }
  for (Index f = mesh.n_interior; f < n_faces; ++f)
    set_face<D>(p, f, geometry.face_centre[f].template head<D>() - p.centre[mesh.owner[f]]);
  return placement;
}

template std::shared_ptr<const Placement<2>> make_placement<2>(const Mesh&, const Geometry&);
template std::shared_ptr<const Placement<3>> make_placement<3>(const Mesh&, const Geometry&);

}  // namespace couplet::fluid
