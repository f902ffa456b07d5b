// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/body/stress_recovery.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "common/diagnostics/error_parts.hpp"
#include "common/elasticity/vector_at.hpp"
#include "common/mesh/topology.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/body/quadratic_fit.hpp"

namespace couplet::solid {
namespace {

// Measured on the fillet of an L-bracket, LE1, LE10 and LE11; the stress depends little on any of them.
constexpr double of_far = 1. / 9;           // weight of a sample at the patch's rim over one in its center
constexpr double of_traction = 1;           // weight of a traction over a sample, fit of stress ...
constexpr double of_scaled_traction = 0.1;  // ... and of displacement, as h t / (2 mu + lambda)
constexpr double of_face = 3;               // weight of a face's displacement over a cell's
// Stress that counts as small, relative to the largest one: errors there are relative to this.
constexpr double small_part = 0.01;

bool is_simplex(mesh::CellType type) {
  return type == mesh::CellType::triangle || type == mesh::CellType::tetrahedron;
}

std::vector<Tensor3> with_ghosts(const parallel::IndexMap& map, const std::vector<Tensor3>& owned) {
  std::vector<Tensor3> all(std::size_t(map.n_local()), Tensor3::Zero());
  std::ranges::copy(owned, all.begin());
  map.update_ghosts(std::as_writable_bytes(std::span(all)), sizeof(Tensor3));
  return all;
}

/// Row of the fit of packed tensors for e . (stress . n) at a place.
QuadraticFit::Row row_of_stress(const QuadraticFit::Terms& phi, const Vec3& e, const Vec3& n) {
  Eigen::Matrix<double, 1, tensor_size> factor;
  factor << e[0] * n[0], e[1] * n[1], e[2] * n[2], e[0] * n[1] + e[1] * n[0], e[1] * n[2] + e[2] * n[1],
      e[0] * n[2] + e[2] * n[0];
  return phi * factor;
}

}  // namespace

struct StressRecovery::Local {
  std::vector<Tensor3> cells, faces, other_in_cells, other_on_faces;
  std::span<const double> cell_u, face_u;
  std::vector<SurfaceTraction> surface;
};

struct StressRecovery::Patch {
  std::vector<Index> cells, faces;  // faces: of the boundary, not of symmetry planes
  std::vector<Index> loaded;        // those with a known traction, and all of symmetry planes
  std::vector<MirrorPlane> mirrors;
  bool simplices = true;    // triangles or tetrahedra alone
  bool at_surface = false;  // some face has a known traction and is no symmetry plane's
  double reach = 0;
  std::vector<Index> mark;  // per local cell: for which cell it was last gathered
};

StressRecovery::StressRecovery(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows,
                               bool plane_stress)
    : mesh_(mesh),
      geometry_(rows.geometry()),
      rows_(rows),
      plane_stress_(plane_stress),
      cells_of_point_(mesh::transpose(mesh.cell_points, 0, mesh.points.n_local())),
      faces_of_cell_(boundary_faces_of_cells(mesh)),
      moment_(std::size_t(mesh.cells.n_local()), Tensor3::Zero()) {
  const mesh::Geometry& geometry = rows.geometry();
  for (Index c = 0; c < mesh.cells.n_local(); ++c) moment_[std::size_t(c)] = cell_moment(mesh, geometry, c);
}

StressRecovery::Local StressRecovery::localise(const DiscreteStress& found) const {
  Local local{with_ghosts(mesh_.cells, found.cells),
              with_ghosts(mesh_.boundary, found.faces),
              {},
              {},
              found.cell_u,
              found.face_u,
              found.surface};
  if (!found.other_in_cells.empty() || !found.other_on_faces.empty()) {
    local.other_in_cells = with_ghosts(mesh_.cells, found.other_in_cells);
    local.other_on_faces = with_ghosts(mesh_.boundary, found.other_on_faces);
  }
  local.surface.resize(std::size_t(mesh_.boundary.n_local()));
  mesh_.boundary.update_ghosts(std::as_writable_bytes(std::span(local.surface)), sizeof(SurfaceTraction));
  return local;
}

void StressRecovery::gather(Index cell, const Local& local, Patch& patch) const {
  const mesh::Geometry& g = geometry_;
  patch.cells.clear(), patch.faces.clear(), patch.loaded.clear(), patch.mirrors.clear();
  patch.mark.resize(std::size_t(mesh_.cells.n_local()), -1);
  patch.simplices = true, patch.at_surface = false;
  patch.reach = 0;
  gather_cells(mesh_, cells_of_point_, cell, patch.mark, patch.cells);
  for (const Index c : patch.cells) {
    patch.simplices = patch.simplices && is_simplex(mesh_.cell_type[c]);
    patch.reach = std::max(patch.reach, (g.cell_centre[c] - g.cell_centre[cell]).norm());
  }
  for (const Index c : patch.cells)
    for (const Index f : faces_of_cell_[c]) {
      const SurfaceTraction& known = local.surface[std::size_t(f - mesh_.n_interior)];
      patch.reach = std::max(patch.reach, (g.face_centre[f] - g.cell_centre[cell]).norm());
      if (!known.projector.isZero(0)) patch.loaded.push_back(f);
      if (!known.symmetry) {
        patch.faces.push_back(f);
        patch.at_surface = patch.at_surface || !known.projector.isZero(0);
        continue;
      }
      add_mirror(g, f, patch.mirrors);
    }
  if (patch.reach == 0) patch.reach = std::pow(g.volume[cell], 1. / mesh_.dim);
}

void StressRecovery::fit_tensors(Index cell, const std::vector<Tensor3>& cells,
                                 const std::vector<Tensor3>& faces,
                                 const std::vector<SurfaceTraction>* surface, Patch& patch,
                                 QuadraticFit& fit) const {
  const mesh::Geometry& g = geometry_;
  const Vec3 centre = g.cell_centre[cell];
  fit.start(mesh_.dim, tensor_size, centre, patch.reach);
  const auto add = [&](const Vec3& place, const Tensor3& moment, const Tensor3& value) {
    const double far = (place - centre).squaredNorm() / (patch.reach * patch.reach);
    const double weight = 1 / (1 + (1 / of_far - 1) * far);
    fit.add_sample(place, moment, pack(value), weight);
    for (const MirrorPlane& m : patch.mirrors) {
      const Tensor3 r = m.reflection();
      fit.add_sample(m.image(place), r * moment * r, pack(r * value * r), weight);
    }
  };
  for (const Index c : patch.cells) add(g.cell_centre[c], moment_[std::size_t(c)], cells[std::size_t(c)]);
  for (const Index f : patch.faces)
    if (rows_.at(f).is_free())
      add(g.face_centre[f], Tensor3::Zero(), faces[std::size_t(f - mesh_.n_interior)]);
  if (surface)
    for (const Index f : patch.loaded) {
      const SurfaceTraction& known = (*surface)[std::size_t(f - mesh_.n_interior)];
      const Vec3 n = g.face_area[f].normalized();
      const QuadraticFit::Terms phi = fit.terms(g.face_centre[f]);
      for (int a = 0; a < mesh_.dim; ++a) {
        const Vec3 e = known.projector.row(a);
        if (!e.isZero(0)) fit.add_row(row_of_stress(phi, e, n), known.traction[a], of_traction);
      }
    }
  fit.solve();
}

void StressRecovery::fit_displacement(Index cell, const Local& local, Patch& patch, QuadraticFit& fit) const {
  const mesh::Geometry& g = geometry_;
  const Vec3 centre = g.cell_centre[cell];
  const int dim = mesh_.dim;
  fit.start(dim, dim, centre, patch.reach);
  const auto add = [&](const Vec3& place, const Vec3& value, double weight) {
    const double far = (place - centre).squaredNorm() / (patch.reach * patch.reach);
    weight /= 1 + (1 / of_far - 1) * far;
    fit.add_sample(place, Tensor3::Zero(), {value.data(), 3}, weight);
    for (const MirrorPlane& m : patch.mirrors) {
      const Vec3 image = m.reflect(value);
      fit.add_sample(m.image(place), Tensor3::Zero(), {image.data(), 3}, weight);
    }
  };
  for (const Index c : patch.cells) add(g.cell_centre[c], elastic::vector_at(local.cell_u, c, dim), 1);
  for (const Index f : patch.faces)
    add(g.face_centre[f], elastic::vector_at(local.face_u, f - mesh_.n_interior, dim), of_face);
  const double unit = patch.reach / (2 * rows_.lame(cell).mu + rows_.lame(cell).lambda);
  for (const Index f : patch.loaded) {
    const SurfaceTraction& known = local.surface[std::size_t(f - mesh_.n_interior)];
    const Vec3 n = g.face_area[f].normalized();
    const QuadraticFit::Slopes slope = fit.slopes(g.face_centre[f]);
    std::array<QuadraticFit::Row, 3> rows;
    rows.fill(QuadraticFit::Row::Zero(fit.n_terms(), dim));
    for (int k = 0; k < dim; ++k) {
      Tensor3 of_slope = Tensor3::Zero();  // column j: traction of a unit slope of component k along axis j
      for (int j = 0; j < dim; ++j)
        of_slope.col(j) =
            unit * (known.projector * (rows_.stress(cell, Vec3::Unit(j) * Vec3::Unit(k).transpose()) * n));
      for (int a = 0; a < dim; ++a) rows[std::size_t(a)].col(k) = slope * of_slope.row(a).transpose();
    }
    Vec3 traction = known.traction;
    if (!local.other_on_faces.empty())
      traction -= known.projector * (local.other_on_faces[std::size_t(f - mesh_.n_interior)] * n);
    for (int a = 0; a < dim; ++a)
      if (!known.projector.row(a).isZero(0))
        fit.add_row(rows[std::size_t(a)], unit * traction[a], of_scaled_traction);
  }
  fit.solve();
}

/// take(cell, stress) for the owned cells that wants(cell), with stress(place) [Pa].
template <class Wants, class Take>
void StressRecovery::visit(const DiscreteStress& found, const Wants& wants, const Take& take) const {
  const Local local = localise(found);
  Patch patch;
  QuadraticFit fit, other;
  const auto tensor_at = [](const QuadraticFit& of, const Vec3& place) {
    const Eigen::Matrix<double, tensor_size, 1> s = of.coefficients().transpose() * of.terms(place);
    return unpack({s.data(), tensor_size});
  };
  // Without strain there is no stress, whatever loads are about to act.
  const bool has_stress = parallel::any(
      mesh_.comm, std::ranges::any_of(found.cells, [](const Tensor3& s) { return !s.isZero(0); }));
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    if (!wants(c)) continue;
    if (!has_stress) {
      take(c, [](const Vec3&) { return Tensor3(Tensor3::Zero()); });
      continue;
    }
    gather(c, local, patch);
    if (!patch.simplices || !patch.at_surface || rows_.volume_by_cells()) {
      fit_tensors(c, local.cells, local.faces, &local.surface, patch, fit);
      take(c, [&](const Vec3& place) { return tensor_at(fit, place); });
      continue;
    }
    fit_displacement(c, local, patch, fit);
    const bool has_other = !local.other_in_cells.empty();
    if (has_other) fit_tensors(c, local.other_in_cells, local.other_on_faces, nullptr, patch, other);
    take(c, [&](const Vec3& place) {
      Tensor3 gradient = Tensor3::Zero();
      gradient.leftCols(mesh_.dim) = fit.slopes(place).transpose() * fit.coefficients();
      Tensor3 stress = rows_.stress(c, gradient);
      if (has_other) stress += tensor_at(other, place);
      if (plane_stress_) stress(2, 2) = 0;
      return stress;
    });
  }
}

