// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/state/state.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

#include "common/base/processor_clones.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::fluid {

namespace {

// Cosine of the angle between S and d below which the over-relaxed coefficient is no longer raised.
constexpr double least_cosine = 0.05;
// Skewness, in distances of the cells, below which it is round-off.
constexpr double least_skewness = 1e-6;
// A cell whose gradient cannot be corrected has too few informative faces.
constexpr double least_determinant = 0.1;
// Skewness in lengths of a cell up to which it is corrected in full, and beyond which not at all.
constexpr double full_skewness = 1. / 3, no_skewness = 0.5;
// Ratio of the lengths of a cell up to which nothing is limited, and from which on everything. In a cell of about equal
// lengths the correction is no larger than the differences of neighbors, and without it the operators are not
// consistent there: the diagonals of an O-grid miss their faces by 0.8 lengths.
constexpr double thick = 10, thin = 20;
// Ratio of the distances of two cells from their face up to which their mean flux is as exact as that of equal cells, and
// from which on it is the transpose of the pressure's interpolation.
constexpr double similar = 3, different = 10;

template <class T>
std::span<double> doubles_of(std::vector<T>& values) {
  if constexpr (std::is_same_v<T, double>)
    return values;
  else
    return {values.empty() ? nullptr : values.front().data(), values.size() * T::SizeAtCompileTime};
}

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

/// Part of the limit of skewness in a cell of this metric: 0 if its lengths are similar, 1 if it is thin.
template <int D>
double thinness(const Tensor<D>& metric) {
  if (!(metric.determinant() > 0)) return 1;
  // Mean square of the lengths times that of their inverses: (r^2 + 2 + r^-2)/4 for a ratio r in the plane.
  const double spread = metric.trace() * metric.inverse().trace() / (D * D);
  return std::clamp((std::sqrt(std::max(0., 4 * spread - 2)) - thick) / (thin - thick), 0., 1.);
}

/// Limits the skewness of faces of thin cells to a part of a cell's length, and returns what each loses. There the
/// corrections would be many times the differences of neighbors, and the pressure would supply energy. Collective.
template <int D>
Vectors<D> limit_skewness(const mesh::Mesh& mesh, Placement<D>& p) {
  std::vector<Tensor<D>> metric(mesh.cells.n_local(),
                                Tensor<D>::Zero());  // x.(metric x): x^2 in lengths of a cell
  std::vector<double> faces(metric.size(), 0);
  const auto add = [&](Index c, Index f) {
    metric[c] += p.area[f] * p.area[f].transpose();
    faces[c] += 0.5 / D;  // to 1 in cells of parallel faces
  };
  for (Index f = 0; f < mesh.n_interior; ++f) add(mesh.owner[f], f), add(mesh.neighbour[f], f);
  for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f) add(mesh.owner[f], f);
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) metric[c] *= 0.5 * std::pow(faces[c] / p.volume[c], 2);
  mesh.cells.update_ghosts(doubles_of(metric), D * D);
  Vectors<D> lost(mesh.n_interior, Vec<D>::Zero());
  for (Index f = 0; f < mesh.n_interior; ++f) {
    const Vec<D> s = p.skew[f];
    const Tensor<D>&before = metric[mesh.owner[f]], &after = metric[mesh.neighbour[f]];
    const double length = std::sqrt(std::max(s.dot(before * s), s.dot(after * s)));
    if (length <= full_skewness) continue;
    const double part = std::max(thinness<D>(before), thinness<D>(after)) *
                        std::min(1., (length - full_skewness) / (no_skewness - full_skewness));
    p.transposed[f] = std::max(p.transposed[f], part);
    p.skew[f] *= 1 - part;
    lost[f] = s - p.skew[f];
  }
  return lost;
}

