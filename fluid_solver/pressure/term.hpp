// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "common/io/checkpoint.hpp"
#include "fluid_solver/motion/scene.hpp"
#include "fluid_solver/pressure/pressure.hpp"

namespace couplet::fluid {

/// Right-hand side of the pressure equation.
struct RightSide {
  std::vector<double> b;  ///< per owned cell
  double size = -1;       ///< by which the solution is judged, see PressureEquation::solve(); below 0: |b|
};

/// A feature in the pressure equation. Every function is called once per step or solve and loops over its faces or cells itself. The
/// scene, the step and its prediction are those of the step under way.
template <int D>
class Term {
 public:
  Term(const Scene<D>& scene, const Step<D>& step, const Prediction<D>& prediction)
      : scene_(scene), mesh_(scene.mesh), step_(step), prediction_(prediction) {}
  virtual ~Term() = default;

  /// After the prediction from a level. Collective.
  virtual void prepare(const State<D>&) {}

  /// In this step the term gives the pressure of a closed domain a level.
  virtual bool sets_level() const { return false; }
  /// Changes where the entries of the matrix do, on a mesh that rests. 0 is that of a matrix without terms.
  virtual double version() const { return 0; }
  virtual void add_to_diagonal(Diagonal&) {}
  /// Entries beside those of the mesh; nullptr if there are none. add_to_diagonal() sets their values.
  virtual const Couplings* couplings() const { return nullptr; }
  /// A new matrix. Collective.
  virtual void respond(PressureEquation<D>&) {}

  /// Sets pressures, velocities and fluxes of the boundary as far as they are known before p. Collective.
  virtual void foresee(const State<D>&, Projected<D>&) {}
  /// Adds to the right-hand side. Collective.
  virtual void before(Projected<D>&, RightSide&) {}
  /// Sets pressures, velocities and fluxes of the boundary once p is known. Collective.
  virtual void after(Projected<D>&) {}

  /// Adds to the level what the next step needs and p determines.
  virtual void complete(PressureLevel<D>&) const {}
  /// Level n+1 in the place of level n. Collective.
  virtual void commit(const Projected<D>&, State<D>&) const {}
  /// A pressure and a state that no step made. Collective.
  virtual void start(const Placement<D>&, PressureLevel<D>&) const {}
  virtual void start(State<D>&) const {}

  /// State of the solvers beside the level, as of the last accept(). load() is collective.
  virtual void accept() {}
  virtual void save(io::CheckpointWriter&) const {}
  virtual void load(io::CheckpointReader&) {}

 protected:
  const Scene<D>& scene_;
  const mesh::Mesh& mesh_;
  const Step<D>& step_;
  const Prediction<D>& prediction_;
};

// The terms, each in the file of its name.

/// Walls of known mass (Robin condition). Collective.
template <int D>
std::unique_ptr<Term<D>> make_yielding_walls(const Scene<D>& scene, const Step<D>& step,
                                             const Prediction<D>& prediction);
/// Openings that let pressure waves out. Collective.
template <int D>
std::unique_ptr<Term<D>> make_absorbing_boundaries(const Scene<D>& scene, const Step<D>& step,
                                                   const Prediction<D>& prediction);
/// Weak compressibility.
template <int D>
std::unique_ptr<Term<D>> make_compression(const Scene<D>& scene, const Step<D>& step,
                                          const Prediction<D>& prediction);
/// A volume behind the inlets.
template <int D>
std::unique_ptr<Term<D>> make_upstream_volume(const Scene<D>& scene, const Step<D>& step,
                                              const Prediction<D>& prediction);

}  // namespace couplet::fluid
