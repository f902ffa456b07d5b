// SPDX-License-Identifier: Apache-2.0
// The operator is not symmetric: M^-1 K has complex pairs of eigenvalues, which let a scheme without
// dissipation grow. The rate is predicted by the spectrum, seen in the run, and removed by dissipative
// schemes.
#include "common/mesh/topology.hpp"
#include "common/time/time_scheme.hpp"
#include "solid_solver/analysis/modal_analysis.hpp"
#include "tests/verification/solid/support.hpp"

namespace couplet::testing::spectrum_test {
using namespace mesh;
using namespace time;

/// The beam of case C (Slone et al. 2003) as a plane model.
SolidParameters beam(FaceGradient gradient) {
  SolidParameters p = box_parameters(2);
  p.method.face_gradient = gradient;
  p.analysis = SolidParameters::Analysis::dynamic;
  p.plane = SolidParameters::Plane::stress;
  p.material = {2600, 10e6, 0.3};
  p.boundaries["xmin"] = clamped(2);
  p.boundaries["xmax"] = boundary(Type::traction, {"0", "t <= 7 ? -125*t/7 : 0"});
  return p;
}

RawMesh beam_mesh(double perturbation) {
  RawMesh raw = make_box(BoxCells::quadrilaterals, {40, 8, 1}, Vec3::Zero(), Vec3(20, 2, 0));
  if (perturbation > 0) perturb_interior(raw, perturbation, 7);
  return raw;
}

/// Those of the beam, each made once.
const std::vector<std::complex<double>>& beam_eigenvalues(FaceGradient gradient, double perturbation) {
  static std::map<std::pair<FaceGradient, double>, std::vector<std::complex<double>>> known;
  auto [place, is_new] = known.try_emplace({gradient, perturbation});
  if (is_new) place->second = eigenvalues(make_solid(beam_mesh(perturbation), beam(gradient))->body());
  return place->second;
}

double largest_rate(const std::vector<std::complex<double>>& eigenvalues, const TimeSchemeParameters& scheme,
                    double dt, const RayleighCoefficients& damping = {}) {
  double rate = -1;
  for (const auto& value : eigenvalues) rate = std::max(rate, growth_rate(scheme, dt, value, damping));
  return rate;
}

/// Stiffness-proportional damping [s] at which the trapezoidal rule stops to grow, by bisection, a little
/// more.
double least_damping(const std::vector<std::complex<double>>& eigenvalues, double dt) {
  double none = 0, enough = 1e-6;
  const auto grows = [&](double beta) {
    return largest_rate(eigenvalues, {TimeScheme::trapezoidal}, dt, {0, beta}) > 1e-5;
  };
  while (grows(enough)) none = std::exchange(enough, 2 * enough);
  while (enough - none > 0.05 * enough) {
    const double middle = 0.5 * (none + enough);
    (grows(middle) ? none : enough) = middle;
  }
  return enough;
}

double energy(const Solid& solid) {
  double kinetic = 0;
  for (Index c = 0; c < solid.body().mesh().cells.n_owned(); ++c)
    for (int a = 0; a < 2; ++a)
      kinetic += 0.5 * solid.body().parameters().material.density * solid.body().geometry().volume[c] *
                 std::pow(solid.stepper().state().cell_v[std::size_t(c) * 2 + a], 2);
  return kinetic + energies(solid).strain;
}

/// Energy left of that after the release at 7 s, at the end of 100 s. Kinetic plus strain energy.
double energy_kept(const SolidParameters& p, const RawMesh& raw, double dt, double end) {
  const auto solid = make_solid(raw, p);
  double released = 0;
  const int steps = int(std::lround(end / dt));
  for (int i = 1; i <= steps; ++i) {
    step(*solid, dt);
    if (i == int(std::lround(7.5 / dt))) released = energy(*solid);
  }
  return energy(*solid) / released;
}

TEST(Spectrum, has_the_frequencies_of_a_bar) {
  // No lateral contraction: omega_n = (n - 1/2) pi c / L along the bar.
  SolidParameters p = box_parameters(2);
  p.analysis = SolidParameters::Analysis::dynamic;
  p.material = {1000, 1e6, 0};
  p.boundaries["xmin"] = clamped(2);
  p.method.face_gradient = FaceGradient::thesis;
  for (const char* side : {"ymin", "ymax"}) p.boundaries[side] = boundary(Type::symmetry);
  const auto solid =
      make_solid(make_box(BoxCells::quadrilaterals, {40, 1, 1}, Vec3::Zero(), Vec3(1, 0.02, 0)), p);
  const auto values = eigenvalues(solid->body());
  ASSERT_EQ(values.size(), 80u);
  const double expected = std::pow(0.5 * M_PI * std::sqrt(1e6 / 1000), 2);
  EXPECT_NEAR(values.front().real() / expected, 1, 1e-3);
}

class Growth : public ::testing::TestWithParam<FaceGradient> {};
INSTANTIATE_TEST_SUITE_P(Gradients, Growth, ::testing::Values(FaceGradient::thesis),
                         [](const auto&) { return "thesis"; });

/// These cells of a mesh, with patches "held" (x = 0) and "free".
RawMesh part_of(const RawMesh& raw, const std::vector<char>& wanted) {
  RawMesh part = raw;
  part.cell_points = {};
  part.cell_type.clear();
  part.cell_zone.clear();
  for (Index c = 0; c < raw.cell_points.size(); ++c) {
    if (!wanted[c]) continue;
    const auto points = raw.cell_points[c];
    part.cell_type.push_back(raw.cell_type[c]);
    part.cell_zone.push_back(raw.cell_zone[c]);
    part.cell_points.index.insert(part.cell_points.index.end(), points.begin(), points.end());
    part.cell_points.offset.push_back(Index(part.cell_points.index.size()));
  }
  part.boundary_points = outer_faces(part);
  part.boundary_patch.clear();
  part.patches = {"held", "free"};
  for (Index b = 0; b < part.boundary_points.size(); ++b) {
    const auto points = part.boundary_points[b];
    const bool held = std::ranges::all_of(points, [&](Index p) { return raw.points[p][0] == 0; });
    part.boundary_patch.push_back(held ? 0 : 1);
  }
  return part;
}

/// What is left of a box of tetrahedra inside a wavy surface: a strut with ears of one and two cells.
RawMesh strut_with_ears() {
  RawMesh raw = make_box(BoxCells::tetrahedra, {7, 4, 4}, Vec3::Zero(), Vec3(7, 4, 4));
  perturb_interior(raw, 0.3, 11);
  std::vector<char> inside(raw.cell_points.size());
  for (Index c = 0; c < raw.cell_points.size(); ++c) {
    Vec3 x = Vec3::Zero();
    for (const Index p : raw.cell_points[c]) x += raw.points[p] / 4;
    const double y = x[1] - 2 - 0.4 * std::sin(2 * x[0]), z = x[2] - 2 - 0.4 * std::cos(3 * x[0]);
    inside[c] = x[0] < 1 || std::hypot(y, z) < 1.2;
  }
  const RawMesh body = part_of(raw, inside);
  std::map<std::set<Index>, Index> cell_of_face;  // the first of its two cells
  std::vector<std::pair<Index, Index>> pairs;
  for (Index c = 0; c < body.cell_points.size(); ++c)
    for (const Index left_out : body.cell_points[c]) {
      std::set<Index> face(body.cell_points[c].begin(), body.cell_points[c].end());
      face.erase(left_out);
      if (const auto [other, is_first] = cell_of_face.emplace(face, c); !is_first)
        pairs.emplace_back(other->second, c);
    }
  std::vector<char> reached(body.cell_points.size(), 0);
  reached[0] = 1;
  for (bool grows = true; grows;) {
    grows = false;
    for (const auto& [first, second] : pairs) {
      char &a = reached[first], &b = reached[second];
      if (a != b) a = b = 1, grows = true;
    }
  }
  return part_of(body, reached);
}

// Extrapolation from few nodes to the vertices of ears would make eigenvalues negative: nothing converges
// then.
TEST_P(Growth, has_no_negative_eigenvalues_on_a_body_full_of_ears) {
  SolidParameters p = box_parameters(3);
  p.boundaries.clear();
  p.method.face_gradient = GetParam();
  p.analysis = SolidParameters::Analysis::dynamic;
  p.material = {1, 1, 0.3};
  p.boundaries["held"] = clamped(3);
  p.boundaries["free"] = boundary(Type::free);
  const auto solid = make_solid(strut_with_ears(), p);
  EXPECT_GT(solid->body().mesh().wide_points.size(), 20u);
  double least = std::numeric_limits<double>::max();
  for (const auto& value : eigenvalues(solid->body())) least = std::min(least, value.real());
  RecordProperty("least_eigenvalue", fmt::format("{:.3e}", least));
  EXPECT_GT(least, 0);
}

TEST_P(Growth, has_no_negative_eigenvalues_on_beams_of_stretched_cells) {
  SolidParameters p = box_parameters(3);
  p.method.face_gradient = GetParam();
  p.analysis = SolidParameters::Analysis::dynamic;
  p.material = {1, 1, 0.3};
  p.boundaries["xmin"] = clamped(3);
  for (const auto cells : {BoxCells::tetrahedra, BoxCells::prisms, BoxCells::mixed, BoxCells::hexahedra})
    for (const double stretch : {1.0, 2.5, 4.0, 6.0}) {
      const auto solid = make_solid(make_box(cells, {6, 2, 2}, Vec3::Zero(), Vec3(6 * stretch, 2, 2)), p);
      double least = std::numeric_limits<double>::max();
      for (const auto& value : eigenvalues(solid->body())) least = std::min(least, value.real());
      EXPECT_GT(least, 0) << int(cells) << " stretched " << stretch;
    }
}

TEST_P(Growth, of_the_trapezoidal_rule_is_predicted) {
  constexpr double dt = 0.01;
  SolidParameters p = beam(GetParam());
  // A seed of all modes in place of the force.
  p.boundaries["xmax"] = boundary(Type::free);
  p.initial_velocity = {{"1e-6*sin(37*x)*cos(53*y)"}, {"1e-6*cos(41*x)*sin(29*y)"}};
  for (const double perturbation : {0.0, 0.2}) {
    const auto& values = beam_eigenvalues(GetParam(), perturbation);
    const auto n_complex = std::ranges::count_if(values, [](const auto& z) { return z.imag() != 0; });
    const double predicted = largest_rate(values, {TimeScheme::trapezoidal}, dt);
    ASSERT_GT(n_complex, 0);
    ASSERT_GT(predicted, 0.05);
    // Energy grows at twice the rate once the fastest mode has outgrown the rest.
    const auto solid = make_solid(beam_mesh(perturbation), p);
    const int from = int(12 / predicted / dt), until = int(16 / predicted / dt);
    double start = 0;
    for (int i = 1; i <= until; ++i) {
      step(*solid, dt);
      if (i == from) start = energy(*solid);
    }
    const double measured = std::log(energy(*solid) / start) / (2 * (until - from) * dt);
    fmt::print(
        "perturbation {}: {} of {} eigenvalues complex, growth rate predicted {:.4f}, measured {:.4f} 1/s\n",
        perturbation, n_complex, values.size(), predicted, measured);
    RecordProperty(perturbation > 0 ? "predicted_perturbed" : "predicted", fmt::format("{:.4f}", predicted));
    RecordProperty(perturbation > 0 ? "measured_perturbed" : "measured", fmt::format("{:.4f}", measured));
    EXPECT_NEAR(measured / predicted, 1, 0.1);
  }
}

/// The same for a quarter of the time, in which the rule without dissipation grows sixfold (rates above 0.05 1/s).
TEST_P(Growth, does_not_begin_with_dissipative_schemes) {
  constexpr double dt = 0.01;
  SolidParameters p = beam(GetParam());
  const auto& values = beam_eigenvalues(GetParam(), 0.2);
  ASSERT_GT(largest_rate(values, {TimeScheme::trapezoidal}, dt), 0.05);
  for (const TimeSchemeParameters& scheme :
       {TimeSchemeParameters{TimeScheme::bathe}, TimeSchemeParameters{TimeScheme::generalised_alpha, 0.5}}) {
    EXPECT_LT(largest_rate(values, scheme, dt), 1e-5);
    p.time_scheme = scheme;
    EXPECT_NEAR(energy_kept(p, beam_mesh(0.2), dt, 25), 1, 0.01);
  }
}

TEST_P(Growth, is_removed_by_dissipative_schemes_and_by_a_little_damping) {
  constexpr double dt = 0.01;
  const SolidParameters p = beam(GetParam());
  for (const double perturbation : {0.0, 0.2}) {
    const RawMesh raw = beam_mesh(perturbation);
    const auto& values = beam_eigenvalues(GetParam(), perturbation);
    const auto check = [&](const char* what, const TimeSchemeParameters& scheme, double beta) {
      EXPECT_LT(largest_rate(values, scheme, dt, {0, beta}), 1e-5) << what;
      SolidParameters q = p;
      q.time_scheme = scheme;
      if (beta > 0) q.damping = SolidDamping{0, beta};
      const double kept = energy_kept(q, raw, dt, 100);
      fmt::print("perturbation {}, {} (beta {:.2e} s): {:.5f} of the energy after 100 s\n", perturbation,
                 what, beta, kept);
      RecordProperty(fmt::format("kept_{}{}", what, perturbation > 0 ? "_perturbed" : ""),
                     fmt::format("{:.5f}", kept));
      EXPECT_NEAR(kept, 1, 0.01) << what;
    };
    const double beta = least_damping(values, dt);
    RecordProperty(perturbation > 0 ? "beta_perturbed" : "beta", fmt::format("{:.2e}", beta));
    EXPECT_LT(beta, 5e-4);
    check("damped", {TimeScheme::trapezoidal}, beta);
    check("bathe", {TimeScheme::bathe}, 0);
    check("generalised-alpha", {TimeScheme::generalised_alpha, 0.5}, 0);
  }
}

// Without the massless row: K = [4 0; 0 6] - [1 2]^T [3 1] / 2 = [2.5 -0.5; -3 5], whose eigenvalues are 2 and 5.5; the mass is 2 kg.
TEST(Spectrum, is_that_of_the_cells_once_massless_rows_are_eliminated) {
  const auto [mesh, geometry] =
      distribute(MPI_COMM_SELF, make_box(BoxCells::quadrilaterals, {1, 1, 1}, Vec3::Zero(), Vec3::Ones()));
  Eigen::Matrix3d a;
  a << 4, 0, 1, 0, 6, 2, 3, 1, 2;
  const std::vector<double> mass{2};
  const auto found = spectrum(mesh, mass, 3, [&](std::span<const double> x, std::span<double> y) {
    Eigen::Map<Vec3>(y.data()) = a * Eigen::Map<const Vec3>(x.data());
  });
  ASSERT_EQ(found.size(), 2u);
  EXPECT_LT(std::abs(found[0] - 1.), 1e-12);
  EXPECT_LT(std::abs(found[1] - 2.75), 1e-12);
}

}  // namespace couplet::testing::spectrum_test
