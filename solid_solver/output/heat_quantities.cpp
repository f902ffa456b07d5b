// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/output/quantities.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/io/probes/probe.hpp"
#include "common/mesh/topology.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/body/quadratic_fit.hpp"
#include "solid_solver/body/stress.hpp"
#include "solid_solver/output/probes.hpp"

namespace couplet::solid {

namespace {

using Conduction = fv::ConductionOperator;

constexpr double not_skew = 1e-12;  // of the skewness squared

/// Quadratic fit to the cells of a cell's zone that share a vertex with it, and to their boundary faces:
/// T(x) = value + slope . (x - x_P) + (x - x_P) . second . (x - x_P) / 2
struct LocalHeat {
  double value = 0;
  Vec3 slope = Vec3::Zero();
  Tensor3 second = Tensor3::Zero();
  double at(const Vec3& from_centre) const {
    return value + slope.dot(from_centre) + 0.5 * from_centre.dot(second * from_centre);
  }
};

/// Cells around each local point; per local cell its boundary faces with values, and mirrored ones.
struct CellsAround {
  mesh::Csr cells;
  std::vector<std::vector<Index>> faces, mirrors;
  explicit CellsAround(const Conduction& conduction) {
    const mesh::Mesh& mesh = conduction.mesh();
    cells = mesh::transpose(mesh.cell_points, 0, mesh.points.n_local());
    faces.resize(std::size_t(mesh.cells.n_local())), mirrors.resize(faces.size());
    for (Index f = mesh.n_interior; f < mesh.n_faces(); ++f)
      (conduction.condition(f) == fv::HeatCondition::symmetry ? mirrors : faces)[std::size_t(mesh.owner[f])]
          .push_back(f);
  }
  /// The cell itself and its neighbors in the zone.
  std::vector<Index> of(const mesh::Mesh& mesh, Index cell) const {
    std::vector<Index> found;
    for (const Index v : mesh.cell_points[cell])
      for (const Index c : cells[v])
        if (mesh.cell_zone[c] == mesh.cell_zone[cell]) found.push_back(c);
    // Sorted by numbers of the mesh file, so that sums do not depend on the ranks.
    std::ranges::sort(found, {}, [&](Index c) { return mesh.cell_id[c]; });
    found.erase(std::ranges::unique(found).begin(), found.end());
    return found;
  }
};

/// From coefficients of the terms x_a x_b, scaled by the reach.
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

LocalHeat fitted_heat(const Conduction& conduction, const CellsAround& around, Index cell,
                      const HeatState& field) {
  const mesh::Mesh& mesh = conduction.mesh();
  const mesh::Geometry& g = conduction.geometry();
  const std::vector<Index> cells = around.of(mesh, cell);
  const Vec3 centre = g.cell_centre[cell];
  double reach = std::pow(g.volume[cell], 1. / mesh.dim);
  std::vector<MirrorPlane> planes;
  for (const Index c : cells) {
    reach = std::max(reach, (g.cell_centre[c] - centre).norm());
    for (const Index f : around.mirrors[std::size_t(c)]) add_mirror(g, f, planes);
  }
  QuadraticFit fit;
  fit.start(mesh.dim, 1, centre, reach);
  const double own = field.cells[std::size_t(cell)];  // differences keep the digits
  const auto sample = [&](const Vec3& x, double value) {
    const double above = value - own;
    fit.add_near(x, {&above, 1});
    for (const MirrorPlane& p : planes) fit.add_near(p.image(x), {&above, 1});
  };
  for (const Index c : cells) {
    sample(g.cell_centre[c], field.cells[std::size_t(c)]);
    for (const Index f : around.faces[std::size_t(c)])
      sample(g.face_centre[f], field.boundary[std::size_t(f - mesh.n_interior)]);
  }
  fit.solve_near();
  LocalHeat result = local_of(fit.coefficients(), mesh.dim, reach);
  result.value += own;
  return result;
}

/// The scheme's n . gradient of (x - x_f) . second . (x - x_f)/2, whose exact value is zero.
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

/// Contribution of third derivatives on one side of a face, after summation by parts.
double varied_flux(const mesh::Mesh& mesh, const mesh::Geometry& g, Index f, const Vec3& arm,
                   const Tensor3& t, const Tensor3& z) {
  const Vec3 normal = g.face_area[f].normalized(), of_t = t * arm, of_z = z * arm;
  const double across = of_t.dot(normal) * of_z.dot(normal);
  const double pyramid = std::abs(g.face_area[f].dot(arm)) / mesh.dim;
  return mesh.dim / 6. * pyramid * (2 * across - of_t.dot(of_z));
}

/// Quadratic fits around all local cells. Collective.
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

/// Curve or surface of which a boundary face is a chord, as the normals at its vertices show it.
struct Bulge {
  double height = 0;  ///< mean distance from the face, positive outward [m]
  double area = 0;    ///< excess over the area of the face, relative to it
};

/// Bulges of the boundary faces of owned cells. The normal at a vertex is the mean over the faces of the
/// patch, within planes of symmetry; where a patch turns by more than 50 degrees it has a corner. Collective.
std::vector<Bulge> bulges(const Conduction& conduction) {
  constexpr double smooth = 0.9;  // cosine of half of the turn
  const mesh::Mesh& mesh = conduction.mesh();
  const mesh::Geometry& g = conduction.geometry();
  std::vector<Bulge> all(std::size_t(mesh.boundary.n_owned()));
  for (const mesh::Patch& patch : mesh.patches) {
    const auto each = [&](auto&& visit) {
      for (Index f = patch.first; f < patch.first + patch.count; ++f) visit(f, mesh.face_points[f]);
    };
    Eigen::Matrix3Xd sum = Eigen::Matrix3Xd::Zero(3, mesh.points.n_local());
    each([&](Index f, std::span<const Index> points) {
      for (const Index v : points) sum.col(v) += conduction.faces().normal[f];
    });
    mesh.points.add_to_owners({sum.data(), std::size_t(sum.size())}, 3);
    mesh.points.update_ghosts({sum.data(), std::size_t(sum.size())}, 3);
    each([&](Index f, std::span<const Index> points) {
      const Vec3& flat = conduction.faces().normal[f];
      const auto tilt = [&](Index v) {
        const Vec3 n = conduction.vertices().projector(v) * sum.col(v);
        return n.dot(flat) > smooth * n.norm() ? Vec3(n.normalized() - flat) : Vec3(Vec3::Zero());
      };
      Bulge& bulge = all[std::size_t(f - mesh.n_interior)];
      Vec3 together = Vec3::Zero();
      double squares = 0;
      for (std::size_t i = 0; i < points.size(); ++i) {  // sees the edge of a 2-D mesh twice
        const Index v = points[i], next = points[(i + 1) % points.size()];
        bulge.height += (tilt(next) - tilt(v)).dot(g.points[next] - g.points[v]) / 24;
        squares += tilt(v).squaredNorm(), together += tilt(v);
      }
      bulge.area = (squares + together.squaredNorm()) / (12 * (mesh.dim - 1));
    });
  }
  return all;
}

/// The fluxes of the scheme have a defect tau_f = exact - scheme's on the exact field. For a functional
/// with dual solution z and source defect s ([becker2001]; [Venditti, Darmofal 2000]) the error is -S + z.s,
///   S = sum_f tau_f (z_N - z_P)
/// tau_f is the gradient error (2.53)-(2.58) for a quadratic with the second derivatives H of T. It is zero
/// between regular cells; there third derivatives dominate, which after summation by parts give
///   dim/6 sum_P sum_f V_fP k (d_n d'_n - d_t . d'_t) - sum_b k |S| d_b^2 / 6 H_nn dz/dn,   d = H (x_f - x_P), d' that of z
/// with n normal and t tangential to the face, d_b the distance of a cell from a boundary face; exact for
/// regular cells. Boundary values are taken as exact between face centers. Collective.
double weighted_defect(const Heat& heat, std::span<const LocalHeat> of_t, const HeatState& z) {
  const Conduction& conduction = heat.conduction();
  const mesh::Mesh& mesh = conduction.mesh();
  const mesh::Geometry& g = conduction.geometry();
  const std::vector<LocalHeat> of_z = local_heat(heat, z);
  const std::span<const double> k = heat.conductivity();
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

/// Change of a functional with dual solution z from the polygon of the mesh to the curve around it, of height b
/// and excess a of area over each face, by Hadamard's formula:
///   sum_b k |S| (b (d_n T d_n z - grad_t T . grad_t z - lap T z) + a d_n T (z - w))
/// w is 1 on the patch whose heat is `counted`, and 0 elsewhere. Collective.
double missed_by_chords(const Heat& heat, std::span<const LocalHeat> of_t, const HeatState& z,
                        const mesh::Patch* counted) {
  const Conduction& conduction = heat.conduction();
  const mesh::Mesh& mesh = conduction.mesh();
  const std::vector<Bulge> curved = bulges(conduction);
  const HeatState& now = heat.accepted();
  const std::vector<double> points = heat.point_temperature(now), points_of_z = heat.point_temperature(z);
  double sum = 0;
  for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f) {
    const auto& [height, excess] = curved[std::size_t(f - mesh.n_interior)];
    if (height == 0) continue;
    const Vec3 &normal = conduction.faces().normal[f],
               slope = conduction.gradient(f, now.cells, now.boundary, points),
               of_z = conduction.gradient(f, z.cells, z.boundary, points_of_z);
    const double out = slope.dot(normal), here = z.boundary[f - mesh.n_interior];
    const bool counts = counted && f >= counted->first && f < counted->first + counted->count;
    const double curvature = of_t[mesh.owner[f]].second.trace();
    sum += heat.conductivity()[f] * conduction.geometry().face_area[f].norm() *
           (height * (2 * out * of_z.dot(normal) - slope.dot(of_z) - curvature * here) +
            excess * out * (here - (counts ? 1 : 0)));
  }
  return parallel::sum(mesh.comm, sum);
}

class HeatEstimates {
 public:
  explicit HeatEstimates(const Heat& heat)
      : heat_(heat),
        conduction_(heat.conduction()),
        mesh_(conduction_.mesh()),
        points_(heat.point_temperature(heat.accepted())),
        fits_(local_heat(heat, heat.accepted())),
        source_missed_(heat.source_missed()) {}

