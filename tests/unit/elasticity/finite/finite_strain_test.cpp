// SPDX-License-Identifier: Apache-2.0
// Laws of large strain: stress and tangent against differences of the energy, small strain, frame indifference.
#include <Eigen/Dense>

#include "common/elasticity/finite/finite_strain.hpp"
#include "solid_solver/laws/laws.hpp"
#include "tests/support/test.hpp"

namespace couplet::testing::finite_law_test {
using namespace elastic;

constexpr LameConstants lame{0.8e6, 1.3e6};
const std::vector<double> coefficients{0.3, 0.02};

Tensor3 random_tensor(std::mt19937& generator, double size) {
  std::uniform_real_distribution<double> any_value(-size, size);
  Tensor3 t;
  for (double& v : t.reshaped()) v = any_value(generator);
  return t;
}

FiniteLaw make(const laws::Entry& entry) {
  return entry.make(lame, std::span(coefficients).first(entry.n_coefficients));
}

finite::StrainState state_of(const FiniteLaw& law, const Tensor3& f, double* energy = nullptr) {
  finite::StrainState state;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) state.f[a][b] = Four{} + f(a, b);
  const Invariants at = finite::invariants(state.f);
  Energy e;
  law.evaluate({&at, 1}, true, {&e, 1});
  finite::keep(e, state);
  if (energy) *energy = e.w[2];
  return state;
}

Tensor3 first_of(const Four (&p)[3][3]) {
  Tensor3 t;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) t(a, b) = p[a][b][1];
  return t;
}

Tensor3 stress_of(const FiniteLaw& law, const Tensor3& f) {
  Four p[3][3];
  const finite::StrainState state = state_of(law, f);
  law.has_second_invariant ? finite::stress<true>(state, p) : finite::stress<false>(state, p);
  return first_of(p);
}

double energy_of(const FiniteLaw& law, const Tensor3& f) {
  double energy;
  state_of(law, f, &energy);
  return energy;
}

Tensor3 tangent_of(const FiniteLaw& law, const Tensor3& f, const Tensor3& change) {
  Four df[3][3], dp[3][3];
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) df[a][b] = Four{} + change(a, b);
  const finite::StrainState state = state_of(law, f);
  law.has_second_invariant ? finite::tangent<true>(state, df, Four{}, dp)
                           : finite::tangent<false>(state, df, Four{}, dp);
  return first_of(dp);
}

TEST(FiniteLaw, stress_is_the_derivative_of_the_energy) {
  std::mt19937 generator(1);
  for (const laws::Entry& entry : laws::all()) {
    SCOPED_TRACE(entry.name);
    const auto law = make(entry);
    for (int i = 0; i < 5; ++i) {
      const Tensor3 f = Tensor3::Identity() + random_tensor(generator, 0.4), d = random_tensor(generator, 1);
      if (f.determinant() < 0.2) continue;
      const double h = 1e-5;
      const double slope = (energy_of(law, f + h * d) - energy_of(law, f - h * d)) / (2 * h);
      EXPECT_NEAR(stress_of(law, f).cwiseProduct(d).sum(), slope, 1e-6 * lame.mu);
    }
  }
}

TEST(FiniteLaw, tangent_is_the_derivative_of_the_stress_and_symmetric) {
  std::mt19937 generator(2);
  for (const laws::Entry& entry : laws::all()) {
    SCOPED_TRACE(entry.name);
    const auto law = make(entry);
    for (int i = 0; i < 5; ++i) {
      const Tensor3 f = Tensor3::Identity() + random_tensor(generator, 0.4), d = random_tensor(generator, 1),
                    e = random_tensor(generator, 1);
      if (f.determinant() < 0.2) continue;
      const double h = 1e-5;
      const Tensor3 slope = (stress_of(law, f + h * d) - stress_of(law, f - h * d)) / (2 * h);
      const Tensor3 tangent = tangent_of(law, f, d);
      EXPECT_LT((tangent - slope).norm(), 1e-5 * lame.mu + 1e-6 * slope.norm());
      EXPECT_NEAR(tangent.cwiseProduct(e).sum(), tangent_of(law, f, e).cwiseProduct(d).sum(),
                  1e-9 * (lame.mu + tangent.norm()));
    }
  }
}

