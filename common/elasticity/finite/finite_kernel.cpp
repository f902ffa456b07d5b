// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/finite/finite_kernel.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "common/base/processor_clones.hpp"
#include "common/elasticity/finite/finite_loops.hpp"
#include "common/elasticity/finite/follower_pressure.hpp"
#include "common/elasticity/symmetric/symmetric_matrix.hpp"
#include "common/elasticity/symmetric/symmetric_space.hpp"
#include "common/fv/vertex_interpolation.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::elastic {
namespace {

// Blocks that a law evaluates in one call: their numbers stay in the first cache.
constexpr std::size_t chunk = 16;

// The loops for several generations of processors; the right one is picked when the program starts.
COUPLET_PROCESSOR_CLONES void deform_pass(std::span<const finite::FiniteBlock<3>> blocks,
                                          const finite::Values<3>& at, finite::State* states,
                                          Invariants* found) {
  finite::deform_loop<3>(blocks, at, states, found);
}
COUPLET_PROCESSOR_CLONES void deform_pass(std::span<const finite::FiniteBlock<2>> blocks,
                                          const finite::Values<2>& at, finite::State* states,
                                          Invariants* found) {
  finite::deform_loop<2>(blocks, at, states, found);
}
COUPLET_PROCESSOR_CLONES void stress_pass(finite::Group<3>& group, const finite::Values<3>& at) {
  group.law->has_second_invariant() ? finite::stress_loop<3, true>(group, at)
                                    : finite::stress_loop<3, false>(group, at);
}
COUPLET_PROCESSOR_CLONES void stress_pass(finite::Group<2>& group, const finite::Values<2>& at) {
  group.law->has_second_invariant() ? finite::stress_loop<2, true>(group, at)
                                    : finite::stress_loop<2, false>(group, at);
}
COUPLET_PROCESSOR_CLONES void tangent_pass(const finite::Group<3>& group, const finite::Values<3>& at) {
  group.law->has_second_invariant() ? finite::tangent_loop<3, true>(group, at)
                                    : finite::tangent_loop<3, false>(group, at);
}
COUPLET_PROCESSOR_CLONES void tangent_pass(const finite::Group<2>& group, const finite::Values<2>& at) {
  group.law->has_second_invariant() ? finite::tangent_loop<2, true>(group, at)
                                    : finite::tangent_loop<2, false>(group, at);
}

COUPLET_PROCESSOR_CLONES void volume_pass(const finite::Group<3>& group, const finite::Values<3>& at) {
  finite::volume_loop<3>(group, at);
}
COUPLET_PROCESSOR_CLONES void volume_pass(const finite::Group<2>& group, const finite::Values<2>& at) {
  finite::volume_loop<2>(group, at);
}

/// dW/dJ of a sheet from P_33 = 0: without the rounding of det F times the bulk modulus.
void balance(finite::State& state) {
  const finite::Tensor4& f = state.f;
  const Four square = f[0][0] * f[0][0] + f[0][1] * f[0][1] + f[1][0] * f[1][0] + f[1][1] * f[1][1];
  const Four area = f[0][0] * f[1][1] - f[0][1] * f[1][0];
  state.wj = -2.0 * f[2][2] * (state.w1 + square * state.w2) / area;
}

/// FiniteKernel in D dimensions.
template <int D>
class FiniteKernelOf final : public FiniteKernel {
 public:
  FiniteKernelOf(const mesh::Mesh& mesh, const ElasticOperator& rows, std::vector<const FiniteLaw*> laws,
                 bool plane_stress);

  void set_start(std::span<const double> unknowns, std::span<const double> known) override;
  void set_pressure(std::span<const double> of_faces) override {
    pressure_.set(mesh_, rows_.geometry(), of_faces);
  }
  void set_stretch(std::span<const double> of_faces) override;
  bool has_pressure() const override { return !pressure_.empty(); }
  void set_density(std::span<const double> of_cells) override {
    space_.set_density(of_cells), massive_ = true;
  }
  void predict_pressures(std::span<const double> change, std::span<const double> known_change) override;
  void add_pressure_defect(std::span<double> result) override;
  void linearise(std::span<const double> unknowns, std::span<const double> known, double mass_factor,
                 std::span<double> result) override;
  void apply_tangent(std::span<const double> v, std::span<const double> known, double mass_factor,
                     std::span<double> result) override;
  void visit(const Take& take) override;
  void visit_tangents(const std::function<void(const FaceTangent&)>& take) override;
  Vec3 displacement(Index node) const override {
    Vec3 u = Vec3::Zero();
    for (int a = 0; a < D; ++a) u[a] = space_.nodes()[std::size_t(node) * SymmetricSpace<D>::stride + a];
    return u;
  }
  std::vector<Wrench> holding_forces(std::span<const double> unknowns, std::span<const double> known,
                                     const ElasticLoads& loads) override;

