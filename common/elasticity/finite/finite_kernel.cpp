// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/finite/finite_kernel.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/processor_clones.hpp"
#include "common/elasticity/symmetric/symmetric_matrix.hpp"
#include "common/fv/vertex_interpolation.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::elastic {
namespace {

// Number of blocks per call of a law, chosen to keep the data in the first-level cache.
constexpr std::size_t chunk = 16;

// Loops compiled for several generations of processors, selected at program start.
COUPLET_PROCESSOR_CLONES void deform_pass(finite::FaceSet& group, std::size_t first, const finite::Values& at,
                                          std::span<Invariants> found) {
  group.dim == 2 ? finite::deform_loop<2>(group, first, at, found)
                 : finite::deform_loop<3>(group, first, at, found);
}
COUPLET_PROCESSOR_CLONES void stress_pass(finite::FaceSet& group, const finite::Values& at) {
  if (group.law->has_second_invariant)
    group.dim == 2 ? finite::stress_loop<2, true>(group, at) : finite::stress_loop<3, true>(group, at);
  else
    group.dim == 2 ? finite::stress_loop<2, false>(group, at) : finite::stress_loop<3, false>(group, at);
}
COUPLET_PROCESSOR_CLONES void tangent_pass(const finite::FaceSet& group, const finite::Values& at) {
  if (group.law->has_second_invariant)
    group.dim == 2 ? finite::tangent_loop<2, true>(group, at) : finite::tangent_loop<3, true>(group, at);
  else
    group.dim == 2 ? finite::tangent_loop<2, false>(group, at) : finite::tangent_loop<3, false>(group, at);
}
COUPLET_PROCESSOR_CLONES void volume_pass(const finite::FaceSet& group, const finite::Values& at) {
  group.dim == 2 ? finite::volume_loop<2>(group, at) : finite::volume_loop<3>(group, at);
}

}  // namespace

FiniteKernel::FiniteKernel(const mesh::Mesh& mesh, const ElasticOperator& rows,
                           std::vector<FiniteLaw> of_materials, bool plane_stress)
    : mesh_(mesh), rows_(rows), space_(mesh, rows), laws_(std::move(of_materials)) {
  const SharedFaces shared = shared_faces(mesh, rows);
  if (parallel::any(mesh.comm, shared.n_mine > 0))
    edges_ = std::make_unique<FiniteEdges>(mesh, rows, shared, laws_);
  for (std::size_t m = 0; m < laws_.size(); ++m) {
    const auto takes = [&](Index f) {
      return laws_.size() == 1 || std::size_t(mesh.material_of(mesh.owner[f])) == m;
    };
    for (int i = 0; i < (edges_ ? 2 : 1); ++i) {
      finite::FaceSet& group = groups_.emplace_back();
      static_cast<FaceGroup&>(group) =
          make_group(mesh, rows, shared, i == 0 ? nullptr : &edges_->edges(), takes);
      group.dim = mesh.dim;
      group.law = &laws_[m];
      group.states.resize(group.blocks.size());
      if (plane_stress && mesh.dim == 2) group.set_plane_stress();
    }
  }
  if (!rows.volume_by_cells()) return;
  cells_.of_nodes.assign(space_.n_nodes(), 0);
  cells_.volume = pyramid_volumes(mesh, rows.geometry());
  cells_.modulus.assign(cells_.volume.size(), 0);
  cells_.pressure = cells_.modulus;
  std::vector<Index> elsewhere;
  for (Index f = 0; f < mesh.n_interior; ++f)
    if (mesh.owner[f] >= mesh.cells.n_owned() && mesh.neighbour[f] < mesh.cells.n_owned())
      elsewhere.push_back(f);
  static_cast<FaceGroup&>(elsewhere_) = make_group(mesh, rows, std::move(elsewhere));
  elsewhere_.dim = mesh.dim;
  elsewhere_.states.resize(elsewhere_.blocks.size());
}

FiniteKernel::~FiniteKernel() = default;

finite::Values FiniteKernel::values() {
  return {space_.values(), space_.forces(), cells_.of_nodes.empty() ? nullptr : cells_.of_nodes.data()};
}