  QuantityEstimate of(const std::string& name, const SolidQuantity& quantity) const {
    return quantity.field == "heat" ? through(name, quantity.patch) : at(name, place_of(quantity));
  }

 private:
  QuantityEstimate at(const std::string& name, const Vec3& place) const {
    const mesh::Geometry& g = conduction_.geometry();
    const io::Probe probe(mesh_, g.points, name, place);
    QuantityEstimate e{.name = name, .what = "temperature", .unit = "K", .place = probe.place()};
    const std::vector<double> sampled = probe.sample(points_, 1);
    e.value = parallel::sum(mesh_.comm, sampled.empty() ? 0 : sampled[0]);
    double sum = 0, n = 0;
    for (const Index c : cells_at(mesh_, probe))
      sum += fits_[std::size_t(c)].at(e.place - g.cell_centre[c]), n += 1;
    e.local = is_given(probe) ? 0 : parallel::sum(mesh_.comm, sum) / parallel::sum(mesh_.comm, n) - e.value;
    const HeatState z = heat_.answer(rows_of(probe), std::vector<double>(conduction_.n_known(), 0));
    e.dual = missed_by_chords(heat_, fits_, z, nullptr) - missed(z);
    e.is_signed = true;
    return e;
  }

  /// True if all of its vertices have a prescribed temperature.
  bool is_given(const io::Probe& probe) const {
    double solved = 0;
    for (std::size_t i = 0; i < probe.points().size(); ++i)
      if (!std::ranges::count(conduction_.known_points(), probe.points()[i]))
        solved += std::abs(probe.weights()[i]);
    return parallel::sum(mesh_.comm, solved) < 1e-9;
  }