 private:
  void stretch_edges();
  void internal_forces();
  void deform(finite::Group<D>& group);
  void find_pressures();
  void sum_volume_changes();
  void conserving_forces();
  void conserving_pressures();
  finite::Values<D> values();
  const FiniteLaw& law_of(Index cell) const {
    return *laws_[laws_.size() == 1 ? 0 : std::size_t(mesh_.material_of(cell))];
  }

  const mesh::Mesh& mesh_;
  const ElasticOperator& rows_;
  SymmetricSpace<D> space_;
  std::vector<const FiniteLaw*> laws_;
  std::vector<finite::Group<D>> groups_;
  finite::Group<D> elsewhere_;  // faces of owned cells that other ranks own: F alone; one volume ratio a cell
  std::unique_ptr<FiniteEdges> edges_;  // none: no three-cornered faces in space
  FollowerPressure<D> pressure_;
  bool massive_ = false;
  std::vector<double> of_cells_, volume_;  // of nodes: sums, then pressures; of owned cells; empty: faces'
  std::vector<double> swelling_;           // mean theta^3 of owned cells; empty: 1
  std::vector<double> pressures_;          // of nodes there; with edges that share
};

template <int D>
FiniteKernelOf<D>::FiniteKernelOf(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                  std::vector<const FiniteLaw*> laws, bool plane_stress)
    : mesh_(mesh), rows_(rows), space_(mesh, rows), laws_(std::move(laws)) {
  const SharedFaces shared = shared_faces(mesh, rows);
  if (parallel::any(mesh.comm, shared.n_mine > 0))
    edges_ = std::make_unique<FiniteEdges>(mesh, rows, shared.faces, shared.volume, laws_);
  for (std::size_t m = 0; m < laws_.size(); ++m) {
    const auto takes = [&](Index f) {
      return laws_.size() == 1 || std::size_t(mesh.material_of(mesh.owner[f])) == m;
    };
    for (int i = 0; i < (edges_ ? 2 : 1); ++i) {
      finite::Group<D>& group = groups_.emplace_back(
          finite::make_group<D>(mesh, rows, shared, i == 0 ? nullptr : &edges_->edges(), takes));
      group.law = laws_[m];
      group.states.resize(group.blocks.size());
      if (!plane_stress) continue;
      group.sheet.resize(group.blocks.size());
      group.thinning = finite::thinning(*group.law);
    }
  }
  if (!rows.volume_by_cells()) return;
  of_cells_.assign(space_.n_nodes(), 0);
  volume_ = pyramid_volumes(mesh, rows.geometry());
  modulus_.assign(volume_.size(), 0);
  bulk_pressure_ = modulus_;
  std::vector<Index> elsewhere;
  for (Index f = 0; f < mesh.n_interior; ++f)
    if (mesh.owner[f] >= mesh.cells.n_owned() && mesh.neighbour[f] < mesh.cells.n_owned())
      elsewhere.push_back(f);
  elsewhere_.blocks = finite::make_finite_blocks<D>(mesh, rows, elsewhere);
  elsewhere_.states.resize(elsewhere_.blocks.size());
}

template <int D>
finite::Values<D> FiniteKernelOf<D>::values() {
  return {space_.nodes(), space_.points(), space_.forces(), space_.point_forces(),
          of_cells_.empty() ? nullptr : of_cells_.data()};
}

/// States, energy and the worst volume ratio of one material's faces.
template <int D>
void FiniteKernelOf<D>::deform(finite::Group<D>& group) {
  std::array<Invariants, chunk> found;
  std::array<Energy, chunk> energy;
  for (std::size_t first = 0; first < group.blocks.size(); first += chunk) {
    const std::size_t n = std::min(chunk, group.blocks.size() - first);
    const std::span<const finite::FiniteBlock<D>> here(group.blocks.data() + first, n);
    const std::span<const Four> stretch(group.stretch.data() + (group.stretch.empty() ? 0 : first),
                                        group.stretch.empty() ? 0 : n);
    deform_pass(here, values(), group.states.data() + first, found.data());
    if (!group.sheet.empty())
      finite::relax(*group.law, group.thinning, stretch, {found.data(), n}, group.states.data() + first);
    for (std::size_t i = 0; i < n; ++i)
      for (int k = 0; k < 4; ++k)
        if (!(found[i].j[k] >= worst_.ratio)) worst_ = {found[i].j[k], here[i].face[k]};
    if (!(worst_.ratio > 0)) continue;  // laws know logarithms and roots
    finite::evaluate(*group.law, {found.data(), n}, stretch, of_cells_.empty(), {energy.data(), n});
    for (std::size_t i = 0; i < n; ++i) {
      finite::keep(energy[i], group.states[first + i]);
      if (!group.sheet.empty()) {
        balance(group.states[first + i]);
        group.sheet[first + i] = finite::sheet_of(group.states[first + i]);
      }
      for (int k = 0; k < 4; ++k) energy_ += group.own * here[i].volume[k] * energy[i].w[k];
    }
  }
}

template <int D>
void FiniteKernelOf<D>::internal_forces() {
  energy_ = 0;
  worst_ = {};
  std::ranges::fill(of_cells_, 0.0);
  for (finite::Group<D>& group : groups_) deform(group);
  for (std::size_t i = 0; i < elsewhere_.blocks.size(); ++i)
    finite::deformation<D>(elsewhere_.blocks[i], elsewhere_.blocks[i].inverse, space_.nodes(),
                           space_.points(), false, elsewhere_.states[i].f);
  if (edges_) {
    edges_->clear();
    for (const finite::Group<D>& group : groups_)
      finite::to_edges<D>(group, values(), false, edges_->values());
    edges_->finish_means();
    if (worst_.ratio > 0) {
      const double least = edges_->to_stress(of_cells_.empty(), energy_);
      if (!(least >= worst_.ratio)) worst_.ratio = least;
    }
  }
  // Inside out somewhere: the forces are not used, but the other ranks wait.
  if (!of_cells_.empty()) find_pressures();
  if (has_start_) return conserving_forces();
  if (!(worst_.ratio > 0)) return;
  for (finite::Group<D>& group : groups_) {
    stress_pass(group, values());
    if (edges_) finite::from_edges<D>(group, values(), edges_->values());
  }
}

template <int D>
void FiniteKernelOf<D>::linearise(std::span<const double> unknowns, std::span<const double> known,
                                  double mass_factor, std::span<double> result) {
  space_.fill(unknowns, known);
  space_.clear_forces();
  internal_forces();
  pressure_force_ = pressure_.add_forces(space_, 1);
  space_.add_springs(known);
  if (massive_ && mass_factor > 0) space_.add_mass_forces(mass_factor);
  space_.collect();
  space_.take_rows(unknowns, known, result);
}

template <int D>
void FiniteKernelOf<D>::apply_tangent(std::span<const double> v, std::span<const double> known,
                                      double mass_factor, std::span<double> result) {
  space_.fill(v, known);
  space_.clear_forces();
  if (!of_cells_.empty()) {
    sum_volume_changes();
    mesh_.cells.update_ghosts(std::span(of_cells_).first(std::size_t(mesh_.cells.n_local())));
  }
  for (const finite::Group<D>& group : groups_) tangent_pass(group, values());
  if (edges_) {
    edges_->clear();
    for (const finite::Group<D>& group : groups_)
      finite::to_edges<D>(group, values(), true, edges_->values());
    edges_->finish_means();
    edges_->to_tangent();
    for (const finite::Group<D>& group : groups_) finite::from_edges<D>(group, values(), edges_->values());
  }
  pressure_.add_tangent(space_, 1);
  space_.add_springs(known);
  if (massive_ && mass_factor > 0) space_.add_mass_forces(mass_factor);
  space_.collect();
  space_.take_rows(v, known, result);
}

/// With edges: what the face's share of them makes of both.
template <int D>
void FiniteKernelOf<D>::visit(const Take& take) {
  for (const finite::Group<D>& group : groups_)
    for (std::size_t i = 0; i < group.blocks.size(); ++i) {
      Four p[3][3];
      finite::stress<true>(group.states[i], p);
      for (int k = 0; k < 4; ++k) {
        if (group.blocks[i].face[k] < 0) continue;
        Tensor3 deformation, stress;
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b) {
            double f = group.states[i].f[a][b][k], s = group.own * p[a][b][k];
            if (!group.edges.empty()) {
              f = group.own * f + (a == b ? SharedEdges::share : 0);
              for (const Index edge : group.edges[i][std::size_t(k)]) {
                f += SharedEdges::share / 3 * edges_->gradient(edge)[a * 3 + b];
                s += SharedEdges::share / 3 * edges_->at(edge)[a * 3 + b];
              }
            }
            deformation(a, b) = f;
            stress(a, b) = s;
          }
        take(group.blocks[i].face[k], deformation, stress);
      }
    }
}

