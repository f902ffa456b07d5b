// SPDX-License-Identifier: Apache-2.0
// Prestress of a loaded body, its buckling and its free vibrations.
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/base/error.hpp"
#include "common/elasticity/symmetric/symmetric_matrix.hpp"
#include "common/mesh/mesh.hpp"
#include "common/modes/pencil.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/analysis/modal_analysis.hpp"

namespace couplet::solid {

namespace {

// Distance between the places where a load is compared, relative to the size of the body.
constexpr double load_step = 1e-6;
// Largest skew part of the gradient of a body force with a potential, relative to the gradient.
constexpr double skew_part = 1e-3;

/// Derivatives of the values along each axis by central differences; values(shift) are those at moved places.
template <class Values>
std::vector<std::vector<double>> slopes(const SolidBody& body, const Values& values) {
  const double h = load_step * mesh::extent_of(body.mesh(), body.geometry()).diagonal();
  std::vector<std::vector<double>> result;
  for (int a = 0; a < body.mesh().dim; ++a) {
    const std::vector<double> before = values(-h * Vec3::Unit(a));
    std::vector<double>& slope = result.emplace_back(values(h * Vec3::Unit(a)));
    for (std::size_t i = 0; i < slope.size(); ++i) slope[i] = (slope[i] - before[i]) / (2 * h);
  }
  return result;
}

/// Adds -db/dx of the body forces if it is symmetric.
void add_body_forces(const SolidBody& body, double time, std::vector<elastic::PlaceBlock>& to) {
  const mesh::Mesh& mesh = body.mesh();
  const auto slope = slopes(body, [&](const Vec3& shift) { return body.body_forces(time, shift); });
  std::vector<elastic::PlaceBlock> blocks;
  double skew = 0, whole = 0;
  for (Index c = 0; c < mesh.cells.n_owned() && !slope[0].empty(); ++c) {
    Tensor3 gradient = Tensor3::Zero();
    for (int a = 0; a < mesh.dim; ++a)
      for (int b = 0; b < mesh.dim; ++b)
        gradient(a, b) = slope[std::size_t(b)][std::size_t(c * mesh.dim + a)];
    if (gradient.isZero(0)) continue;
    skew += (0.5 * (gradient - gradient.transpose())).squaredNorm();
    whole += gradient.squaredNorm();
    blocks.push_back({c, c, -0.5 * (gradient + gradient.transpose())});
  }
  if (parallel::sum(mesh.comm, skew) <= skew_part * skew_part * parallel::sum(mesh.comm, whole))
    to.insert(to.end(), blocks.begin(), blocks.end());
}

/// Adds the symmetric part of a dp/dx, see pressure_stiffness().
void add_pressure_slopes(const SolidBody& body, double time, std::vector<elastic::PlaceBlock>& to) {
  const mesh::Mesh& mesh = body.mesh();
  const auto slope =
      slopes(body, [&](const Vec3& shift) { return body.boundaries().pressures(time, shift); });
  for (Index b = 0; b < mesh.boundary.n_owned(); ++b) {
    Vec3 gradient = Vec3::Zero();
    for (int a = 0; a < mesh.dim; ++a) gradient[a] = slope[std::size_t(a)][std::size_t(b)];
    if (gradient.isZero(0)) continue;
    const Tensor3 block = body.geometry().face_area[mesh.n_interior + b] * gradient.transpose();
    const Index node = mesh.cells.n_local() + b;
    to.push_back({node, node, 0.5 * (block + block.transpose())});
  }
}

/// Adds the stiffness of the even pressure in a partner's forces f, `dim` values per boundary face of owned cells,
/// p = -sum f.S / sum S.S over the loaded faces. Pressures of single faces would miss what maps carry around corners.
void add_partner(const SolidBody& body, std::span<const double> force, std::vector<elastic::PlaceBlock>& to) {
  const mesh::Mesh& mesh = body.mesh();
  const auto dim = Eigen::Index(mesh.dim);
  std::vector<double> pressure(force.size() / std::size_t(dim));
  std::array<double, 2> sums{};
  for (std::size_t i = 0; i < pressure.size(); ++i) {
    const Eigen::Map<const Eigen::VectorXd> f(force.data() + i * std::size_t(dim), dim);
    const Vec3& area = body.geometry().face_area[mesh.n_interior + Index(i)];
    pressure[i] = f.isZero(0) ? 0 : 1;
    sums[0] -= f.dot(area.head(dim));
    sums[1] += pressure[i] * area.squaredNorm();
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), int(sums.size()), MPI_DOUBLE, MPI_SUM, mesh.comm);
  if (sums[1] > 0)
    for (double& p : pressure) p *= sums[0] / sums[1];
  const auto blocks = elastic::pressure_stiffness(mesh, body.geometry(), pressure);
  to.insert(to.end(), blocks.begin(), blocks.end());
}

}  // namespace