  /// Source of 1 W at the probe, in the nodes used for its value.
  std::vector<double> rows_of(const io::Probe& probe) const {
    std::vector<double> cells(std::size_t(mesh_.cells.n_local()), 0),
        faces(std::size_t(mesh_.boundary.n_local()), 0);
    std::vector<double> shares(std::size_t(mesh_.points.n_local()), 0);
    for (std::size_t i = 0; i < probe.points().size(); ++i)
      shares[std::size_t(probe.points()[i])] += probe.weights()[i];
    // The nodes of points are on their owner.
    mesh_.points.add_to_owners(shares);
    for (Index v = 0; v < mesh_.points.n_owned(); ++v) {
      if (shares[std::size_t(v)] == 0 || std::ranges::count(conduction_.known_points(), v)) continue;
      const auto nodes = conduction_.vertices().nodes(v);
      const auto weights = conduction_.vertices().weights(v);
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        const Index b = nodes[i] - mesh_.cells.n_local();
        (b < 0 ? cells[std::size_t(nodes[i])] : faces[std::size_t(b)]) += shares[std::size_t(v)] * weights[i];
      }
    }
    mesh_.cells.add_to_owners(cells);
    mesh_.boundary.add_to_owners(faces);
    return in_rows(cells, faces);
  }

  /// Heat entering at a flux face is in the rows of the face and of its cell.
  std::vector<double> in_rows(std::span<const double> cells, std::span<const double> faces) const {
    std::vector<double> rows(conduction_.n_unknowns(), 0);
    const auto n_owned = std::size_t(mesh_.cells.n_owned());
    std::copy_n(cells.begin(), n_owned, rows.begin());
    const auto& flux = conduction_.flux_faces();
    for (std::size_t i = 0; i < flux.size(); ++i) {
      const double heat = faces[std::size_t(flux[i] - mesh_.n_interior)];
      rows[n_owned + i] = heat;
      if (conduction_.condition(flux[i]) == fv::HeatCondition::flux)
        rows[std::size_t(mesh_.owner[flux[i]])] += heat;
    }
    return rows;
  }