SidedTensors StressRecovery::at_points(const DiscreteStress& found,
                                       std::span<const std::uint8_t> wanted) const {
  constexpr int size = tensor_size + 1;  // and how many cells there are
  const std::size_t n = std::size_t(mesh_.points.n_local());
  SidedTensors sums(std::size_t(number_of_materials(mesh_)), std::vector<double>(n * size, 0)), sides;
  const auto wants = [&](Index c) {
    return wanted.empty() ||
           std::ranges::any_of(mesh_.cell_points[c], [&](Index v) { return wanted[std::size_t(v)] != 0; });
  };
  visit(found, wants, [&](Index c, const auto& stress) {
    for (const Index v : mesh_.cell_points[c]) {
      double* at = sums[std::size_t(mesh_.material_of(c))].data() + std::size_t(v) * size;
      const PackedTensor here = pack(stress(geometry_.points[v]));
      for (std::size_t k = 0; k < tensor_size; ++k) at[k] += here[k];
      at[tensor_size] += 1;
    }
  });
  for (std::vector<double>& sum : sums) {
    mesh_.points.add_to_owners(sum, size);
    std::vector<double>& values = sides.emplace_back(n * tensor_size);
    for (std::size_t v = 0; v < n; ++v)
      for (std::size_t k = 0; k < tensor_size; ++k)
        values[v * tensor_size + k] = sum[v * size + k] / sum[v * size + tensor_size];
    mesh_.points.update_ghosts(values, tensor_size);
    std::vector<double>().swap(sum);
  }
  return sides;
}