// Hooke's law with the constants that the law was made of; in thesis (2.32) as printed they are swapped.
TEST(FiniteLaw, is_hookes_law_at_small_strain) {
  std::mt19937 generator(3);
  const Tensor3 g = random_tensor(generator, 1), e = 0.5 * (g + g.transpose());
  const Tensor3 hooke = 2 * lame.mu * e + lame.lambda * e.trace() * Tensor3::Identity();
  for (const laws::Entry& entry : laws::all()) {
    SCOPED_TRACE(entry.name);
    const auto law = make(entry);
    EXPECT_LT((tangent_of(law, Tensor3::Identity(), g) - hooke).norm(), 1e-9 * hooke.norm());
    EXPECT_LT(stress_of(law, Tensor3::Identity()).norm(), 1e-9 * lame.mu);
    EXPECT_NEAR(energy_of(law, Tensor3::Identity()), 0, 1e-9 * lame.mu);
  }
}

TEST(FiniteLaw, turns_with_the_body) {
  std::mt19937 generator(4);
  const Tensor3 f = Tensor3::Identity() + random_tensor(generator, 0.2);
  const Tensor3 r = Eigen::AngleAxisd(2.1, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  for (const laws::Entry& entry : laws::all()) {
    SCOPED_TRACE(entry.name);
    const auto law = make(entry);
    const Tensor3 turned = r * stress_of(law, f);
    EXPECT_LT((stress_of(law, r * f) - turned).norm(), 1e-12 * (lame.mu + turned.norm()));
  }
}

// Uniaxial stretch at constant volume by hand: sigma_1 - sigma_2 = 2 (l^2 - 1/l) (c10 + c01 / l) of Mooney and
// Rivlin, 2 (l^2 - 1/l) (c1 + 2 c2 x + 3 c3 x^2) of Yeoh, x = l^2 + 2/l - 3.
TEST(FiniteLaw, mooney_rivlin_and_yeoh_in_uniaxial_stretch) {
  const double l = 1.7, x = l * l + 2 / l - 3, c = lame.mu / 2;
  const Tensor3 f = Vec3(l, 1 / std::sqrt(l), 1 / std::sqrt(l)).asDiagonal();
  const auto difference = [&](const char* name) {
    const Tensor3 sigma = stress_of(make(*laws::find(name)), f) * f.transpose();
    return sigma(0, 0) - sigma(1, 1);
  };
  const double both = 2 * (l * l - 1 / l);
  EXPECT_NEAR(difference("mooney-rivlin"), both * c * (0.7 + 0.3 / l), 1e-9 * lame.mu);
  EXPECT_NEAR(difference("yeoh"), both * c * (1 + 2 * 0.3 * x + 3 * 0.02 * x * x), 1e-9 * lame.mu);
}

TEST(FiniteLaw, bulk_part_has_its_own_derivatives) {
  for (const laws::Entry& entry : laws::all()) {
    const auto law = make(entry);
    if (!law.has_bulk) continue;
    SCOPED_TRACE(entry.name);
    const double j = 0.83, h = 1e-5;
    const auto slope = [&](auto part) { return (part(law.bulk(j + h)) - part(law.bulk(j - h))) / (2 * h); };
    EXPECT_NEAR(law.bulk(j).pressure, slope([](auto b) { return b.u; }), 1e-6 * lame.mu);
    EXPECT_NEAR(law.bulk(j).modulus, slope([](auto b) { return b.pressure; }), 1e-5 * lame.mu);
  }
}

}  // namespace couplet::testing::finite_law_test