  /// w = 1 on the patch, 0 on others with a temperature; likewise for the ambient temperature of a film.
  QuantityEstimate through(const std::string& name, const std::string& patch) const {
    QuantityEstimate e{.name = name, .what = "heat into the solid through", .unit = "W", .patch = patch};
    for (const PatchHeat& h : heat_.patch_heat())
      if (h.patch == patch) e.value = h.heat;
    std::vector<double> known(conduction_.n_known(), 0), faces(std::size_t(mesh_.boundary.n_local()), 0);
    const mesh::Patch& here = *mesh_.find_patch(patch);
    const auto is_here = [&](Index f) { return f >= here.first && f < here.first + here.count; };
    heat_.boundaries().mark_known(conduction_, patch, known);
    const std::vector<double> transfer = heat_.transfer();
    const auto& flux = conduction_.flux_faces();
    for (std::size_t i = 0; i < transfer.size(); ++i)
      if (is_here(flux[i])) faces[std::size_t(flux[i] - mesh_.n_interior)] = transfer[i];
    e.is_signed = true;
    const HeatState z =
        heat_.answer(in_rows(std::vector<double>(std::size_t(mesh_.cells.n_owned()), 0), faces), known);
    e.dual = missed(z), e.local = -missed_by_chords(heat_, fits_, z, &here);
    return e;
  }

  double missed(const HeatState& z) const {
    double source = 0;
    for (std::size_t c = 0; c < source_missed_.size(); ++c) source += z.cells[c] * source_missed_[c];
    return weighted_defect(heat_, fits_, z) - parallel::sum(mesh_.comm, source);
  }

  const Heat& heat_;
  const fv::ConductionOperator& conduction_;
  const mesh::Mesh& mesh_;
  const std::vector<double> points_;
  const std::vector<LocalHeat> fits_;
  const std::vector<double> source_missed_;
};

}  // namespace

void check_heat_quantities(const Heat& heat, const std::map<std::string, SolidQuantity>& quantities) {
  if (quantities.empty()) return;
  const mesh::Mesh& mesh = heat.conduction().mesh();
  if (heat.properties_vary())
    throw Error(
        "quantities: their errors are estimated only if the conductivity is constant, but it varies with the temperature. "
        "'couplet study --quantities' estimates them from differences between coarser runs.");
  std::vector<std::string> patches;
  for (const mesh::Patch& patch : mesh.patches)
    if (!patch.bonded) patches.push_back(patch.name);
  for (const auto& [name, quantity] : quantities) {
    if (quantity.field == "heat" && !std::ranges::count(patches, quantity.patch))
      throw Error("quantities.{}: the mesh has no patch '{}'. {}", name, quantity.patch,
                  base::did_you_mean(quantity.patch, patches, "patches"));
    if (quantity.field != "heat")
      io::Probe(mesh, heat.conduction().geometry().points, name, place_of(quantity));
  }
}

std::vector<QuantityEstimate> estimate_heat_quantities(
    const Heat& heat, const std::map<std::string, SolidQuantity>& quantities) {
  std::vector<QuantityEstimate> found;
  if (quantities.empty()) return found;
  const HeatEstimates estimates(heat);
  for (const auto& [name, quantity] : quantities) found.push_back(estimates.of(name, quantity));
  return found;
}

}  // namespace couplet::solid
