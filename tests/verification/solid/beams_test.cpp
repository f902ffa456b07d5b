// SPDX-License-Identifier: Apache-2.0
// Clamped beams of square section under a force at the tip, symmetric face gradient: few cells across, slender, stretched,
// near incompressibility. Reference: cubes two and four across, extrapolated by their order 2.
#include "common/io/probes/probe.hpp"
#include "common/mesh/topology.hpp"
#include "tests/verification/solid/loads_support.hpp"

namespace couplet::testing::beams_test {
using namespace mesh;

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
  p.boundaries[root] = clamped(3);
  p.boundaries[end] = boundary(Type::traction, {"0", down == 1 ? "1" : "0", down == 2 ? "1" : "0"});
  const auto solid = stepped(raw, p);
  return {mean_on(*solid, end)[down], audit_of(*solid)};
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
        EXPECT_LT(std::abs(gap), cut == Cut::six_tetrahedra ? (across == 2 ? 0.005 : 0.003) : 0.02);
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

// Four across, cells 4:1: stiff.
TEST(Beams, of_stretched_cells_in_every_cut) {
  for (const Cut cut : {Cut::six_tetrahedra, Cut::five_tetrahedra, Cut::prisms_along_load, Cut::prisms_across,
                        Cut::prisms_along_beam})
    for (const double length : {20., 100.}) {
      const Answer stiff = bent({cut, int(length), 4, length});
      const double gap = stiff.tip / reference(length, 0.3) - 1;
      record(fmt::format("stretched_{}_{}", name(cut), int(length)), gap);
      EXPECT_LT(std::abs(gap), 0.18);  // five tetrahedra a cell at 100:1: 0.1759
      EXPECT_LT(gap, 0);
    }
}

// Cantilever of Slone et al. (2003): L = 20 m, square 2 m x 2 m, E = 10 MPa, nu = 0.3, clamped at x = 0,
// transverse traction of 125 Pa on the tip face. Static tip deflection of the clamped 3-D continuum: 0.10008
// m (p-refined finite elements; Euler-Bernoulli gives 0.1 m).

struct Tip {
  double deflection, imbalance;
};

Tip tip_of(const std::array<int, 3>& n) {
  SolidParameters p = box_parameters(3);
  p.material = {2600, 10e6, 0.3};
  p.boundaries["xmin"] = clamped(3);
  p.boundaries["xmax"] = boundary(Type::traction, {"0", "-125", "0"});
  const auto start = std::chrono::steady_clock::now();
  const auto solid =
      stepped(mesh::make_box(mesh::BoxCells::hexahedra, n, Vec3(0, -1, -1), Vec3(20, 1, 1)), p);
  const std::vector<double> points = solid->fields().point_displacement();
  const io::Probe probe(solid->body().mesh(), solid->body().geometry().points, "tip", Vec3(20, 0, 0));
  const double deflection = -probe.sample(points, 3)[1];
  Vec3 total = solid->fields().total_load();
  const double load = total.norm();
  EXPECT_NEAR(load, 500, 1e-9);
  for (const PatchForce& r : solid->fields().reactions(points)) total += r.force;
  fmt::print("{}x{}x{}: tip {:.5f} m ({:+.2f} %), {:.2f} s\n", n[0], n[1], n[2], deflection,
             100 * (deflection / 0.10008 - 1),
             std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  return {deflection, total.norm() / load};
}

TEST(Cantilever, tip_deflection_converges_to_the_clamped_continuum) {
  constexpr double reference = 0.10008;
  const Tip coarse = tip_of({20, 2, 2}), medium = tip_of({40, 4, 4}), fine = tip_of({80, 8, 8});
  RecordProperty("tip_coarse", fmt::format("{:.6f}", coarse.deflection));
  RecordProperty("tip_medium", fmt::format("{:.6f}", medium.deflection));
  RecordProperty("tip_fine", fmt::format("{:.6f}", fine.deflection));
  RecordProperty("imbalance",
                 fmt::format("{:.3e}", std::max({coarse.imbalance, medium.imbalance, fine.imbalance})));
  EXPECT_LT(std::abs(medium.deflection - reference), 0.5 * std::abs(coarse.deflection - reference));
  EXPECT_LT(std::abs(fine.deflection - reference), 0.5 * std::abs(medium.deflection - reference));
  EXPECT_NEAR(fine.deflection, reference, 0.015 * reference);
  // Reactions hold the load.
  for (const Tip& tip : {coarse, medium, fine}) EXPECT_LT(tip.imbalance, 1e-8);
}

// Slender bodies at large strain, which bend far under loads that are small beside their stiffness.

/// 1 m long, two quadrilaterals across, E = 1 GPa, nu = 0.
SolidParameters plane_bar() {
  SolidParameters p = box_parameters(2);
  p.kinematics = SolidParameters::Kinematics::finite_strain;
  p.material = {1000, 1e9, 0};
  p.material.law = "neo-hookean";
  p.boundaries["xmin"] = clamped(2);
  return p;
}

/// Largest displacement upwards of any point at 1 s.
double deflection(const SolidParameters& p, double height, int along, int steps = 1) {
  const auto solid = make_solid(
      mesh::make_box(mesh::BoxCells::quadrilaterals, {along, 2, 1}, Vec3::Zero(), Vec3(1, height, 0)), p);
  for (int i = 0; i < steps; ++i) step(*solid, 1. / steps);
  const std::vector<double> u = solid->fields().point_displacement();
  double most = 0;
  for (std::size_t v = 0; v < u.size() / 2; ++v) most = std::max(most, u[2 * v + 1]);
  return most;
}

// Conjugate gradients ended beyond where they had begun: no step however small was solved. q L^4 / (8 E I), an eighth less stiff.
TEST(Slender, a_pressure_that_follows_bends_a_bar_100_to_1) {
  SolidParameters p = plane_bar();
  p.boundaries["ymin"] = pressed("0.1*t");
  const double small = 0.1 / (8 * 1e9 * 1e-6 / 12);
  EXPECT_NEAR(deflection(p, 0.01, 60), small / 1.125, 0.02 * small);
}

// Forces have no more digits than the displacements that they follow from: equilibrium to 1e-10 of the load is beyond them.
TEST(Slender, equilibrium_is_as_near_as_the_numbers_are) {
  SolidParameters p = plane_bar();
  p.boundaries["xmax"] = boundary(Type::traction, {"0", "83.3*t"});
  EXPECT_NEAR(deflection(p, 0.002, 250, 15), 0.0833 / 1.125, 0.002);  // F L^3 / (3 E I), an eighth too stiff
}

/// What a static run says of a bar that is carried `far` metres and then sheared by `pull` at its end.
std::string said(double far, double pull) {
  SolidParameters p = plane_bar();
  p.boundaries["xmin"] = boundary(Type::fixed_displacement, {fmt::format("{}*min(2*t, 1)", far), "0"});
  p.boundaries["xmax"] = boundary(Type::traction, {"0", fmt::format("{}*max(2*t - 1, 0)", pull)});
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  deflection(p, 0.1, 20, 2);
  return ::testing::internal::GetCapturedStdout() + ::testing::internal::GetCapturedStderr();
}

// Equilibrium within rounding says nothing of a load that is smaller.
TEST(Slender, a_load_below_rounding_is_said_to_be_lost) {
  constexpr const char* lost = "is not resolved";
  EXPECT_NE(said(1000, 1e-6).find(lost), std::string::npos);
  EXPECT_EQ(said(0, 1e-2).find(lost), std::string::npos);
  EXPECT_EQ(said(1000, 1e3).find(lost), std::string::npos);
  EXPECT_EQ(said(1000, 0).find(lost), std::string::npos);  // no load
}

/// Name of the method of a beam 40:1 of n cubes along.
std::string method_of(int along) {
  SolidParameters p = box_parameters(3);
  p.kinematics = SolidParameters::Kinematics::finite_strain;
  p.boundaries["xmin"] = clamped(3);
  return make_solid(mesh::make_box(mesh::BoxCells::hexahedra, {along, 2, 2}, Vec3::Zero(), Vec3(40, 1, 1)), p)
      ->body()
      .large_strain()
      ->name();
}

// A thousand cells took over four times as long with factors as without.
TEST(Slender, factors_in_space_are_for_few_cells) {
  EXPECT_NE(method_of(40).find("factors"), std::string::npos);
  EXPECT_EQ(method_of(160).find("factors"), std::string::npos);
}

}  // namespace couplet::testing::beams_test