// One volume ratio a cell.

/// From V J of the cells to U'(J).
template <int D>
void FiniteKernelOf<D>::find_pressures() {
  const std::span<double> cells = std::span(of_cells_).first(std::size_t(mesh_.cells.n_local()));
  mesh_.cells.add_to_owners(cells);
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    const double swelling = swelling_.empty() ? 1 : swelling_[c];
    const BulkOf<double> bulk = law_of(c).bulk(cells[c] / (volume_[c] * swelling));
    cells[c] = bulk_pressure_[c] = bulk.pressure;
    if (!own_pressure_.empty()) cells[c] = own_pressure_[c] + fraction_ * pressure_change_[c];
    modulus_[c] = bulk.modulus / (volume_[c] * swelling);
    energy_ += volume_[c] * swelling * bulk.u;
  }
  mesh_.cells.update_ghosts(cells);
  if (edges_) pressures_ = of_cells_;
}

/// U'' dJ of owned cells for the change in the space.
template <int D>
void FiniteKernelOf<D>::sum_volume_changes() {
  std::ranges::fill(of_cells_, 0.0);
  for (const finite::Group<D>& group : groups_) volume_pass(group, values());
  const std::span<double> cells = std::span(of_cells_).first(std::size_t(mesh_.cells.n_local()));
  mesh_.cells.add_to_owners(cells);
  for (std::size_t c = 0; c < modulus_.size(); ++c) cells[c] *= modulus_[c];
}