/// B of each cell. The Gauss gradient uses values at the interpolation points on the line between the cells:
/// (1 - w) d from the owner, -w d from the neighbor, moved by what the skewness lost.
template <int D>
void cure_gradients(const mesh::Mesh& mesh, Placement<D>& p) {
  const Vectors<D> lost = limit_skewness(mesh, p);
  p.gradient_cure.assign(mesh.cells.n_local(), Tensor<D>::Zero());
  for (Index f = 0; f < mesh.n_interior; ++f) {
    const Index o = mesh.owner[f], n = mesh.neighbour[f];
    const Vec<D> d = p.centre[n] + mesh.shift(f).template head<D>() - p.centre[o];
    const Tensor<D> part = d * p.area[f].transpose(), moved = lost[f] * p.area[f].transpose();
    p.gradient_cure[o] += (1 - p.weight[f]) * part + moved;
    p.gradient_cure[n] += p.weight[f] * part - moved;
  }
  for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f) {
    const Vec<D> centre = p.boundary_centre[f - mesh.n_interior].template head<D>();
    p.gradient_cure[mesh.owner[f]] += (centre - p.centre[mesh.owner[f]]) * p.area[f].transpose();
  }
  for (Index c = 0; c < mesh.cells.n_local(); ++c) {
    const Tensor<D> sum = p.gradient_cure[c] / p.volume[c];  // of ghosts: without their outer faces, not used
    p.gradient_cure[c] =
        sum.determinant() > least_determinant ? Tensor<D>(sum.inverse()) : Tensor<D>::Identity();
  }
}

/// Sets data that follow from volumes, centers and S. `centre_of(f)`: center of a flux face.
template <int D, class FaceCentre>
void set_faces(const mesh::Mesh& mesh, const FaceCentre& centre_of, Placement<D>& p) {
  const Index n_faces = mesh.n_flux_faces();
  p.conductance.resize(n_faces);
  p.oblique.resize(n_faces);
  p.weight.resize(mesh.n_interior);
  p.transposed.resize(mesh.n_interior);
  p.skew.resize(mesh.n_interior);
  double skewness = 0;
  for (Index f = 0; f < mesh.n_interior; ++f) {
    const Vec<D>& from = p.centre[mesh.owner[f]];
    const Vec<D> to = p.centre[mesh.neighbour[f]] + mesh.shift(f).template head<D>();
    set_face<D>(p, f, to - from);
    const Vec<D> centre = centre_of(f);
    const double before = std::abs(p.area[f].dot(centre - from)),
                 after = std::abs(p.area[f].dot(to - centre));
    p.weight[f] = after / (before + after);
    const double ratio = std::max(before, after) / std::min(before, after);
    p.transposed[f] = std::clamp((ratio - similar) / (different - similar), 0., 1.);
    p.skew[f] = centre - p.weight[f] * from - (1 - p.weight[f]) * to;
    const double off = p.skew[f].squaredNorm(), apart = (to - from).squaredNorm();
    if (off > skewness * apart) skewness = off / apart;
  }
  p.boundary_centre.assign(n_faces - mesh.n_interior, Vec3::Zero());
  for (Index f = mesh.n_interior; f < n_faces; ++f) {
    const Vec<D> centre = centre_of(f);
    p.boundary_centre[f - mesh.n_interior].template head<D>() = centre;
    set_face<D>(p, f, centre - p.centre[mesh.owner[f]]);
  }
  if (std::sqrt(parallel::max(mesh.comm, skewness)) > least_skewness)
    cure_gradients(mesh, p);
  else
    Vectors<D>().swap(p.skew);
  if (p.obliqueness <= orthogonal) Vectors<D>().swap(p.oblique);
}

/// Computed cell by cell in counter-clockwise order, with one write per value. Triangles from the mean of the
/// points keep round-off small far from the origin.
void set_cells(const mesh::Mesh& mesh, std::span<const Vec3> points, Placement<2>& p) {
  p.volume.resize(mesh.cells.n_local());
  p.centre.resize(mesh.cells.n_local());
  for (Index c = 0; c < mesh.cells.n_local(); ++c) {
    const std::span<const Index> corner = mesh.cell_points[c];
    Vec<2> apex = Vec<2>::Zero(), moment = apex;
    for (const Index v : corner) apex += points[v].head<2>();
    apex /= double(corner.size());
    double volume = 0;
    Vec<2> a = points[corner.back()].head<2>() - apex;
    for (const Index v : corner) {
      const Vec<2> b = points[v].head<2>() - apex;
      const double triangle = 0.5 * (a[0] * b[1] - a[1] * b[0]);
      volume += triangle;
      moment += triangle / 3 * (a + b);
      a = b;
    }
    p.volume[c] = volume;
    p.centre[c] = volume == 0 ? apex : Vec<2>(apex + moment / volume);
  }
}