/// Computes states, energy and the smallest volume ratio of one material's faces.
void FiniteKernel::deform(finite::FaceSet& group) {
  std::array<Invariants, chunk> invariants;
  std::array<Energy, chunk> energy;
  for (std::size_t first = 0; first < group.blocks.size(); first += chunk) {
    const std::size_t n = std::min(chunk, group.blocks.size() - first);
    const std::span<Invariants> found(invariants.data(), n);
    deform_pass(group, first, values(), found);
    group.relax(first, found);
    for (std::size_t i = 0; i < n; ++i)
      for (int k = 0; k < 4; ++k) worst_.take(found[i].j[k], group.volumes[first + i].face[k]);
    if (!(worst_.ratio > 0)) continue;  // laws contain logarithms and roots
    group.evaluate(first, found, cells_.of_nodes.empty(), {energy.data(), n});
    for (std::size_t i = 0; i < n; ++i)
      for (int k = 0; k < 4; ++k)
        energy_ += group.volumes[first + i].own[k] * group.volumes[first + i].whole[k] * energy[i].w[k];
  }
}

void FiniteKernel::internal_forces() {
  energy_ = 0;
  worst_ = {};
  std::ranges::fill(cells_.of_nodes, 0.0);
  for (finite::FaceSet& group : groups_) deform(group);
  for (std::size_t i = 0; i < elsewhere_.blocks.size(); ++i) {
    const auto deformation = mesh_.dim == 2 ? finite::deformation<2> : finite::deformation<3>;
    deformation(elsewhere_.blocks[i], space_.values(), false, elsewhere_.states[i].f);
  }
  if (edges_) {
    edges_->clear();
    for (const finite::FaceSet& group : groups_) finite::to_edges(group, space_.values(), edges_->values());
    edges_->finish_means();
    if (worst_.ratio > 0) worst_.take(edges_->to_stress(cells_.of_nodes.empty(), energy_), worst_.face);
  }
  // If a face is inverted, the forces are not used, but the other ranks wait for the collective call.
  if (!cells_.of_nodes.empty()) find_pressures();
  if (has_start_) return conserving_forces();
  if (!(worst_.ratio > 0)) return;
  for (finite::FaceSet& group : groups_) {
    stress_pass(group, values());
    if (edges_) finite::from_edges(group, edges_->values(), space_.forces());
  }
}

/// Adds springs and inertia, and computes the rows of all forces.
void FiniteKernel::finish(std::span<const double> unknowns, std::span<const double> known, double mass_factor,
                          std::span<double> result) {
  space_.add_springs(known);
  if (mass_factor > 0) space_.add_mass_forces(mass_factor);
  space_.collect();
  space_.take_rows(unknowns, known, result);
}

void FiniteKernel::linearise(std::span<const double> unknowns, std::span<const double> known,
                             double mass_factor, std::span<double> result) {
  space_.fill(unknowns, known);
  space_.clear_forces();
  internal_forces();
  pressure_force_ = pressure_.add_forces(space_);
  finish(unknowns, known, mass_factor, result);
}

void FiniteKernel::apply_tangent(std::span<const double> v, std::span<const double> known, double mass_factor,
                                 std::span<double> result) {
  space_.fill(v, known);
  space_.clear_forces();
  if (!cells_.of_nodes.empty()) {
    sum_volume_changes();
    mesh_.cells.update_ghosts(std::span(cells_.of_nodes).first(std::size_t(mesh_.cells.n_local())));
  }
  for (const finite::FaceSet& group : groups_) tangent_pass(group, values());
  if (edges_) {
    edges_->clear();
    for (const finite::FaceSet& group : groups_) finite::to_edges(group, space_.values(), edges_->values());
    edges_->finish_means();
    edges_->to_tangent();
    for (const finite::FaceSet& group : groups_) finite::from_edges(group, edges_->values(), space_.forces());
  }
  pressure_.add_tangent(space_);
  finish(v, known, mass_factor, result);
}

