// SPDX-License-Identifier: Apache-2.0
// Thermal strain that must be exact: free and constrained bodies at a uniform temperature.
#include "common/io/checkpoint.hpp"
#include "solid_solver/thermal/thermal_load.hpp"
#include "tests/verification/heat/support.hpp"

namespace couplet::testing::strain_test {
using namespace mesh;
using namespace parallel;

constexpr double modulus = 200e9, nu = 0.3, alpha = 1.2e-5, rise = 100;

class Strain : public ::testing::TestWithParam<BoxCells> {};
INSTANTIATE_TEST_SUITE_P(Heat, Strain,
                         ::testing::Values(BoxCells::quadrilaterals, BoxCells::triangles, BoxCells::hexahedra,
                                           BoxCells::tetrahedra, BoxCells::prisms, BoxCells::mixed));

/// Largest deviation of the cells' stress from `wanted`, over E alpha times the rise.
double stress_error(const Solid& solid, const Tensor3& wanted) {
  double error = 0;
  for (const Tensor3& s : solid.fields().cell_stress(solid.fields().point_displacement()))
    error = std::max(error, (s - wanted).norm());
  return max(solid.body().mesh().comm, error) / (modulus * alpha * rise);
}

/// Largest deviation of the points' displacement from growth^T x, over the largest.
double growth_error(const Solid& solid, const Vec3& growth) {
  const std::vector<double> u = solid.fields().point_displacement();
  const int dim = solid.body().mesh().dim;
  double error = 0;
  for (std::size_t v = 0; v < solid.body().geometry().points.size(); ++v)
    for (int a = 0; a < dim; ++a)
      error = std::max(error, std::abs(u[v * dim + a] - growth[a] * solid.body().geometry().points[v][a]));
  return max(solid.body().mesh().comm, error) / (alpha * rise);
}

TEST_P(Strain, a_free_body_at_uniform_temperature_grows_without_stress) {
  const int dim = dimension_of(GetParam());
  SolidParameters p = warm_box(dim, "400");
  p.method.preconditioner = MethodParameters::Preconditioner::factors;  // to rounding
  if (dim == 2) p.plane = SolidParameters::Plane::stress;
  const auto solid = stepped(distorted_box(GetParam()), p);
  const double error = stress_error(*solid, Tensor3::Zero());
  ::testing::Test::RecordProperty("relative_error", fmt::format("{:.3e}", error));
  EXPECT_LT(error, 1e-10);
  EXPECT_LT(growth_error(*solid, Vec3::Constant(alpha * rise)), 1e-10);
}

// Growth along z and y is free, along x it is prevented: sigma_xx = - E alpha dT.
TEST_P(Strain, a_bar_held_at_both_ends_is_compressed) {
  const int dim = dimension_of(GetParam());
  SolidParameters p = warm_box(dim, "400");
  p.method.preconditioner = MethodParameters::Preconditioner::factors;  // to rounding
  if (dim == 2) p.plane = SolidParameters::Plane::stress;
  p.boundaries["xmax"] = boundary(Type::symmetry);
  const auto solid = stepped(distorted_box(GetParam()), p);
  Tensor3 wanted = Tensor3::Zero();
  wanted(0, 0) = -modulus * alpha * rise;
  const double error = stress_error(*solid, wanted);
  ::testing::Test::RecordProperty("relative_error", fmt::format("{:.3e}", error));
  EXPECT_LT(error, 1e-10);
  EXPECT_LT(growth_error(*solid, Vec3(0, 1, 1) * (1 + nu) * alpha * rise), 1e-10);
  const double area = dim == 3 ? 0.48 : 0.8;
  for (const PatchForce& r : solid->fields().reactions(solid->fields().point_displacement()))
    if (r.patch == "xmin") {
      EXPECT_NEAR(r.force[0] / (modulus * alpha * rise * area), 1, 1e-10);
    }
}

TEST_P(Strain, a_body_held_all_around_is_under_pressure) {
  const int dim = dimension_of(GetParam());
  SolidParameters p = warm_box(dim, "400");
  p.method.preconditioner = MethodParameters::Preconditioner::factors;  // to rounding
  for (auto& [name, b] : p.boundaries) b = clamped(dim);
  const auto solid = stepped(distorted_box(GetParam()), p);
  const double pressure = modulus * alpha * rise / (1 - 2 * nu);
  EXPECT_LT(stress_error(*solid, -pressure * Tensor3::Identity()), 1e-10);
}

TEST(PlaneStrain, a_free_plate_is_stressed_across_its_plane_only) {
  const auto solid = stepped(distorted_box(BoxCells::quadrilaterals), warm_box(2, "400"));
  Tensor3 wanted = Tensor3::Zero();
  wanted(2, 2) = -modulus * alpha * rise;
  EXPECT_LT(stress_error(*solid, wanted), 1e-10);
  EXPECT_LT(growth_error(*solid, Vec3::Constant((1 + nu) * alpha * rise)), 1e-10);
}

// alpha rises from 1e-5 at 300 K to 2e-5 at 400 K and stays: 1.5e-3 up to 400 K, 3.5e-3 up to 500 K.
TEST(VaryingExpansion, the_instantaneous_coefficient_is_integrated) {
  SolidParameters p = warm_box(3, "500");
  p.material.heat.expansion = config::ExpressionText{"table(T, 300, 1e-5, 400, 2e-5)"};
  const auto solid = stepped(distorted_box(BoxCells::hexahedra), p);
  const double error = growth_error(*solid, Vec3::Constant(3.5e-3));
  ::testing::Test::RecordProperty("relative_error", fmt::format("{:.3e}", error));
  EXPECT_LT(error, 1e-10);
}

// A pulled bar that gets warmer: E falls from 200 to 100 GPa, nu from 0.3 to 0.2 between 300 and 500 K.
TEST_P(Strain, elastic_constants_follow_the_temperature) {
  const int dim = dimension_of(GetParam());
  SolidParameters p = warm_box(dim, "300 + 100*t");
  if (dim == 2) p.plane = SolidParameters::Plane::stress;
  p.material.heat.youngs_modulus = config::ExpressionText{"table(T, 300, 200e9, 500, 100e9)"};
  p.material.heat.poissons_ratio = config::ExpressionText{"table(T, 300, 0.3, 500, 0.2)"};
  p.boundaries["xmax"] = pressed("-1e8");
  const auto solid = make_solid(distorted_box(GetParam()), p);
  Tensor3 wanted = Tensor3::Zero();
  wanted(0, 0) = 1e8;
  double error = 0;
  for (int i = 1; i <= 2; ++i) {
    step(*solid, 1);
    const double e = 200e9 - 50e9 * i, poisson = 0.3 - 0.05 * i, pull = 1e8 / e, growth = alpha * rise * i;
    const double aside = growth - poisson * pull;
    error = std::max(
        {error, growth_error(*solid, Vec3(pull + growth, aside, aside)), stress_error(*solid, wanted)});
  }
  ::testing::Test::RecordProperty("relative_error", fmt::format("{:.3e}", error));
  EXPECT_LT(error, 1e-9);
}

// Whether new constants are needed is asked of every cell: here only the one at the end of the bar gets warm, be it the
// mesh's first or last.
TEST(VaryingStiffness, follows_the_temperature_of_a_single_cell) {
  for (const bool last : {false, true}) {
    SolidParameters p = warm_box(2, last ? "300 + (x > 0.75 ? 100*t : 0)" : "300 + (x < 0.25 ? 100*t : 0)");
    p.plane = SolidParameters::Plane::stress;
    p.material.poissons_ratio = 0;
    p.material.heat.expansion = config::ExpressionText{"0"};
    p.material.heat.youngs_modulus = config::ExpressionText{"table(T, 300, 200e9, 400, 100e9)"};
    p.boundaries["xmax"] = pressed("-1e8");
    const auto solid =
        stepped(make_box(BoxCells::quadrilaterals, {4, 1, 1}, Vec3::Zero(), Vec3(1, 0.25, 0)), p);
    double end = 0;
    const std::vector<double> u = solid->fields().point_displacement();
    for (std::size_t v = 0; v < solid->body().geometry().points.size(); ++v) end = std::max(end, u[2 * v]);
    // 1e8 Pa over a length of 1 m at 200 GPa, a quarter of it at half of that; the face between the two has a mean.
    EXPECT_NEAR(max(solid->body().mesh().comm, end), 1.25 * 1e8 / 200e9, 0.03 * 1e8 / 200e9) << last;
  }
}

TEST(PrescribedTemperature, is_taken_at_the_end_of_a_static_step) {
  SolidParameters p = warm_box(3, "300 + 50*t");
  const auto solid = stepped(distorted_box(BoxCells::hexahedra), p);
  EXPECT_LT(growth_error(*solid, Vec3::Constant(alpha * 50)), 1e-10);
  step(*solid, 1);
  EXPECT_LT(growth_error(*solid, Vec3::Constant(alpha * 100)), 1e-10);
  EXPECT_LT(stress_error(*solid, Tensor3::Zero()), 1e-10);
}

// Two materials, no strain across: M e - B alpha dT is one stress, the lengths of both add up to nothing.
TEST_P(Strain, two_materials_held_all_around_push_with_one_traction) {
  const int dim = dimension_of(GetParam());
  RawMesh raw = make_box(GetParam(), {6, 3, 3}, Vec3::Zero(), Vec3(1, 0.5, dim == 3 ? 0.5 : 0));
  raw.zones = {"brass", "steel"};
  for (Index c = 0; c < raw.cell_points.size(); ++c) {
    double x = 0;
    for (const Index v : raw.cell_points[c]) x += raw.points[v][0] / double(raw.cell_points[c].size());
    raw.cell_zone[c] = x < 0.5 ? 0 : 1;
  }
  SolidParameters p = warm_box(dim, "300 + 100*t");
  for (auto& [name, b] : p.boundaries) b = boundary(Type::symmetry);
  const std::array<std::string, 2> expansion{"1.9e-5", "table(T, 300, 1e-5, 400, 1.4e-5)"};
  const std::array<double, 2> e{100e9, 200e9}, poisson{0.35, 0.3}, strain{1.9e-3, 1.2e-3};
  double lengths = 0, compliance = 0;
  for (int i = 0; i < 2; ++i) {
    ZoneMaterial& m = p.materials[raw.zones[i]];
    m.density = 8000;
    m.youngs_modulus = e[i];
    m.poissons_ratio = poisson[i];
    m.heat.expansion = config::ExpressionText{expansion[i]};
    const elastic::LameConstants lame = lame_constants(p, m);
    lengths += 0.5 * (3 * lame.lambda + 2 * lame.mu) * strain[i] / (lame.lambda + 2 * lame.mu);
    compliance += 0.5 / (lame.lambda + 2 * lame.mu);
  }
  raw.materials = zones_of(p.materials);
  const auto solid = stepped(raw, p);
  const double wanted = -lengths / compliance;
  double error = 0;
  for (const Tensor3& s : solid->fields().cell_stress(solid->fields().point_displacement()))
    error = std::max(error, std::abs(s(0, 0) / wanted - 1));
  error = max(MPI_COMM_WORLD, error);
  ::testing::Test::RecordProperty("relative_error", fmt::format("{:.3e}", error));
  EXPECT_LT(error, 1e-10);
}

/// Heat that is solved for, in a solid that deforms.
SolidParameters heated_box() {
  SolidParameters p = warm_box(3, "0");
  p.temperature.reset();
  p.heat.emplace();
  p.heat->initial_temperature = {"300"};
  p.heat->boundaries["xmax"].type = HeatBoundary::Type::flux;
  p.heat->boundaries["xmax"].value = {"1e6*y"};
  p.material.heat.conductivity = config::ExpressionText{"table(T, 300, 50, 500, 30)"};
  p.material.heat.specific_heat = config::ExpressionText{"480"};
  return p;
}

TEST(SolvedTemperature, spreads_and_then_strains_the_body_without_stress) {
  SolidParameters p = heated_box();
  p.heat->scheme = HeatParameters::Scheme::euler;  // takes all of its heat from the flux at the end of a step
  p.heat->boundaries["xmax"].value = {"t < 1000 ? 1e5 : 0"};
  const auto solid = make_solid(distorted_box(BoxCells::hexahedra), p);
  for (int i = 0; i < 4; ++i) step(*solid, 250);
  for (int i = 0; i < 30; ++i) step(*solid, 5000);
  const double warmer = 3 * 250 * 1e5 / (7800 * 480 * 1.0);  // the heat of three steps, over 1 m
  const Vec3 growth = Vec3::Constant(alpha * warmer);
  EXPECT_LT(growth_error(*solid, growth), 1e-6);
  EXPECT_LT(stress_error(*solid, Tensor3::Zero()), 1e-6);
}

// dT/dt = - 3 K alpha / (rho c) T tr(d eps/dt) in an isolated body: a stretched one cools.
TEST(ThermoelasticCoupling, a_stretched_body_cools_and_a_compressed_one_warms) {
  double largest = 0;
  for (const double strain : {1e-3, -1e-3}) {
    SolidParameters p = heated_box();
    p.thermoelastic_coupling = true;
    p.heat->scheme = HeatParameters::Scheme::euler;
    p.heat->boundaries.clear();
    const std::string u = fmt::format("{}*x*table(t, 0, 0, 1, 1)", strain);
    for (auto& [name, b] : p.boundaries) b = boundary(Type::fixed_displacement, {u, "0", "0"});
    const auto solid = make_solid(distorted_box(BoxCells::mixed), p);
    for (int i = 0; i < 22; ++i) step(*solid, 0.05);
    auto& effect = *solid->body().thermal();
    // (3 K alpha)^2 T / ((lambda + 2 mu) rho c), thesis (2.27); here 3 K alpha = E alpha / (1 - 2 nu).
    const double stress_per_kelvin = modulus * alpha / (1 - 2 * nu),
                 stiffness = modulus * (1 - nu) / ((1 + nu) * (1 - 2 * nu));
    EXPECT_NEAR(effect.coupling_number(),
                stress_per_kelvin * stress_per_kelvin * 300 / (stiffness * 7800 * 480), 1e-4);
    const double rate = modulus / (1 - 2 * nu) * alpha / (7800 * 480);
    const double exact = 300 * (std::exp(-rate * strain) - 1);
    const std::vector<double>& t = effect.temperature().heat()->accepted().cells;
    double error = 0;
    for (Index c = 0; c < solid->body().mesh().cells.n_owned(); ++c)
      error = std::max(error, std::abs((t[c] - 300) / exact - 1));
    largest = std::max(largest, max(MPI_COMM_WORLD, error));
  }
  ::testing::Test::RecordProperty("relative_error", fmt::format("{:.3e}", largest));
  EXPECT_LT(largest, 1e-3);
}

// In plane stress, held along x and y, tr(sigma) = E/(1 - nu) (eps_x - 2 alpha dT) and (2.27) is
// rho c dT = - alpha T d(tr(sigma) + 9 K alpha dT). Expands so much that the answer to its own warming counts.
TEST(ThermoelasticCoupling, of_a_sheet_in_plane_stress_counts_its_own_expansion) {
  constexpr double large = 6e-5, strain = 1e-4, capacity = 7800 * 480;
  SolidParameters p = warm_box(2, "0");
  p.plane = SolidParameters::Plane::stress;
  p.temperature.reset();
  p.material.heat.expansion = config::ExpressionText{"6e-5"};
  p.material.heat.conductivity = config::ExpressionText{"50"};
  p.material.heat.specific_heat = config::ExpressionText{"480"};
  p.heat.emplace();
  p.heat->initial_temperature = {"300"};
  p.heat->scheme = HeatParameters::Scheme::euler;
  p.thermoelastic_coupling = true;
  const std::string u = fmt::format("{}*x*table(t, 0, 0, 1, 1)", strain);
  for (auto& [name, b] : p.boundaries) b = boundary(Type::fixed_displacement, {u, "0"});
  const auto solid = make_solid(distorted_box(BoxCells::quadrilaterals), p);
  for (int i = 0; i < 40; ++i) step(*solid, 0.1);
  const double sheet = modulus / (1 - nu), bulk = modulus / (1 - 2 * nu);  // 3 K
  const double exact =
      -large * 300 * sheet * strain / (capacity + large * large * 300 * (3 * bulk - 2 * sheet));
  auto& effect = *solid->body().thermal();
  const std::vector<double>& t = effect.temperature().heat()->accepted().cells;
  for (Index c = 0; c < solid->body().mesh().cells.n_owned(); ++c)
    ASSERT_NEAR((t[c] - 300) / exact, 1, 2e-3) << c;
}

class Scratch {
 public:
  Scratch()
      : path_(std::filesystem::temp_directory_path() /
              fmt::format("couplet-heat-restart-{}.h5", comm_size(MPI_COMM_WORLD))) {}
  ~Scratch() {
    MPI_Barrier(MPI_COMM_WORLD);
    if (comm_rank(MPI_COMM_WORLD) == 0) std::filesystem::remove(path_);
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

TEST(SolvedTemperature, goes_on_bit_for_bit_after_a_restart) {
  for (const auto scheme : {HeatParameters::Scheme::euler, HeatParameters::Scheme::three_point,
                            HeatParameters::Scheme::trapezoidal}) {
    SolidParameters p = heated_box();
    p.heat->scheme = scheme;
    p.material.heat.youngs_modulus = config::ExpressionText{"table(T, 300, 200e9, 500, 100e9)"};
    const LoadedMesh body = distribute(MPI_COMM_WORLD, distorted_box(BoxCells::mixed));
    const auto first = std::make_unique<Solid>(body, p, SolidContext{});
    step(*first, 20);
    step(*first, 30);
    const Scratch file;
    {
      io::CheckpointWriter writer(MPI_COMM_WORLD, file.path());
      first->save(writer);
      writer.close();
    }
    const auto second = std::make_unique<Solid>(body, p, SolidContext{});
    io::CheckpointReader reader(MPI_COMM_WORLD, file.path());
    second->load(reader);
    for (Solid* solid : {first.get(), second.get()}) step(*solid, 10), step(*solid, 10);
    EXPECT_EQ(first->stepper().state().cell_u, second->stepper().state().cell_u);
    const auto u = first->fields().point_displacement();
    const auto s = first->fields().cell_stress(u), t = second->fields().cell_stress(u);
    for (std::size_t c = 0; c < s.size(); ++c) EXPECT_EQ(s[c], t[c]);
  }
}

}  // namespace couplet::testing::strain_test