template <bool Corrects, int D>
[[gnu::always_inline]] inline void add_pressures(const mesh::Mesh& mesh, const Placement<D>& at,
                                                 const double* p, const FluxCorrection& correction,
                                                 Vectors<D>& sum) {
  const Index *owner = mesh.owner.data(), *neighbour = mesh.neighbour.data();
  const double* weight = at.weight.data();
  const Vec<D>* area = at.area.data();
  Vec<D>* of = sum.data();
  // Faces are sorted by owner, so that owner data are accessed once.
  for (Index f = 0; f < mesh.n_interior;) {
    const Index o = owner[f];
    const double own = p[o];
    Vec<D> all = Vec<D>::Zero();
    do {
      const Index n = neighbour[f];
      const double less = own - p[n];
      if constexpr (Corrects) correction.phi[f] += correction.factor * correction.conductance[f] * less;
      const Vec<D> part = (p[n] + weight[f] * less) * area[f];
      all += part;
      of[n] -= part;
      ++f;
    } while (f < mesh.n_interior && owner[f] == o);
    of[o] += all;
  }
}

using mesh::Entries;

/// Archives a number or vector per entry, or none at all.
template <class T>
void field(io::Archive& archive, Entries entries, const std::string& name, std::vector<T>& values) {
  constexpr std::size_t width = sizeof(T) / sizeof(double);
  const std::span<const double> now = doubles_of(values);
  std::vector<double> copy(now.begin(), now.end());
  archive.field(entries, name, copy, width);
  if (!archive.reads()) return;
  values.resize(copy.size() / width);
  std::ranges::copy(copy, doubles_of(values).begin());
}

void visit(HeatLevel& h, bool has_history, io::Archive archive) {
  archive.set_prefix("heat-");
  field(archive, Entries::cells, "temperature", h.temperature);
  field(archive, Entries::owned_boundary, "boundary", h.boundary);
  field(archive, Entries::owned_boundary, "flow", h.flow);
  field(archive, Entries::cells, "conduction", h.conduction);
  archive.sums("received", {&h.received, 1});
  if (!has_history) return;
  field(archive, Entries::cells, "old-temperature", h.temperature_old);
  field(archive, Entries::owned_boundary, "old-boundary", h.boundary_old);
  field(archive, Entries::owned_boundary, "old-flow", h.flow_old);
  field(archive, Entries::cells, "old-conduction", h.conduction_old);
  field(archive, Entries::owned_boundary, "old-carried", h.carried_old);
  field(archive, Entries::cells, "old-convection", h.convection_old);
  field(archive, Entries::flux_faces, "old-faces", h.faces_old);
  field(archive, Entries::flux_faces, "old-flux", h.flux_old);
}