/// Includes the share of the edges, if there are any.
void FiniteKernel::visit(const Take& take) {
  for (const finite::FaceSet& group : groups_)
    for (std::size_t i = 0; i < group.blocks.size(); ++i) {
      Four p[3][3];
      finite::stress<true>(group.states[i], p);
      for (int k = 0; k < 4; ++k) {
        if (group.volumes[i].face[k] < 0) continue;
        const double own = group.volumes[i].own[k];
        Tensor3 deformation, stress;
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b) {
            double f = group.states[i].f[a][b][k], s = own * p[a][b][k];
            if (!group.edges.empty()) {
              f = own * f + (a == b ? 1 - own : 0);
              for (const Index edge : group.edges[i][std::size_t(k)]) {
                f += (1 - own) / 3 * edges_->gradient(edge)[a * 3 + b];
                s += (1 - own) / 3 * edges_->at(edge)[a * 3 + b];
              }
            }
            deformation(a, b) = f;
            stress(a, b) = s;
          }
        take(group.volumes[i].face[k], deformation, stress);
      }
    }
}

// The following functions belong to the formulation with one volume ratio per cell.

void FiniteKernel::set_own_pressures(bool on) {
  cells_.own = on ? cells_.pressure : std::vector<double>();
  cells_.change.assign(cells_.own.size(), 0);
  cells_.fraction = 0;
}

void FiniteKernel::accept_pressures() {
  for (std::size_t c = 0; c < cells_.own.size(); ++c) cells_.own[c] += cells_.fraction * cells_.change[c];
  std::ranges::fill(cells_.change, 0.0);
  cells_.fraction = 0;
}

/// Returns the values of the local cells.
std::span<double> FiniteKernel::sum_over_ranks(std::vector<double>& of_nodes) const {
  const std::span<double> cells = std::span(of_nodes).first(std::size_t(mesh_.cells.n_local()));
  mesh_.cells.add_to_owners(cells);
  return cells;
}

/// Converts V J of the cells to U'(J).
void FiniteKernel::find_pressures() {
  const std::span<double> cells = sum_over_ranks(cells_.of_nodes);
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    const double volume = cells_.volume[c] * (cells_.swelling.empty() ? 1 : cells_.swelling[c]);
    const BulkOf<double> bulk = law_of(c).bulk(cells[c] / volume);
    cells[c] = cells_.pressure[c] = bulk.pressure;
    if (!cells_.own.empty()) cells[c] = cells_.own[c] + cells_.fraction * cells_.change[c];
    cells_.modulus[c] = bulk.modulus / volume;
    energy_ += volume * bulk.u;
  }
  mesh_.cells.update_ghosts(cells);
  if (edges_) cells_.there = cells_.of_nodes;
}

/// Computes U'' dJ of owned cells for the increment in the space.
void FiniteKernel::sum_volume_changes() {
  std::ranges::fill(cells_.of_nodes, 0.0);
  for (const finite::FaceSet& group : groups_) volume_pass(group, values());
  const std::span<double> cells = sum_over_ranks(cells_.of_nodes);
  for (std::size_t c = 0; c < cells_.modulus.size(); ++c) cells[c] *= cells_.modulus[c];
}

void FiniteKernel::predict_pressures(std::span<const double> change, std::span<const double> known_change) {
  space_.fill(change, known_change);
  sum_volume_changes();
  for (std::size_t c = 0; c < cells_.own.size(); ++c)
    cells_.change[c] = cells_.of_nodes[c] + cells_.pressure[c] - cells_.own[c];
}

void FiniteKernel::add_pressure_defect(std::span<double> result) {
  const std::span<double> cells = std::span(cells_.of_nodes).first(std::size_t(mesh_.cells.n_local()));
  for (std::size_t c = 0; c < cells_.own.size(); ++c)
    cells[c] = cells_.pressure[c] - cells_.own[c] - cells_.fraction * cells_.change[c];
  mesh_.cells.update_ghosts(cells);
  space_.clear_forces();
  for (const finite::FaceSet& group : groups_) finite::pressure_loop(group, values());
  space_.add_collected(result);
}

