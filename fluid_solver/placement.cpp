// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/placement.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "common/parallel/collective.hpp"

namespace couplet::fluid {
namespace {

// Cosine of the angle between S and d below which the over-relaxed coefficient is no longer raised.
constexpr double least_cosine = 0.05;
// Skewness, in distances of the cells, below which it is round-off.
constexpr double least_skewness = 1e-6;
// A cell whose gradient cannot be cured: too few of its faces say something.
constexpr double least_determinant = 0.1;

template <int D>
void set_face(Placement<D>& p, Index f, const Vec<D>& d) {
  const Vec<D>& s = p.area[f];
  const double square = s.squaredNorm(), lengths = square * d.squaredNorm();
  double projected = s.dot(d);
  if (projected <= 0 || projected * projected < least_cosine * least_cosine * lengths)
    projected = least_cosine * std::sqrt(lengths);
  p.conductance[f] = square / projected;
  p.oblique[f] = s - p.conductance[f] * d;
  const double oblique = p.oblique[f].squaredNorm();
  if (oblique > p.obliqueness * p.obliqueness * square) p.obliqueness = std::sqrt(oblique / square);
}

template <int D>
void cure_gradients(const Mesh& mesh, const Geometry& geometry, Placement<D>& p) {
  p.gradient_cure.assign(mesh.cells.n_local(), Tensor<D>::Zero());
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    const Index owner = mesh.owner[f];
    Vec<D> place = geometry.face_centre[f].template head<D>();
    if (f < mesh.n_interior) {
      place -= p.skew[f];
      const Index n = mesh.neighbour[f];
      const Vec<D> to = p.centre[n] + mesh.shift(f).template head<D>();
      p.gradient_cure[n] -= (place - to) * p.area[f].transpose();
    }
    p.gradient_cure[owner] += (place - p.centre[owner]) * p.area[f].transpose();
  }
  for (Index c = 0; c < mesh.cells.n_local(); ++c) {
    const Tensor<D> sum = p.gradient_cure[c] / p.volume[c];  // of ghosts: without their outer faces, not used
    p.gradient_cure[c] =
        sum.determinant() > least_determinant ? Tensor<D>(sum.inverse()) : Tensor<D>::Identity();
  }
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
  p.skew.resize(mesh.n_interior);
  p.boundary_centre.assign(geometry.face_centre.begin() + mesh.n_interior,
                           geometry.face_centre.begin() + n_faces);
  double skewness = 0;
  for (Index f = 0; f < mesh.n_interior; ++f) {
    const Vec<D>& from = p.centre[mesh.owner[f]];
    const Vec<D> to = p.centre[mesh.neighbour[f]] + mesh.shift(f).template head<D>();
    set_face<D>(p, f, to - from);
    const Vec<D> centre = geometry.face_centre[f].template head<D>();
    const double before = std::abs(p.area[f].dot(centre - from)),
                 after = std::abs(p.area[f].dot(to - centre));
    p.weight[f] = after / (before + after);
    p.skew[f] = centre - p.weight[f] * from - (1 - p.weight[f]) * to;
    const double off = p.skew[f].squaredNorm(), apart = (to - from).squaredNorm();
    if (off > skewness * apart) skewness = off / apart;
  }
  for (Index f = mesh.n_interior; f < n_faces; ++f)
    set_face<D>(p, f, geometry.face_centre[f].template head<D>() - p.centre[mesh.owner[f]]);
  if (std::sqrt(max(mesh.comm, skewness)) > least_skewness)
    cure_gradients(mesh, geometry, p);
  else
    Vectors<D>().swap(p.skew);
  if (p.obliqueness <= orthogonal) Vectors<D>().swap(p.oblique);
  return placement;
}

template std::shared_ptr<const Placement<2>> make_placement<2>(const Mesh&, const Geometry&);
template std::shared_ptr<const Placement<3>> make_placement<3>(const Mesh&, const Geometry&);

}  // namespace couplet::fluid