/// The placement follows from the points.
template <int D>
void visit(State<D>& s, bool moving, io::Archive archive) {
  std::size_t levels = 0;
  while (levels < s.pressure.size() && s.pressure[levels]) ++levels;
  archive.common("state", s.time, s.dt_old, s.implicit, s.start, s.ledger, s.largest_speed, s.turns, levels,
                 s.openings.mean, s.circuits.flow, s.circuits.flow_old, s.circuits.stored,
                 s.circuits.stored_old);
  field(archive, Entries::cells, "velocity", s.u);
  field(archive, Entries::owned_boundary, "wall-turn", s.turn);
  field(archive, Entries::owned_boundary, "given-velocity", s.w);
  field(archive, Entries::owned_boundary, "boundary-velocity", s.u_boundary);
  field(archive, Entries::flux_faces, "flux", s.phi);
  field(archive, Entries::interior_faces, "flux-memory", s.memory);
  for (std::size_t k = 0; k < std::min(levels, s.pressure.size()); ++k) {
    const auto level = archive.reads() ? std::make_shared<PressureLevel<D>>()
                                       : std::const_pointer_cast<PressureLevel<D>>(s.pressure[k]);
    const std::string name = "pressure-" + std::to_string(k);
    archive.common(name + "-level", level->time, level->ends, level->ends_end);
    field(archive, Entries::cells, name, level->p);
    field(archive, Entries::owned_boundary, name + "-boundary", level->boundary);
    field(archive, Entries::cells, name + "-gradient", level->gradient);
    field(archive, Entries::cells, name + "-end", level->end);
    s.pressure[k] = level;
  }
  if (s.dt_old > 0) {
    field(archive, Entries::cells, "old-velocity", s.u_old);
    field(archive, Entries::owned_boundary, "old-boundary-velocity", s.u_boundary_old);
    field(archive, Entries::owned_boundary, "old-wall-turn", s.turn_old);
    field(archive, Entries::flux_faces, "old-excess", s.excess_old);
    field(archive, Entries::cells, "old-rate", s.rates_old.rate);
    if (s.implicit) field(archive, Entries::cells, "old-viscous-rate", s.rates_old.viscous);
    field(archive, Entries::owned_boundary, "old-shear", s.shear_old);
    field(archive, Entries::interior_faces, "old-flux-memory", s.memory_old);
    field(archive, Entries::flux_faces, "old-flux", s.phi_old);
  }
  if (moving) {
    field(archive, Entries::points, "points", s.points);
    field(archive, Entries::flux_faces, "mesh-flux", s.mesh_flux);
  }
  field(archive, Entries::owned_boundary, "openings", s.openings.now);
  field(archive, Entries::owned_boundary, "openings-old", s.openings.old);
  if (s.heat.is_solved) visit(s.heat, s.dt_old > 0, archive);
}

}  // namespace

template <int D>
std::shared_ptr<const Placement<D>> make_placement(const mesh::Mesh& mesh, const mesh::Geometry& geometry) {
  auto placement = std::make_shared<Placement<D>>();
  Placement<D>& p = *placement;
  p.volume = geometry.volume;
  p.centre.resize(mesh.cells.n_local());
  for (Index c = 0; c < mesh.cells.n_local(); ++c) p.centre[c] = geometry.cell_centre[c].template head<D>();
  p.area.resize(mesh.n_flux_faces());
  for (std::size_t f = 0; f < p.area.size(); ++f) p.area[f] = geometry.face_area[f].template head<D>();
  set_faces<D>(
      mesh, [&](Index f) -> Vec<D> { return geometry.face_centre[f].template head<D>(); }, p);
  return placement;
}

/// 2-D version without the arrays of a Geometry. Periodic cells lack some points of their faces.
template <int D>
std::shared_ptr<const Placement<D>> make_placement(const mesh::Mesh& mesh, std::span<const Vec3> points) {
  if constexpr (D == 2) {
    if (mesh.neighbour_shift.empty()) {
      auto placement = std::make_shared<Placement<2>>();
      set_cells(mesh, points, *placement);
      placement->area.resize(mesh.n_flux_faces());
      for (std::size_t f = 0; f < placement->area.size(); ++f) {
        const std::span<const Index> v = mesh.face_points[static_cast<Index>(f)];
        placement->area[f] = {points[v[1]][1] - points[v[0]][1], points[v[0]][0] - points[v[1]][0]};
      }
      const auto centre_of = [&](Index f) -> Vec<2> {
        const std::span<const Index> v = mesh.face_points[f];
        return 0.5 * (points[v[0]] + points[v[1]]).template head<2>();
      };
      set_faces<2>(mesh, centre_of, *placement);
      return placement;
    }
  }
  return make_placement<D>(mesh, mesh::compute_geometry(mesh, {points.begin(), points.end()}));
}

double largest_extent(const mesh::Mesh& mesh, std::span<const Vec3> points) {
  constexpr double far = std::numeric_limits<double>::max();
  double size = 0;
  for (int c = 0; c < mesh.dim; ++c) {
    double low = far, high = -far;
    for (const Vec3& x : points) low = std::min(low, x[c]), high = std::max(high, x[c]);
    size = std::max(size, parallel::max(mesh.comm, high) - parallel::min(mesh.comm, low));
  }
  return size;
}

