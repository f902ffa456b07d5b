// SPDX-License-Identifier: Apache-2.0
// Plates that several tests share.
#pragma once

#include "common/mesh/load.hpp"
#include "plate_modal/model/plate_model.hpp"
#include "plate_modal/motion/oscillators.hpp"
#include "tests/support/test.hpp"

namespace couplet::plate::test {

inline mesh::RawMesh square(int n, mesh::BoxCells cells = mesh::BoxCells::triangles, double distortion = 0) {
  mesh::RawMesh raw = mesh::make_box(cells, {n, n, 1}, Vec3::Zero(), Vec3(1, 1, 0));
  if (distortion > 0) mesh::perturb_interior(raw, distortion, 7);
  return raw;
}

/// A disc of radius 1 in n rings of triangles; its outline is the patch "rim".
inline mesh::RawMesh disc(int n) {
  mesh::RawMesh raw;
  raw.dim = 2;
  raw.points.push_back(Vec3::Zero());
  const auto first = [](int ring) { return ring == 0 ? 0 : 1 + 3 * ring * (ring - 1); };
  const auto at = [&](int ring, int i) {
    return Index(ring == 0 ? 0 : first(ring) + (i % (6 * ring) + 6 * ring) % (6 * ring));
  };
  for (int r = 1; r <= n; ++r)
    for (int i = 0; i < 6 * r; ++i) {
      const double angle = 2 * std::numbers::pi * i / (6 * r);
      raw.points.emplace_back(r * std::cos(angle) / n, r * std::sin(angle) / n, 0);
    }
  const auto add = [&](Index a, Index b, Index c) {
    raw.cell_points.push_row(std::array{a, b, c});
    raw.cell_type.push_back(mesh::CellType::triangle);
    raw.cell_zone.push_back(0);
  };
  for (int r = 1; r <= n; ++r)
    for (int side = 0; side < 6; ++side)
      for (int i = 0; i < r; ++i) {
        const int outer = side * r + i, inner = side * (r - 1) + i;
        add(at(r, outer), at(r, outer + 1), at(r - 1, inner));
        if (i + 1 < r) add(at(r - 1, inner), at(r, outer + 1), at(r - 1, inner + 1));
      }
  raw.zones = {"plate"};
  raw.patches = {"rim"};
  for (int i = 0; i < 6 * n; ++i) {
    raw.boundary_points.push_row(std::array{at(n, i), at(n, i + 1)});
    raw.boundary_patch.push_back(0);
  }
  return raw;
}

/// D = 1 N m and rho h = 1 kg/m^2, so that lambda = omega a^2.
inline PlateCell unit_cell() { return {0.01, 100, 12 * (1 - 0.09) / 1e-6, 0.3}; }

inline PlateModel make_plate(const mesh::RawMesh& raw, const std::map<std::string, Support>& held,
                             const PlateCell& cell = unit_cell()) {
  Midsurface surface = midsurface_of(raw);
  std::vector<Support> support;
  for (const std::string& patch : surface.patches)
    support.push_back(held.contains(patch) ? held.at(patch) : Support::free);
  const std::size_t n = surface.cells.size();
  return PlateModel(std::move(surface), std::vector<PlateCell>(n, cell), support);
}

inline std::map<std::string, Support> all_edges(Support support) {
  return {{"xmin", support}, {"xmax", support}, {"ymin", support}, {"ymax", support}, {"rim", support}};
}

inline std::vector<double> lambdas(const modes::EigenModes& modes) {
  std::vector<double> result;
  for (const double value : modes.eigenvalue) result.push_back(std::sqrt(std::max(0., value)));
  return result;
}

// A body of one rigid motion on a seat, for the tests of contact.

/// A square of 1 kg that can only rise and fall: one face of 1 m^2 looks down.
inline modes::ModalModel block() {
  modes::ModalModel model;
  model.vertices = {{0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, 0, 0}};
  model.faces.push_row(std::array<Index, 4>{0, 1, 2, 3});
  model.frequency = {0};
  for (int v = 0; v < 4; ++v) model.vertex_shape.insert(model.vertex_shape.end(), {0, 0, 1});
  model.participation = {0, 0, 1};
  model.mass = 1;
  modes::average_faces(model);
  return model;
}

/// It, on a seat `gap` below it at the start, with a speed at the start and an acceleration of gravity.
struct Bounce {
  Surface surface;
  Contact contact;
  Oscillators body;
  ModalState now, next;

  Bounce(double stiffness, double gap, double v, ContactRule rule, double gravity = 0)
      : surface(block()),
        contact(surface, parameters(stiffness, gap, rule), Vec3::UnitZ(), 0),
        body({0}, {0}, {gravity}, {time::TimeScheme::trapezoidal}, &contact),
        now(body.start({0}, {v})),
        next(now) {}
  static ContactParameters parameters(double stiffness, double gap, ContactRule rule) {
    ContactParameters p;
    p.height.text = fmt::format("{}", -gap);
    p.stiffness = stiffness;
    p.rule = rule;
    return p;
  }
  void step(double dt) {
    body.step(
        now, dt, [](double, std::span<double> load) { load[0] = 0; }, next);
    std::swap(now, next);
  }
};

}  // namespace couplet::plate::test