template <int D>
void FiniteKernelOf<D>::predict_pressures(std::span<const double> change,
                                          std::span<const double> known_change) {
  space_.fill(change, known_change);
  sum_volume_changes();
  for (std::size_t c = 0; c < own_pressure_.size(); ++c)
    pressure_change_[c] = of_cells_[c] + bulk_pressure_[c] - own_pressure_[c];
}

template <int D>
void FiniteKernelOf<D>::add_pressure_defect(std::span<double> result) {
  const std::span<double> cells = std::span(of_cells_).first(std::size_t(mesh_.cells.n_local()));
  for (std::size_t c = 0; c < own_pressure_.size(); ++c)
    cells[c] = bulk_pressure_[c] - own_pressure_[c] - fraction_ * pressure_change_[c];
  mesh_.cells.update_ghosts(cells);
  space_.clear_forces();
  for (const finite::Group<D>& group : groups_) finite::pressure_loop<D>(group, values());
  space_.add_collected(result);
}

/// p* = [U(J_1) - U(J_0)] / (J_1 - J_0) of the cells, J_1 being that of 2 F - F_0.
template <int D>
void FiniteKernelOf<D>::conserving_pressures() {
  std::ranges::fill(of_cells_, 0.0);
  std::vector<double> before(of_cells_.size(), 0);
  for (const finite::Group<D>& group : groups_) {
    finite::end_volumes<D>(group, false, before);
    finite::end_volumes<D>(group, true, of_cells_);
  }
  const std::span<double> cells = std::span(of_cells_).first(std::size_t(mesh_.cells.n_local()));
  const std::span<double> starts = std::span(before).first(cells.size());
  mesh_.cells.add_to_owners(cells);
  mesh_.cells.add_to_owners(starts);
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    const double j1 = cells[c] / volume_[c], j0 = starts[c] / volume_[c];
    const FiniteLaw& law = law_of(c);
    cells[c] = std::abs(j1 - j0) > finite::smallest_change ? (law.bulk(j1).u - law.bulk(j0).u) / (j1 - j0)
                                                           : law.bulk(0.5 * (j0 + j1)).pressure;
  }
  mesh_.cells.update_ghosts(cells);
}

