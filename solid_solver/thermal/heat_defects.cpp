// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/thermal/heat_defects.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/error.hpp"
#include "common/fv/gradients.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/body/stress.hpp"

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

namespace {

using Conduction = fv::ConductionOperator;

constexpr double not_skew = 1e-12;  // of the skewness squared

/// Cells around each local point; of each local cell its boundary faces that have a value, and those that mirror.
struct CellsAround {
  std::vector<std::vector<Index>> cells, faces, mirrors;
  explicit CellsAround(const Conduction& conduction) {
    const mesh::Mesh& mesh = conduction.mesh();
    cells.resize(std::size_t(mesh.points.n_local()));
    faces.resize(std::size_t(mesh.cells.n_local())), mirrors.resize(faces.size());
    for (Index c = 0; c < mesh.cells.n_local(); ++c)
      for (const Index v : mesh.cell_points[c]) cells[std::size_t(v)].push_back(c);
    for (Index f = mesh.n_interior; f < mesh.n_faces(); ++f)
      (conduction.condition(f) == fv::HeatCondition::symmetry ? mirrors : faces)[std::size_t(mesh.owner[f])]
          .push_back(f);
  }
  /// Its own and those beside it, of its zone.
  std::vector<Index> of(const mesh::Mesh& mesh, Index cell) const {
    std::vector<Index> found;
    for (const Index v : mesh.cell_points[cell])
      for (const Index c : cells[std::size_t(v)])
        if (mesh.cell_zone[c] == mesh.cell_zone[cell]) found.push_back(c);
    // By numbers of the mesh file, so that sums are the same on any ranks.
    std::ranges::sort(found, {}, [&](Index c) { return mesh.cell_id[c]; });
    found.erase(std::ranges::unique(found).begin(), found.end());
    return found;
  }
};

/// Of its terms x_a x_b of places over the reach.
LocalHeat local_of(const Eigen::VectorXd& c, int dim, double reach) {
  LocalHeat result;
  Eigen::Index i = 0;
  result.value = c[i++];
  for (int a = 0; a < dim; ++a) result.slope[a] = c[i++] / reach;
  for (int a = 0; a < dim; ++a)
    for (int b = a; b < dim; ++b, ++i)
      result.second(a, b) = result.second(b, a) = (a == b ? 2 : 1) * c[i] / (reach * reach);
  return result;
}

/// Faces of planes of symmetry beside these cells, one for each plane.
std::vector<Index> planes_beside(const mesh::Geometry& g, const CellsAround& around,
                                 std::span<const Index> cells) {
  std::vector<Index> planes;
  for (const Index c : cells)
    for (const Index f : around.mirrors[std::size_t(c)])
      if (std::ranges::none_of(planes, [&](Index p) {
            return g.face_area[p].normalized().dot(g.face_area[f].normalized()) > 0.999;
          }))
        planes.push_back(f);
  return planes;
}

LocalHeat fitted_heat(const Conduction& conduction, const CellsAround& around, Index cell,
                      const HeatState& field) {
  const mesh::Mesh& mesh = conduction.mesh();
  const mesh::Geometry& g = conduction.geometry();
  const std::vector<Index> cells = around.of(mesh, cell), planes = planes_beside(g, around, cells);
  const Vec3 centre = g.cell_centre[cell];
  double reach = std::pow(g.volume[cell], 1. / mesh.dim);
  for (const Index c : cells) reach = std::max(reach, (g.cell_centre[c] - centre).norm());
  fv::NearQuadratic fit(mesh.dim, centre, reach, 1);
  const double own = field.cells[std::size_t(cell)];  // differences keep the digits
  const auto sample = [&](const Vec3& x, double value) {
    const double above = value - own;
    fit.add(x, {&above, 1});
    for (const Index p : planes) {
      const Vec3 normal = g.face_area[p].normalized();
      fit.add(x - 2 * normal.dot(x - g.face_centre[p]) * normal, {&above, 1});
    }
  };
  for (const Index c : cells) {
    sample(g.cell_centre[c], field.cells[std::size_t(c)]);
    for (const Index f : around.faces[std::size_t(c)])
      sample(g.face_centre[f], field.boundary[std::size_t(f - mesh.n_interior)]);
  }
  LocalHeat result = local_of(fit.solve(), mesh.dim, reach);
  result.value += own;
  return result;
}

/// n . gradient that the scheme has of (x - x_f) . second . (x - x_f) / 2, whose own is zero.
double defect_of_gradient(const Conduction& conduction, Index f, const Tensor3& second) {
  const mesh::Mesh& mesh = conduction.mesh();
  const mesh::Geometry& g = conduction.geometry();
  const Vec3 centre = g.face_centre[f];
  const auto at = [&](const Vec3& x) { return 0.5 * (x - centre).dot(second * (x - centre)); };
  const auto at_point = [&](Index v) {
    const fv::VertexInterpolation& vertices = conduction.vertices();
    if (vertices.is_fixed(v) || vertices.on_symmetry(v) || vertices.nodes(v).empty()) return at(g.points[v]);
    double value = 0;
    for (std::size_t i = 0; i < vertices.nodes(v).size(); ++i) {
      const Index node = vertices.nodes(v)[i], b = node - mesh.cells.n_local();
      value += vertices.weights(v)[i] * at(b < 0 ? g.cell_centre[node] : g.face_centre[mesh.n_interior + b]);
    }
    return value;
  };
  const fv::FaceGradient& faces = conduction.faces();
  const double there = f < mesh.n_interior ? at(g.cell_centre[mesh.neighbour[f]] + mesh.shift(f)) : 0;
  double gradient = (there - at(g.cell_centre[mesh.owner[f]])) * faces.inverse_dn[f];
  if (faces.skew[f].squaredNorm() < not_skew) return gradient;
  for (Index e = mesh.face_points.offset[f]; e < mesh.face_points.offset[f + 1]; ++e)
    gradient += faces.skew[f].dot(faces.tangential[e]) * at_point(mesh.face_points.index[e]);
  return gradient;
}

/// Of third derivatives, on one side of a face, by parts.
double varied_flux(const mesh::Mesh& mesh, const mesh::Geometry& g, Index f, const Vec3& arm,
                   const Tensor3& t, const Tensor3& z) {
  const Vec3 normal = g.face_area[f].normalized(), of_t = t * arm, of_z = z * arm;
  const double across = of_t.dot(normal) * of_z.dot(normal);
  const double pyramid = std::abs(g.face_area[f].dot(arm)) / mesh.dim;
  return mesh.dim / 6. * pyramid * (2 * across - of_t.dot(of_z));
}

}  // namespace

