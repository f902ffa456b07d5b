// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "common/coupling/participant.hpp"
#include "common/fv/expression.hpp"
#include "common/mesh/mesh.hpp"
#include "solid_solver/parameters/parameters.hpp"
#include "solid_solver/thermal/heat.hpp"

namespace couplet::solid {

/// Heat conduction for this mesh and these parameters; `parameters.heat` must be set. Collective.
std::unique_ptr<Heat> make_heat(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                const SolidParameters& parameters);

/// Property `material.key`. Throws Error with `needed_by` if its text is missing.
fv::Property material_property(const std::optional<config::ExpressionText>& text, const std::string& key,
                               const char* needed_by);

/// Temperature of the solid [K]: solved by Heat, prescribed, or given at the interface. As for a Participant, only accept_step()
/// changes the accepted state.
class TemperatureField {
 public:
  TemperatureField(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const SolidParameters& parameters);

  /// Finds the temperature at the end of a step from t^n. `source`: see Heat::solve(). Throws SolveFailure. Collective.
  void solve(const coupling::Step& step, std::span<const double> source);
  void accept_step();
  /// Sets the interface faces of this rank and their centers, once and before the first step. take() receives the values there
  /// before each solve() (empty if not known yet). Collective.
  void set_interface(const std::vector<Vec3>& face_centres, const std::vector<Index>& faces);
  void take(const std::vector<double>& faces);
  /// Saves or loads the accepted state. Collective.
  void visit(io::Archive& archive);

  /// Temperature of the body without thermal strain.
  double reference() const {
    return parameters_.expansion ? parameters_.expansion->reference_temperature : 0;
  }
  /// nullptr unless it is solved for.
  const Heat* heat() const { return heat_.get(); }
  Heat* heat() { return heat_.get(); }
  /// Temperature of all local points at the accepted time. Collective.
  std::vector<double> of_points() const { return at(points, time_, false); }
  /// Likewise of all local cells, and at the end of the step.
  std::vector<double> of_cells() const { return at(cells, time_, false); }
  std::vector<double> trial_of_cells() const { return at(cells, step_.time + step_.dt, true); }
  /// Likewise of the flux faces, and at time t within the step.
  const std::vector<double>& of_faces() const { return start_; }
  std::vector<double> of_faces(double t) const;
  /// Lowest and highest temperature so far. Collective.
  std::pair<double, double> seen() const;

 private:
  enum Places { faces, points, cells };  // flux faces, local points, local cells
  bool is_given() const { return parameters_.interface_data && parameters_.interface_data->temperature; }
  // At an end of the step: T^{n+1} of the trial, or accepted. The reference before any value is given at the interface.
  std::vector<double> at(Places places, double t, bool trial) const;

  const mesh::Mesh* mesh_;
  const std::array<std::span<const Vec3>, 3> places_;  // one of each group
  const SolidParameters parameters_;
  std::unique_ptr<Heat> heat_;  // nullptr if prescribed or given
  std::optional<fv::Expression> prescribed_;
  struct Given {
    std::vector<Index> faces;                  // as entries of the boundary
    std::optional<InterfaceTemperature> from;  // once its position is known
    std::vector<double> accepted, trial;       // at the faces needed here
  } given_;                                    // at the interface
  coupling::Step step_;
  double time_ = 0;                       // accepted state
  std::vector<double> start_, end_;       // flux faces at both ends of the step
  std::pair<double, double> seen_{0, 0};  // lowest and highest on this rank
};

}  // namespace couplet::solid