// The step that conserves energy; what holds a body at its patches.

/// F, W and the cells' J of the state where a step begins.
template <int D>
void FiniteKernelOf<D>::set_start(std::span<const double> unknowns, std::span<const double> known) {
  has_start_ = false;
  space_.fill(unknowns, known);
  space_.clear_forces();
  internal_forces();
  for (finite::Group<D>& group : groups_) {
    group.start.resize(group.states.size());
    for (std::size_t i = 0; i < group.states.size(); ++i) {
      finite::Start& start = group.start[i];
      std::memcpy(start.f, group.states[i].f, sizeof start.f);
      const Invariants at = finite::invariants(start.f);
      Energy energy;
      group.law->evaluate({&at, 1}, of_cells_.empty(), {&energy, 1});
      start.energy = energy.w;
    }
  }
  if (edges_) edges_->set_start(of_cells_.empty());
  has_start_ = true;
}

/// Forces of a step that conserves energy; the tangent stays that of the states in its middle, which is symmetric and differs
/// by the square of the step.
template <int D>
void FiniteKernelOf<D>::conserving_forces() {
  // The states' pressure belongs to their tangent.
  if (!of_cells_.empty())
    for (finite::Group<D>& group : groups_) finite::add_pressures<D>(group, of_cells_.data());
  for (const finite::Group<D>& group : groups_) {
    const double least = finite::least_end_ratio<D>(group);
    if (!(least >= worst_.ratio)) worst_.ratio = least;
  }
  const bool is_sound = parallel::min(mesh_.comm, worst_.ratio) > 0;
  if (!is_sound) {
    worst_.ratio = std::min(worst_.ratio, 0.0);
    return;
  }
  if (!of_cells_.empty()) conserving_pressures();
  if (edges_) edges_->to_conserving(of_cells_.empty());
  for (const finite::Group<D>& group : groups_) {
    finite::conserving_loop<D>(group, values());
    if (edges_) finite::from_edges<D>(group, values(), edges_->values());
  }
}

template <int D>
std::vector<Wrench> FiniteKernelOf<D>::holding_forces(std::span<const double> unknowns,
                                                      std::span<const double> known,
                                                      const ElasticLoads& loads) {
  has_start_ = false;
  set_own_pressures(false);
  space_.clear_forces();
  if (!loads.faces.empty()) space_.spread_face_forces(loads.faces);
  if (!loads.cells.empty()) space_.spread_cell_forces(loads.cells);
  space_.negate_forces();
  space_.fill(unknowns, known);
  internal_forces();
  pressure_force_ = pressure_.add_forces(space_, 1);
  space_.add_springs(known);
  return space_.held(known, true);
}

// Thermal stretches of faces, of the edges they share with, of cells.

template <int D>
void FiniteKernelOf<D>::set_stretch(std::span<const double> of_faces) {
  swelling_.clear();
  for (finite::Group<D>& group : groups_) {
    group.stretch.assign(of_faces.empty() ? 0 : group.blocks.size(), Four{} + 1.0);
    for (std::size_t i = 0; i < group.stretch.size(); ++i)
      for (int k = 0; k < 4; ++k)
        if (group.blocks[i].face[k] >= 0)
          group.stretch[i][k] = of_faces[std::size_t(group.blocks[i].face[k])];
  }
  if (edges_) of_faces.empty() ? edges_->forget_stretch() : stretch_edges();
  if (of_faces.empty() || of_cells_.empty()) return;
  swelling_.assign(volume_.size(), 0);
  const Index n = mesh_.cells.n_owned();
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
    const auto [here, there] = pyramids(mesh_, rows_.geometry(), f);
    const double theta = of_faces[std::size_t(f)], cube = theta * theta * theta;
    if (mesh_.owner[f] < n) swelling_[mesh_.owner[f]] += here * cube;
    if (f < mesh_.n_interior && mesh_.neighbour[f] < n) swelling_[mesh_.neighbour[f]] += there * cube;
  }
  for (std::size_t c = 0; c < swelling_.size(); ++c) swelling_[c] /= volume_[c];
}

