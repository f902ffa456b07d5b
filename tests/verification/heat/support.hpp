// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mesh/load.hpp"
#include "solid_solver/diagnostics/view.hpp"
#include "tests/support/box.hpp"
#include "tests/support/test.hpp"
#include "tests/verification/solid/support.hpp"

namespace couplet::testing {
using namespace solid;
using HeatType = HeatBoundary::Type;
using HeatScheme = HeatParameters::Scheme;

inline HeatBoundary heat_boundary(HeatType type, const std::string& value) {
  HeatBoundary b;
  b.type = type;
  b.value = {value};
  return b;
}

inline HeatBoundary convection(const std::string& coefficient, const std::string& ambient) {
  HeatBoundary b;
  b.type = HeatType::convection;
  b.coefficient = {coefficient};
  b.ambient = {ambient};
  return b;
}

/// A mesh with the heat equation on it.
struct HeatCase {
  std::unique_ptr<mesh::LoadedMesh> loaded;
  std::unique_ptr<Heat> heat;

  HeatCase(const mesh::RawMesh& raw, const std::vector<HeatProperties>& materials, const HeatParameters& p,
           MPI_Comm comm = MPI_COMM_WORLD)
      : HeatCase(mesh::distribute(comm, raw), materials, p) {}
  HeatCase(mesh::LoadedMesh body, const std::vector<HeatProperties>& materials, const HeatParameters& p)
      : loaded(std::make_unique<mesh::LoadedMesh>(std::move(body))),
        heat(std::make_unique<Heat>(mesh(), geometry(), materials, p, std::vector<std::string>{})) {}

  const mesh::Mesh& mesh() const { return loaded->mesh; }
  const mesh::Geometry& geometry() const { return loaded->geometry; }
  void step(double dt) {
    heat->solve({heat->accepted().time, dt, coupling::Scheme::standalone, heat->accepted().steps});
    heat->accept_step();
  }
  /// Number of doubts that the program has in `steps` steps of length dt; `after` is called after each. `sentences`: what it
  /// says at the end.
  int doubts(int steps, double dt, const std::function<void()>& after = {},
             std::vector<std::string>* sentences = nullptr) {
    SolidParameters p;
    p.heat = heat->parameters();
    const SolidContext context;
    diagnostics::Diagnostics all(0, diagnostics::When::with_errors);
    add_diagnostics(HeatView{*heat, p, context}, all);
    const int before = diagnostics::doubts();
    for (int i = 0; i < steps; ++i) {
      step(dt);
      all.accepted(heat->accepted().time);
      if (after) after();
    }
    if (sentences) *sentences = all.conclude(false);
    return diagnostics::doubts() - before;
  }
  double temperature(Index cell) const { return heat->accepted().cells[cell]; }
  const Vec3& place(Index cell) const { return geometry().cell_centre[cell]; }

  using Exact = std::function<double(const Vec3&)>;
  /// Volume-weighted L2 norm of the error.
  double error(const Exact& exact) const {
    double squares = 0, volume = 0;
    for (Index c = 0; c < mesh().cells.n_owned(); ++c) {
      squares += geometry().volume[c] * std::pow(temperature(c) - exact(place(c)), 2);
      volume += geometry().volume[c];
    }
    return std::sqrt(parallel::sum(mesh().comm, squares) / parallel::sum(mesh().comm, volume));
  }
  /// Largest error of cells, boundary faces and points.
  double largest_error(const Exact& exact) const {
    double largest = 0;
    const auto see = [&](double value, const Vec3& x) {
      largest = std::max(largest, std::abs(value - exact(x)));
    };
    for (Index c = 0; c < mesh().cells.n_owned(); ++c) see(temperature(c), place(c));
    const std::vector<double> faces = heat->face_temperature(heat->accepted());
    for (std::size_t f = 0; f < faces.size(); ++f) see(faces[f], geometry().face_centre[f]);
    const std::vector<double> points = heat->point_temperature(heat->accepted());
    for (std::size_t v = 0; v < points.size(); ++v) see(points[v], geometry().points[v]);
    return parallel::max(mesh().comm, largest);
  }
};

inline HeatParameters steady() {
  HeatParameters p;
  p.analysis = HeatParameters::Analysis::steady;
  return p;
}

inline std::vector<std::string> box_patches(int dim) {
  std::vector<std::string> names{"xmin", "xmax", "ymin", "ymax"};
  if (dim == 3) names.insert(names.end(), {"zmin", "zmax"});
  return names;
}

/// A static box at the given temperature with thermal strain from 300 K on: alpha = 1.2e-5 1/K, symmetry at
/// xmin, ymin, zmin, free elsewhere.
inline SolidParameters warm_box(int dim, const std::string& temperature) {
  SolidParameters p = box_parameters(dim);
  p.temperature = config::ExpressionText{temperature};
  p.expansion = ThermalExpansion{300};
  p.material.heat.expansion = config::ExpressionText{"1.2e-5"};
  for (const char* name : {"xmin", "ymin", "zmin"})
    if (p.boundaries.contains(name)) p.boundaries[name] = boundary(Type::symmetry);
  return p;
}

inline mesh::RawMesh distorted_box(mesh::BoxCells cells) {
  mesh::RawMesh raw = mesh::make_box(cells, {5, 4, 3}, Vec3::Zero(), Vec3(1, 0.8, 0.6));
  mesh::perturb_interior(raw, 0.25, 11);
  return raw;
}

}  // namespace couplet::testing