double StressRecovery::least_scale(const DiscreteStress& found) const {
  double largest = 0, load = 0, displacement = 0, stiffest = 0;
  for (const auto* of : {&found.cells, &found.faces})
    for (const Tensor3& s : *of) largest = std::max(largest, s.norm());
  for (const auto* of : {&found.other_in_cells, &found.other_on_faces})
    for (const Tensor3& s : *of) load = std::max(load, s.norm());
  for (const double u : found.cell_u) displacement = std::max(displacement, std::abs(u));
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) stiffest = std::max(stiffest, rows_.lame(c).mu);
  const double strain =
      parallel::max(mesh_.comm, displacement) / mesh::extent_of(mesh_, geometry_).diagonal();
  load = parallel::max(mesh_.comm, std::max(load, stiffest * strain));
  return diagnostics::scale_of(small_part * parallel::max(mesh_.comm, largest), load);
}

std::vector<std::vector<double>> StressRecovery::left_at_points(const DiscreteStress& found,
                                                                std::span<const std::uint8_t> wanted,
                                                                const SidedTensors& sides) const {
  const auto has = [&](Index c, std::span<const std::uint8_t> flags) {
    return std::ranges::any_of(mesh_.cell_points[c], [&](Index v) { return flags[std::size_t(v)] != 0; });
  };
  std::vector<std::uint8_t> near(wanted.size(), 0);  // points of the cells that touch a wanted one
  for (Index c = 0; c < mesh_.cells.n_local(); ++c)
    if (has(c, wanted))
      for (const Index v : mesh_.cell_points[c]) near[std::size_t(v)] = 1;
  const double least = least_scale(found);
  std::vector<std::vector<PointShare>> shares(sides.size());
  std::vector<Index> around;
  visit(
      found, [&](Index c) { return has(c, near); },
      [&](Index c, const auto& fit) {
        const std::size_t material = std::size_t(mesh_.material_of(c));
        around.clear();
        for (const Index v : mesh_.cell_points[c])
          for (const Index d : cells_of_point_[v])
            if (mesh_.material_of(d) == mesh_.material_of(c))
              std::ranges::copy_if(mesh_.cell_points[d], std::back_inserter(around),
                                   [&](Index w) { return wanted[std::size_t(w)] != 0; });
        std::ranges::sort(around);
        around.erase(std::unique(around.begin(), around.end()), around.end());
        for (const Index w : around) {
          if (std::ranges::find(mesh_.cell_points[c], w) != mesh_.cell_points[c].end()) continue;
          const Tensor3 here =
              unpack(std::span(sides[material]).subspan(std::size_t(w) * tensor_size, tensor_size));
          if (const double size = std::max(here.norm(), least); size > 0)
            shares[material].push_back({mesh_.point_id[w], (fit(geometry_.points[w]) - here).norm() / size});
        }
      });
  std::vector<std::vector<double>> left;
  for (const std::vector<PointShare>& of_material : shares)
    left.push_back(medians(mesh_, of_material, wanted));
  return left;
}

}  // namespace couplet::solid