elastic::Prestress prestress_of(const SolidBody& body, const SolidFields& fields, double time,
                                std::span<const double> interface) {
  const mesh::Mesh& mesh = body.mesh();
  elastic::Prestress prestress{
      fields.face_stress(0, mesh.n_flux_faces(), fields.point_displacement()),
      elastic::pressure_stiffness(mesh, body.geometry(), body.boundaries().pressures(time))};
  add_partner(body, interface, prestress.loads);
  add_body_forces(body, time, prestress.loads);
  add_pressure_slopes(body, time, prestress.loads);
  return prestress;
}

double compression(const mesh::Mesh& mesh, const elastic::Prestress& prestress) {
  double least = 0;
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    Tensor3 s = prestress.stress[std::size_t(f)];
    if (mesh.dim == 2) s.row(2).setZero(), s.col(2).setZero();
    Eigen::SelfAdjointEigenSolver<Tensor3> solver;
    solver.computeDirect(s, Eigen::EigenvaluesOnly);
    least = std::min(least, solver.eigenvalues()[0]);
  }
  return -parallel::min(mesh.comm, least);
}

namespace {

// Additional ratios computed, for a gap in which the pivots are counted.
constexpr int extra = 3;
// A ratio 1/lambda below this part of the largest one is round-off of a load without buckling.
constexpr double ratio_rounding = 1e-9;
// Shift relative to the scale of the lowest squared frequency, see modal_analysis.
constexpr double loaded_shift_part = 1e-4;

void check_buckling_of(const SolidBody& body) {
  if (!body.kernel().is_symmetric())
    throw SolveFailure("It requires 'solution-method: {face-gradient: symmetric}'.");
  if (!elastic::TiedMatrix::suits(body.mesh())) throw SolveFailure("It does not support periodic patches.");
  if (!body.rigid().empty()) throw SolveFailure("It does not support patches that move as rigid bodies.");
}

void make_largest_one(MPI_Comm comm, std::vector<double>& shape) {
  double largest = 0;
  for (const double v : shape) largest = std::max(largest, std::abs(v));
  largest = parallel::max(comm, largest);
  if (largest > 0)
    for (double& v : shape) v /= largest;
}

/// True if exactly `n` factors are below `s`.
bool counts(const SolidBody& body, const elastic::Prestress& prestress, double s, std::size_t n) {
  elastic::TiedMatrix loaded(body.mesh(), body.elastic(), {.stress = s, .prestress = &prestress});
  loaded.factorise();
  return loaded.negative() == GlobalIndex(n);
}

double largest_stress(const SolidBody& body, const elastic::Prestress& prestress) {
  double largest = 0;
  for (const Tensor3& s : prestress.stress) largest = std::max(largest, s.norm());
  return parallel::max(body.mesh().comm, largest);
}

/// Factor at which the stress equals Young's modulus; buckling beyond is ignored.
double overload(const SolidBody& body, const elastic::Prestress& prestress) {
  double stiffest = 0;
  for (Index c = 0; c < body.mesh().cells.n_owned(); ++c)
    stiffest = std::max(stiffest, body.elastic().lame(c).mu);
  return 2.5 * parallel::max(body.mesh().comm, stiffest) / largest_stress(body, prestress);
}

}  // namespace