/// Conserving pressure p* = [U(J_1) - U(J_0)] / (J_1 - J_0) of the cells, where J_1 belongs to 2 F - F_0.
void FiniteKernel::conserving_pressures() {
  std::ranges::fill(cells_.of_nodes, 0.0);
  std::vector<double> before(cells_.of_nodes.size(), 0);
  for (const finite::FaceSet& group : groups_)
    finite::end_volumes(group, before.data(), cells_.of_nodes.data());
  const std::span<double> cells = sum_over_ranks(cells_.of_nodes), starts = sum_over_ranks(before);
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    const double j1 = cells[c] / cells_.volume[c], j0 = starts[c] / cells_.volume[c];
    const FiniteLaw& law = law_of(c);
    cells[c] = std::abs(j1 - j0) > finite::smallest_change ? (law.bulk(j1).u - law.bulk(j0).u) / (j1 - j0)
                                                           : law.bulk(0.5 * (j0 + j1)).pressure;
  }
  mesh_.cells.update_ghosts(cells);
}

// Energy-conserving steps and reaction forces.

/// Stores F, W and J of the cells at the start of a step.
void FiniteKernel::set_start(std::span<const double> unknowns, std::span<const double> known) {
  has_start_ = false;
  space_.fill(unknowns, known);
  space_.clear_forces();
  internal_forces();
  for (finite::FaceSet& group : groups_) group.set_start(cells_.of_nodes.empty());
  if (edges_) edges_->set_start(cells_.of_nodes.empty());
  has_start_ = true;
}

/// Adds the forces of an energy-conserving step. The tangent remains that of the midpoint states. It is
/// symmetric and differs by the square of the step.
void FiniteKernel::conserving_forces() {
  for (finite::FaceSet& group : groups_) {
    // The tangent includes the pressure of the midpoint states.
    if (!cells_.of_nodes.empty())
      for (std::size_t i = 0; i < group.blocks.size(); ++i)
        group.states[i].wj +=
            finite::between(group, i, cells_.of_nodes.data()) / blocks::wide(group.volumes[i].own);
    worst_.take(finite::least_end_ratio(group), worst_.face);
  }
  const bool is_sound = parallel::min(mesh_.comm, worst_.ratio) > 0;
  if (!is_sound) {
    worst_.ratio = std::min(worst_.ratio, 0.0);
    return;
  }
  if (!cells_.of_nodes.empty()) conserving_pressures();
  if (edges_) edges_->to_conserving(cells_.of_nodes.empty());
  for (const finite::FaceSet& group : groups_) {
    finite::conserving_loop(group, values());
    if (edges_) finite::from_edges(group, edges_->values(), space_.forces());
  }
}

std::vector<Wrench> FiniteKernel::holding_forces(std::span<const double> unknowns,
                                                 std::span<const double> known, const ElasticLoads& loads) {
  has_start_ = false;
  set_own_pressures(false);
  space_.clear_forces();
  if (!loads.faces.empty()) space_.spread_face_forces(loads.faces);
  if (!loads.cells.empty()) space_.spread_cell_forces(loads.cells);
  space_.negate_forces();
  space_.fill(unknowns, known);
  internal_forces();
  pressure_force_ = pressure_.add_forces(space_);
  space_.add_springs(known);
  return space_.held(known, true);
}

// Sets thermal stretches of faces, shared edges and cells.

void FiniteKernel::set_stretch(std::span<const double> of_faces) {
  cells_.swelling.clear();
  for (finite::FaceSet& group : groups_) {
    group.stretch.assign(of_faces.empty() ? 0 : group.blocks.size(), Four{} + 1.0);
    for (std::size_t i = 0; i < group.stretch.size() * 4 && i < group.faces.size(); ++i)
      group.stretch[i / 4][i % 4] = of_faces[std::size_t(group.faces[i])];
  }
  if (edges_) of_faces.empty() ? edges_->forget_stretch() : stretch_edges();
  if (of_faces.empty() || cells_.of_nodes.empty()) return;
  cells_.swelling.assign(cells_.volume.size(), 0);
  visit_pyramids(mesh_, rows_.geometry(), [&](Index c, Index f, double pyramid) {
    const double theta = of_faces[std::size_t(f)];
    cells_.swelling[c] += pyramid * (theta * theta * theta);
  });
  for (std::size_t c = 0; c < cells_.swelling.size(); ++c) cells_.swelling[c] /= cells_.volume[c];
}