std::vector<LocalHeat> local_heat(const Heat& heat, const HeatState& field) {
  const mesh::Mesh& mesh = heat.conduction().mesh();
  const CellsAround around(heat.conduction());
  constexpr std::size_t size = 10;
  std::vector<double> numbers(std::size_t(mesh.cells.n_local()) * size, 0);
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    const LocalHeat fit = fitted_heat(heat.conduction(), around, c, field);
    double* to = numbers.data() + std::size_t(c) * size;
    *to++ = fit.value;
    to = std::copy_n(fit.slope.data(), 3, to);
    std::ranges::copy(pack(fit.second), to);
  }
  mesh.cells.update_ghosts(numbers, int(size));
  std::vector<LocalHeat> all(std::size_t(mesh.cells.n_local()));
  for (std::size_t c = 0; c < all.size(); ++c) {
    const double* from = numbers.data() + c * size;
    all[c].value = *from++;
    for (int a = 0; a < 3; ++a) all[c].slope[a] = *from++;
    PackedTensor second;
    std::copy_n(from, second.size(), second.begin());
    all[c].second = unpack(second);
  }
  return all;
}

double weighted_defect(const Heat& heat, std::span<const LocalHeat> of_t, const HeatState& z) {
  const Conduction& conduction = heat.conduction();
  const mesh::Mesh& mesh = conduction.mesh();
  const mesh::Geometry& g = conduction.geometry();
  const std::vector<LocalHeat> of_z = local_heat(heat, z);
  const std::span<const double> k = HeatAnswer(heat).conductivity();
  double sum = 0;
  const auto vary = [&](Index c, Index f, const Vec3& shift) {
    if (c < mesh.cells.n_owned())
      sum += k[f] * varied_flux(mesh, g, f, g.face_centre[f] - shift - g.cell_centre[c], of_t[c].second,
                                of_z[c].second);
  };
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    const Index owner = mesh.owner[f];
    vary(owner, f, Vec3::Zero());
    const double area = g.face_area[f].norm();
    if (f < mesh.n_interior) {
      const Index neighbour = mesh.neighbour[f];
      vary(neighbour, f, mesh.shift(f));
      if (owner >= mesh.cells.n_owned() || mesh.cell_zone[owner] != mesh.cell_zone[neighbour]) continue;
      const Tensor3 second = 0.5 * (of_t[owner].second + of_t[neighbour].second);
      sum -= k[f] * area * defect_of_gradient(conduction, f, second) * (z.cells[neighbour] - z.cells[owner]);
    } else if (conduction.condition(f) != fv::HeatCondition::symmetry) {
      const Tensor3& second = of_t[owner].second;
      const double across = z.boundary[f - mesh.n_interior] - z.cells[owner];
      const Vec3& normal = conduction.faces().normal[f];
      const double distance = 1 / conduction.faces().inverse_dn[f];
      sum -= k[f] * area * across *
             (defect_of_gradient(conduction, f, second) + distance / 6 * normal.dot(second * normal));
    }
  }
  return parallel::sum(mesh.comm, sum);
}

}  // namespace couplet::solid