/// The mean over the faces round an edge, as that of F. Collective.
template <int D>
void FiniteKernelOf<D>::stretch_edges() {
  edges_->clear();
  for (const finite::Group<D>& group : groups_)
    for (std::size_t i = 0; i < group.edges.size(); ++i)
      for (int k = 0; k < 4; ++k)
        for (const Index e : group.edges[i][std::size_t(k)])
          edges_->at(e)[0] += SharedEdges::share / 3 * group.blocks[i].volume[k] * (group.stretch[i][k] - 1);
  edges_->finish_means();
  edges_->take_stretch();
}

/// Uses nine changes of F. The edges see a pressure through their own F: the face takes it whole here.
template <int D>
void FiniteKernelOf<D>::visit_tangents(const std::function<void(const FaceTangent&)>& take) {
  for (const finite::Group<D>& group : groups_)
    for (std::size_t i = 0; i < group.blocks.size(); ++i) {
      finite::State state = group.states[i];
      if (group.own < 1 && !of_cells_.empty())
        state.wj -= (1 - group.own) / group.own * finite::between<D>(group.blocks[i], pressures_.data());
      FaceTangent of[4];
      Four h[3][3], df[3][3] = {}, dp[3][3];
      finite::cofactors(state.f, h);
      for (int column = 0; column < 9; ++column) {
        df[column / 3][column % 3] = Four{1, 1, 1, 1};
        finite::tangent<true>(state, df, Four{}, dp);
        if (D == 2 && !group.sheet.empty()) finite::condense(group.sheet[i], df, dp);
        df[column / 3][column % 3] = Four{};
        for (int k = 0; k < 4; ++k)
          for (int row = 0; row < 9; ++row) of[k].stiffness(row, column) = dp[row / 3][row % 3][k];
      }
      for (int k = 0; k < 4; ++k) {
        if (group.blocks[i].face[k] < 0) continue;
        of[k].face = group.blocks[i].face[k];
        for (int a = 0; a < 9; ++a) of[k].cofactors(a / 3, a % 3) = h[a / 3][a % 3][k];
        take(of[k]);
      }
    }
  for (std::size_t i = 0; i < elsewhere_.blocks.size(); ++i) {
    Four h[3][3];
    finite::cofactors(elsewhere_.states[i].f, h);
    for (int k = 0; k < 4; ++k) {
      FaceTangent of{elsewhere_.blocks[i].face[k], {}, {}};
      if (of.face < 0) continue;
      for (int a = 0; a < 9; ++a) of.cofactors(a / 3, a % 3) = h[a / 3][a % 3][k];
      take(of);
    }
  }
}

}  // namespace

void FiniteKernel::set_own_pressures(bool on) {
  own_pressure_ = on ? bulk_pressure_ : std::vector<double>();
  pressure_change_.assign(own_pressure_.size(), 0);
  fraction_ = 0;
}

void FiniteKernel::accept_pressures() {
  for (std::size_t c = 0; c < own_pressure_.size(); ++c) own_pressure_[c] += fraction_ * pressure_change_[c];
  std::ranges::fill(pressure_change_, 0.0);
  fraction_ = 0;
}

std::unique_ptr<FiniteKernel> make_finite_kernel(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                                 std::vector<const FiniteLaw*> of_materials,
                                                 bool plane_stress) {
  if (mesh.dim == 2)
    return std::make_unique<FiniteKernelOf<2>>(mesh, rows, std::move(of_materials), plane_stress);
  return std::make_unique<FiniteKernelOf<3>>(mesh, rows, std::move(of_materials), false);
}

/// V B_i^T (dP/dF) B_j, and what the nodes change of the cells' volumes.
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