/// Averages the stretches of the faces around each edge, like F. Collective.
void FiniteKernel::stretch_edges() {
  edges_->clear();
  for (const finite::FaceSet& group : groups_)
    for (std::size_t i = 0; i < group.edges.size(); ++i)
      for (int k = 0; k < 4; ++k)
        for (const Index e : group.edges[i][std::size_t(k)])
          edges_->at(e)[0] += blocks::part_of_edges(group.volumes[i])[k] * (group.stretch[i][k] - 1);
  edges_->finish_means();
  edges_->take_stretch();
}

/// Computes nine changes of F. A pressure acts on edges through their own F; here the face takes all of it.
void FiniteKernel::visit_tangents(const std::function<void(const FaceTangent&)>& take) {
  const auto take_cofactors = [](const finite::StrainState& state, FaceTangent(&of)[4]) {
    Four h[3][3];
    finite::cofactors(state.f, h);
    for (int k = 0; k < 4; ++k)
      for (int a = 0; a < 9; ++a) of[k].cofactors(a / 3, a % 3) = h[a / 3][a % 3][k];
  };
  const auto give = [&](const FaceVolumes& volumes, FaceTangent(&of)[4]) {
    for (int k = 0; k < 4; ++k) {
      of[k].face = volumes.face[k];
      if (of[k].face >= 0) take(of[k]);
    }
  };
  for (const finite::FaceSet& group : groups_)
    for (std::size_t i = 0; i < group.blocks.size(); ++i) {
      finite::StrainState state = group.states[i];
      const Four own = blocks::wide(group.volumes[i].own);
      if (!group.edges.empty() && !cells_.of_nodes.empty())
        state.wj -= (1 - own) / own * finite::between(group, i, cells_.there.data());
      FaceTangent of[4];
      take_cofactors(state, of);
      Four df[3][3] = {}, dp[3][3];
      for (int column = 0; column < 9; ++column) {
        df[column / 3][column % 3] = Four{1, 1, 1, 1};
        finite::tangent<true>(state, df, Four{}, dp);
        if (!group.sheet.empty()) finite::condense(group.sheet[i], df, dp);
        df[column / 3][column % 3] = Four{};
        for (int k = 0; k < 4; ++k)
          for (int row = 0; row < 9; ++row) of[k].stiffness(row, column) = dp[row / 3][row % 3][k];
      }
      give(group.volumes[i], of);
    }
  for (std::size_t i = 0; i < elsewhere_.blocks.size(); ++i) {
    FaceTangent of[4] = {};
    take_cofactors(elsewhere_.states[i], of);
    give(elsewhere_.volumes[i], of);
  }
}

/// Assembles V B_i^T (dP/dF) B_j and the derivatives of the cell volumes.
linalg::SparseMatrix finite_matrix(const mesh::Mesh& mesh, const ElasticOperator& rows, FiniteKernel& kernel,
                                   std::span<const double> of_nodes) {
  const Numbering number{fv::number_nodes(mesh, rows.unknown_faces()), {}};
  Assembly assembly(mesh, rows, number);
  kernel.visit_tangents([&](const FiniteKernel::FaceTangent& tangent) {
    const FaceRows face = face_rows(mesh, rows, tangent.face);
    const FaceTermList& terms = assembly.terms().of_face(face);
    if (rows.volume_by_cells()) assembly.add_volume_terms(tangent.face, terms, tangent.cofactors);
    if (mesh.owner[tangent.face] < mesh.cells.n_owned()) assembly.add(terms, face.volume * tangent.stiffness);
  });
  assembly.finish_volumes([&](Index c) { return kernel.modulus(c); });
  assembly.add_supports();
  assembly.add_diagonals(of_nodes);
  return assembly.matrix(rows.n_unknowns() / std::size_t(mesh.dim));
}

}  // namespace couplet::elastic
