// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "common/elasticity/finite/finite_kernel.hpp"
#include "common/elasticity/finite/finite_loops.hpp"
#include "common/elasticity/finite/follower_pressure.hpp"
#include "common/elasticity/symmetric/symmetric_space.hpp"

namespace couplet::elastic {

/// FiniteKernel in D dimensions: finite_kernel.cpp (forces, tangent), finite_pressures.cpp (one volume ratio a cell, its
/// pressures), finite_tangents.cpp (dP/dF of faces).
template <int D>
class FiniteKernelOf final : public FiniteKernel {
 public:
  FiniteKernelOf(const mesh::Mesh& mesh, const ElasticOperator& rows, std::vector<const FiniteLaw*> laws,
                 bool plane_stress);

  void set_start(std::span<const double> unknowns, std::span<const double> known) override;
  void forget_start() override { has_start_ = false; }
  void set_pressure(std::span<const double> of_faces) override {
    pressure_.set(mesh_, rows_.geometry(), of_faces);
  }
  void set_stretch(std::span<const double> of_faces) override;
  bool has_pressure() const override { return !pressure_.empty(); }
  Vec3 pressure_force() const override { return pressure_force_; }
  void set_density(std::span<const double> of_cells) override {
    space_.set_density(of_cells), massive_ = true;
  }
  void set_own_pressures(bool on) override;
  void predict_pressures(std::span<const double> change, std::span<const double> known_change) override;
  void set_pressure_fraction(double fraction) override { fraction_ = fraction; }
  void accept_pressures() override;
  void add_pressure_defect(std::span<double> result) override;
  void linearise(std::span<const double> unknowns, std::span<const double> known, double mass_factor,
                 std::span<double> result) override;
  void apply_tangent(std::span<const double> v, std::span<const double> known, double mass_factor,
                     std::span<double> result) override;
  double energy() const override { return energy_; }
  Worst worst() const override { return worst_; }
  void visit(const Take& take) override;
  void visit_tangents(const std::function<void(const FaceTangent&)>& take) override;
  double modulus(Index cell) const override { return modulus_[std::size_t(cell)]; }
  Vec3 displacement(Index node) const override {
    Vec3 u = Vec3::Zero();
    for (int a = 0; a < D; ++a) u[a] = space_.nodes()[std::size_t(node) * SymmetricSpace<D>::stride + a];
    return u;
  }
  std::vector<Wrench> holding_forces(std::span<const double> unknowns, std::span<const double> known,
                                     const ElasticLoads& loads) override;

 private:
  void make_group(std::size_t material, bool shares, std::span<const Index> edge_index);
  void make_elsewhere();
  void stretch_edges();
  void make_edges(std::vector<Index>& edge_index);
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
  bool is_sheet_;
  std::vector<finite::Group<D>> groups_;
  finite::Group<D>
      elsewhere_;  // faces of owned cells that belong to other ranks: F alone; one volume ratio a cell
  std::unique_ptr<FiniteEdges> edges_;  // none: no three-cornered faces in space
  FollowerPressure<D> pressure_;
  Vec3 pressure_force_ = Vec3::Zero();
  bool massive_ = false, has_start_ = false;
  double energy_ = 0;
  Worst worst_;
  std::vector<double> of_cells_, volume_;  // of nodes: sums, then pressures; of owned cells; empty: faces'
  std::vector<double> swelling_;           // mean theta^3 of owned cells; empty: 1
  std::vector<double> modulus_;            // U'' / V of owned cells at the last linearise()
  std::vector<double> pressures_;          // of nodes there; with edges that share
  // Of owned cells: U'(J) at the last linearise(), and of pressures of their own p and its change.
  std::vector<double> bulk_pressure_, own_pressure_, pressure_change_;
  double fraction_ = 0;
};

}  // namespace couplet::elastic