template <int D>
std::shared_ptr<const Placement<D>> translated(const Placement<D>& from, const Vec3& by) {
  auto placement = std::make_shared<Placement<D>>(from);
  const Vec<D> shift = by.template head<D>();
  for (Vec<D>& centre : placement->centre) centre += shift;
  for (Vec3& centre : placement->boundary_centre) centre += by;
  return placement;
}

template <int D>
std::shared_ptr<const Placement<D>> in_the_middle(const mesh::Mesh& mesh, const Placement<D>& from,
                                                  std::span<const char> faces) {
  auto placement = std::make_shared<Placement<D>>(from);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (!faces[f]) continue;
    placement->weight[f] = 0.5;
    if (placement->skewed()) placement->skew[f].setZero();
  }
  if (placement->skewed()) cure_gradients(mesh, *placement);
  return placement;
}

template decltype(in_the_middle<2>) in_the_middle<2>;
template decltype(in_the_middle<3>) in_the_middle<3>;
template std::shared_ptr<const Placement<2>> translated<2>(const Placement<2>&, const Vec3&);
template std::shared_ptr<const Placement<3>> translated<3>(const Placement<3>&, const Vec3&);
template std::shared_ptr<const Placement<2>> make_placement<2>(const mesh::Mesh&, const mesh::Geometry&);
template std::shared_ptr<const Placement<3>> make_placement<3>(const mesh::Mesh&, const mesh::Geometry&);
template std::shared_ptr<const Placement<2>> make_placement<2>(const mesh::Mesh&, std::span<const Vec3>);
template std::shared_ptr<const Placement<3>> make_placement<3>(const mesh::Mesh&, std::span<const Vec3>);

COUPLET_PROCESSOR_CLONES double subtract_outflow(const mesh::Mesh& mesh, double factor,
                                                 std::span<const double> phi, std::span<double> sum) {
  const Index *owner = mesh.owner.data(), *neighbour = mesh.neighbour.data();
  const double* flux = phi.data();
  double *of = sum.data(), size = 0;
  for (Index f = 0; f < mesh.n_interior; ++f) {
    const double out = factor * flux[f];
    of[owner[f]] -= out;
    of[neighbour[f]] += out;
    size += flux[f] * flux[f];
  }
  return size;
}

void add_outflow(const mesh::Mesh& mesh, std::span<const double> phi, std::span<double> sum) {
  subtract_outflow(mesh, -1, phi, sum);
  for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f) sum[mesh.owner[f]] += phi[f];
}

template <int D>
COUPLET_PROCESSOR_CLONES void add_pressure(const mesh::Mesh& mesh, const Placement<D>& at,
                                           std::span<const double> p, const FluxCorrection* correction,
                                           Vectors<D>& sum) {
  if (correction)
    add_pressures<true>(mesh, at, p.data(), *correction, sum);
  else
    add_pressures<false>(mesh, at, p.data(), FluxCorrection{}, sum);
}

template decltype(add_pressure<2>) add_pressure<2>;
template decltype(add_pressure<3>) add_pressure<3>;

template <int D>
void write_state(io::CheckpointWriter& file, const State<D>& s) {
  // Writing does not change the state.
  visit(const_cast<State<D>&>(s), !s.points.empty() || !s.mesh_flux.empty(), io::Archive(file));
}

template <int D>
State<D> read_state(io::CheckpointReader& file, const mesh::Mesh& mesh,
                    std::shared_ptr<const Placement<D>> at_rest, bool has_heat) {
  State<D> s;
  s.heat.is_solved = has_heat;
  visit(s, !at_rest, io::Archive(file));
  s.placement = at_rest ? std::move(at_rest) : make_placement<D>(mesh, s.points);
  return s;
}

template void write_state<2>(io::CheckpointWriter&, const State<2>&);
template void write_state<3>(io::CheckpointWriter&, const State<3>&);
template decltype(read_state<2>) read_state<2>;
template decltype(read_state<3>) read_state<3>;

}  // namespace couplet::fluid