Buckling find_buckling(const SolidBody& body, const elastic::Prestress& prestress, int n) {
  check_buckling_of(body);
  if (!(largest_stress(body, prestress) > 0))
    throw SolveFailure("The loads cause no stress in the body; add a load or a moving support.");
  const mesh::Mesh& mesh = body.mesh();
  elastic::StressStiffness stress(mesh, body.elastic(), prestress);
  elastic::TiedMatrix stiffness(mesh, body.elastic(), {});
  stiffness.factorise();
  const modes::Pencil of{
      .comm = mesh.comm,
      .n = body.elastic().n_unknowns(),
      .k =
          [&](std::span<const double> x, std::span<double> y) {
            stress.apply(x, y);
            for (double& v : y) v = -v;
          },
      .m = [&](std::span<const double> x, std::span<double> y) { body.kernel().apply(x, {}, y); },
      .solve = [&](std::span<const double> x, std::span<double> y) { stiffness.solve(x, y); }};
  for (int more = extra; more <= 8 * extra; more *= 2) {
    modes::EigenModes found = modes::largest_modes(of, n + more);
    Buckling result;
    if (found.eigenvalue.empty()) {
      if (counts(body, prestress, overload(body, prestress), 0)) return result;
      continue;
    }
    const double least = ratio_rounding * std::abs(found.eigenvalue.front());
    for (std::size_t i = 0; i < found.eigenvalue.size() && found.eigenvalue[i] > least; ++i) {
      result.factor.push_back(1 / found.eigenvalue[i]);
      result.shape.push_back(std::move(found.shape[i]));
      make_largest_one(mesh.comm, result.shape.back());
    }
    if (result.factor.size() < 2) return result;
    // Uses the widest gap beyond the wanted ones.
    std::size_t end = std::min(std::size_t(n), result.factor.size() - 1);
    double widest = 0;
    for (std::size_t i = end; i < result.factor.size(); ++i)
      if (result.factor[i] / result.factor[i - 1] > widest)
        widest = result.factor[i] / result.factor[i - 1], end = i;
    if (!counts(body, prestress, 0.5 * (result.factor[end - 1] + result.factor[end]), end)) continue;
    const std::size_t kept = std::min(std::size_t(n), result.factor.size());
    result.factor.resize(kept);
    result.shape.resize(kept);
    return result;
  }
  throw SolveFailure("Cannot verify the {} lowest load factors; request fewer.", n);
}

modes::EigenModes preloaded_modes(const SolidBody& body, const elastic::Prestress& prestress, int n) {
  const mesh::Geometry& geometry = body.geometry();
  check_buckling_of(body);
  const mesh::Mesh& mesh = body.mesh();
  const elastic::ElasticKernel& kernel = body.kernel();
  std::vector<double> density;
  double slowest = 1e300;
  for (Index c = 0; c < mesh.cells.n_local(); ++c) density.push_back(body.density(c));
  for (Index c = 0; c < mesh.cells.n_owned(); ++c)
    slowest = std::min(slowest, body.elastic().lame(c).mu / density[std::size_t(c)]);
  kernel.set_density(density);
  const double length = mesh::extent_of(mesh, geometry).diagonal();
  const double shift = loaded_shift_part * parallel::min(mesh.comm, slowest) / (length * length);
  elastic::TiedMatrix loaded(mesh, body.elastic(), {.stress = 1, .prestress = &prestress});
  loaded.factorise();
  if (loaded.negative() > 0)
    throw SolveFailure("The loaded equilibrium is unstable: {} modes have negative stiffness.",
                       loaded.negative());
  elastic::TiedMatrix shifted(mesh, body.elastic(),
                              {.mass = shift, .density = density, .stress = 1, .prestress = &prestress});
  shifted.factorise();
  elastic::StressStiffness stress(mesh, body.elastic(), prestress);
  std::vector<double> of_stress(body.elastic().n_unknowns());
  const modes::Pencil of{
      .comm = mesh.comm,
      .n = body.elastic().n_unknowns(),
      .k =
          [&](std::span<const double> x, std::span<double> y) {
            kernel.apply(x, {}, y);
            stress.apply(x, of_stress);
            for (std::size_t i = 0; i < y.size(); ++i) y[i] += of_stress[i];
          },
      .m = [&](std::span<const double> x,
               std::span<double> y) { kernel.apply_with_mass(x, {}, 1, false, y); },
      .solve = [&](std::span<const double> x, std::span<double> y) { shifted.solve(x, y); }};
  return modes::lowest_modes(of, n, -shift);
}

}  // namespace couplet::solid
