// SPDX-License-Identifier: Apache-2.0
// Clamped beams of square section under a force at the tip, symmetric face gradient: few cells across, slender, stretched,
// near incompressibility. Reference: cubes two and four across, extrapolated by their order 2.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <utility>

#include "common/mesh/topology.hpp"
#include "common/parallel/collective.hpp"
#include "tests/verification/solid/support.hpp"

namespace couplet::testing::beams_test {
using namespace mesh;
namespace {

/// Axis of the prisms: across the beam in the load's direction, across the other way, along the beam.
enum class Cut {
  hexahedra,
  six_tetrahedra,
  five_tetrahedra,
  prisms_along_load,
  prisms_across,
  prisms_along_beam
};

const char* name(Cut cut) {
  constexpr std::array names{"hexahedra",         "six_tetrahedra", "five_tetrahedra",
                             "prisms_along_load", "prisms_across",  "prisms_along_beam"};
  return names[std::size_t(cut)];
}

/// Each hexahedron as five tetrahedra, the diagonals of neighbours' faces by the parity of the cell's place.
RawMesh in_five(const RawMesh& box, const std::array<int, 3>& n) {
  RawMesh cut = box;
  cut.cell_type.clear();
  cut.cell_zone.clear();
  cut.cell_points = {};
  Index c = 0;
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i, ++c) {
        const auto p = box.cell_points[c];
        constexpr std::array<std::array<int, 4>, 5> even{
            {{0, 1, 2, 5}, {0, 2, 3, 7}, {0, 5, 7, 4}, {2, 7, 5, 6}, {0, 2, 7, 5}}};
        constexpr std::array<std::array<int, 4>, 5> odd{
            {{1, 2, 3, 6}, {0, 1, 3, 4}, {1, 6, 4, 5}, {3, 4, 6, 7}, {1, 3, 4, 6}}};
        for (const auto& t : (i + j + k) % 2 == 0 ? even : odd) {
          const std::array<Index, 4> corners{p[t[0]], p[t[1]], p[t[2]], p[t[3]]};
          cut.cell_type.push_back(CellType::tetrahedron);
          cut.cell_zone.push_back(0);
          cut.cell_points.push_row({corners.data(), corners.size()});
        }
      }
  // The patches of the halves are those of the quadrilaterals that they were.
  std::map<int, std::pair<int, double>> plane;  // patch: axis and place
  for (int s = 0; s < 6; ++s) plane[s] = {s / 2, s % 2 == 0 ? 1e300 : -1e300};
  for (const Vec3& x : box.points)
    for (int s = 0; s < 6; ++s)
      plane[s].second =
          s % 2 == 0 ? std::min(plane[s].second, x[s / 2]) : std::max(plane[s].second, x[s / 2]);
  cut.boundary_points = outer_faces(cut);
  cut.boundary_patch.clear();
  for (Index f = 0; f < cut.boundary_points.size(); ++f)
    for (const auto& [side, at] : plane) {
      bool lies = true;
      for (const Index v : cut.boundary_points[f])
        lies = lies && std::abs(cut.points[v][at.first] - at.second) < 1e-9;
      if (lies) {
        cut.boundary_patch.push_back(side);
        break;
      }
    }
  return cut;
}

struct Beam {
  Cut cut = Cut::hexahedra;
  int along = 0, across = 0;
  double length = 10;
  double nu = 0.3;
  double moved = 0;  ///< interior vertices, part of the spacing
};

struct Answer {
  double tip = 0;
  StrainAudit audit;
};

/// Mean deflection of the end; section 1 m x 1 m.
Answer bent(const Beam& beam) {
  const bool upright = beam.cut == Cut::prisms_along_beam;  // the box's prisms stand along z
  const std::array<int, 3> n = upright ? std::array{beam.across, beam.across, beam.along}
                                       : std::array{beam.along, beam.across, beam.across};
  const Vec3 size = upright ? Vec3(1, 1, beam.length) : Vec3(beam.length, 1, 1);
  const int down = beam.cut == Cut::prisms_along_load ? 2 : 1;
  const BoxCells cells = beam.cut == Cut::six_tetrahedra ? BoxCells::tetrahedra
                         : beam.cut == Cut::hexahedra || beam.cut == Cut::five_tetrahedra
                             ? BoxCells::hexahedra
                             : BoxCells::prisms;
  RawMesh raw = make_box(cells, n, Vec3::Zero(), size);
  if (beam.moved > 0) perturb_interior(raw, beam.moved, 3);
  if (beam.cut == Cut::five_tetrahedra) raw = in_five(raw, n);
  SolidParameters p = box_parameters(3);
  p.material = {1000, 1e6, beam.nu};
  p.method.face_gradient = FaceGradient::symmetric;
  const std::string root = upright ? "zmin" : "xmin", end = upright ? "zmax" : "xmax";
  p.boundaries[root] = boundary(Type::fixed_displacement, {"0", "0", "0"});
  p.boundaries[end] = boundary(Type::traction, {"0", down == 1 ? "1" : "0", down == 2 ? "1" : "0"});
  const auto solid = make_solid(raw, p);
  step(*solid, 1);
  const Mesh& mesh = solid->body().mesh();
  const Geometry& geometry = solid->body().geometry();
  const Patch* patch = mesh.find_patch(end);
  double moved = 0, area = 0;
  for (Index f = patch->first; f < patch->first + patch->count; ++f) {
    const double s = geometry.face_area[f].norm();
    moved += s * solid->stepper().state().face_u[std::size_t(f - mesh.n_interior) * 3 + std::size_t(down)];
    area += s;
  }
  return {parallel::sum(mesh.comm, moved) / parallel::sum(mesh.comm, area), audit_of(*solid)};
}

/// Cubes two and four across (near incompressibility four and eight), extrapolated.
double reference(double length, double nu) {
  static std::map<std::pair<double, double>, double> known;
  const auto [place, is_new] = known.try_emplace({length, nu}, 0.0);
  if (is_new) {
    const int n = nu > 0.4 ? 4 : 2;
    const double coarse = bent({Cut::hexahedra, int(length) * n, n, length, nu}).tip;
    const double fine = bent({Cut::hexahedra, int(length) * 2 * n, 2 * n, length, nu}).tip;
    place->second = fine + (fine - coarse) / 3;
  }
  return place->second;
}

double error(const Beam& beam) { return bent(beam).tip / reference(beam.length, beam.nu) - 1; }

void record(const std::string& key, double value) {
  fmt::print("{}: {:+.4f}\n", key, value);
  ::testing::Test::RecordProperty(key, fmt::format("{:.5f}", value));
}

// Force of 1 N; 3-D, refined, at 10:1: 0.0040042 m (three-dimensional finite elements).
TEST(Beams, slender_ones_of_long_hexahedra) {
  EXPECT_NEAR(reference(10, 0.3), 0.0040042, 2e-4 * 0.0040042);
  const double exact =
      100. * 100 * 100 / (3 * 1e6 / 12) * (1 + 0.78e-4);  // Timoshenko, shear coefficient 5/6
  for (const auto& [along, limit] : {std::pair{40, 0.01}, std::pair{100, 0.005}}) {
    const double gap = bent({Cut::hexahedra, along, 4, 100}).tip / exact - 1;
    record(fmt::format("hexahedra_{}", along), gap);
    EXPECT_LT(std::abs(gap), limit);
  }
}

TEST(Beams, of_long_hexahedra_with_moved_vertices) {
  const double gap = error({Cut::hexahedra, 10, 4, 10, 0.3, 0.2});
  record("moved", gap);
  EXPECT_LT(std::abs(gap), 0.17);
  EXPECT_LT(gap, 0);
}

// Hexahedra and tetrahedra 5 %, prisms 10 %, two across; without the cell's volume strain they lock.
TEST(Beams, near_incompressibility) {
  for (const Cut cut : {Cut::hexahedra, Cut::six_tetrahedra, Cut::five_tetrahedra, Cut::prisms_across}) {
    const double gap = error({cut, 20, 2, 10, 0.4999});
    record(std::string("incompressible_") + name(cut), gap);
    EXPECT_LT(std::abs(gap), cut == Cut::prisms_across ? 0.1 : 0.05);
  }
}

TEST(Beams, of_tetrahedra_in_every_slenderness) {
  for (const Cut cut : {Cut::six_tetrahedra, Cut::five_tetrahedra})
    for (const int across : {2, 4})
      for (const double length : {10., 20., 40., 100.}) {
        const double gap = error({cut, int(length) * across, across, length});
        record(fmt::format("{}_{}_{}", name(cut), across, int(length)), gap);
        EXPECT_LT(std::abs(gap), 0.02);
      }
}

TEST(Beams, of_prisms_in_every_direction) {
  for (const Cut cut : {Cut::prisms_along_load, Cut::prisms_across, Cut::prisms_along_beam})
    for (const int across : {2, 4}) {
      const double gap = error({cut, 10 * across, across, 10});
      record(fmt::format("{}_{}", name(cut), across), gap);
      EXPECT_LT(std::abs(gap), across == 2 ? 0.07 : 0.025);
    }
}

// Four across, cells 4:1: stiff, and the difference of the gradients says so; with cubes it does not.
TEST(Beams, of_stretched_cells_in_every_cut) {
  for (const Cut cut : {Cut::six_tetrahedra, Cut::five_tetrahedra, Cut::prisms_along_load, Cut::prisms_across,
                        Cut::prisms_along_beam})
    for (const double length : {20., 100.}) {
      const Answer stiff = bent({cut, int(length), 4, length});
      const double gap = stiff.tip / reference(length, 0.3) - 1;
      record(fmt::format("stretched_{}_{}", name(cut), int(length)), gap);
      record(fmt::format("told_{}_{}", name(cut), int(length)), stiff.audit.gradient_difference);
      EXPECT_LT(std::abs(gap), 0.21);  // five tetrahedra a cell at 100:1: 0.2026
      EXPECT_LT(gap, 0);
      EXPECT_GT(stiff.audit.gradient_difference, 0.35);
    }
  const Answer sound = bent({Cut::six_tetrahedra, 80, 4, 20});
  record("told_of_cubes", sound.audit.gradient_difference);
  EXPECT_LT(sound.audit.gradient_difference, 0.25);
}

}  // namespace
}  // namespace couplet::testing::beams_test
