// SPDX-License-Identifier: Apache-2.0

#include "solid_solver/analysis/modal_analysis.hpp"

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "common/base/error.hpp"
#include "common/elasticity/symmetric/symmetric_matrix.hpp"
#include "common/linalg/dense_eigenvalues.hpp"
#include "common/log/log.hpp"
#include "common/mesh/mesh.hpp"
#include "common/modes/pencil.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/body/method_choice.hpp"
#include "solid_solver/body/recovered_strain.hpp"

namespace couplet::solid {
namespace {

// Shift relative to mu/(rho L^2): below the first bending mode of a body 100 times longer than thick, above
// round-off in rigid motions.
constexpr double shift_part = 1e-4;
// A squared frequency below this part of mu/(rho L^2) is a rigid motion.
constexpr double rigid_part = 1e-8;

/// mu/(rho L^2) of the slowest cell, with L the diagonal of the body's bounding box [1/s^2].
double slowest_scale(const SolidProblem& problem, std::span<const double> cell_mass) {
  const mesh::Geometry& geometry = problem.geometry();
  const mesh::Mesh& mesh = problem.mesh;
  double slowest = 1e300;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c)
    slowest = std::min(slowest, problem.elastic.lame(c).mu * geometry.volume[c] / cell_mass[c]);
  const double length = mesh::extent_of(mesh, geometry).diagonal();
  return parallel::min(mesh.comm, slowest) / (length * length);
}

/// Surface vertex sent to rank 0; its shapes are sent separately.
struct SurfacePoint {
  GlobalIndex id;
  double x[3];
};

/// Sum over this rank's rows of M x for a unit translation along each axis.
std::vector<double> participation(const SolidProblem& problem, const modes::EigenModes& modes) {
  const std::size_t dim = problem.mesh.dim, n = problem.elastic.n_unknowns(), count = modes.shape.size();
  std::vector<double> along(n), inertia(n), sums(3 * count, 0);
  for (std::size_t a = 0; a < dim; ++a) {
    for (std::size_t i = 0; i < n; ++i) along[i] = i % dim == a ? 1 : 0;
    problem.kernel.apply_with_mass(along, {}, 1, false, inertia);
    for (std::size_t m = 0; m < count; ++m) {
      double local = 0;
      for (std::size_t i = 0; i < n; ++i) local += inertia[i] * modes.shape[m][i];
      sums[a * count + m] = parallel::sum(problem.mesh.comm, local);
    }
  }
  return sums;
}

// Largest number of rows factorized by default: factors fill in 3-D (33 000 tetrahedra have 2e5 rows).
constexpr GlobalIndex most_rows_2d = 2000000, most_rows_3d = 400000;
// Share of the relative difference of face strains and recovered ones by which the strain energy errs at most. Measured on the ten
// lowest modes of a free prism with 2 to 8 cells across: 0.1 to 0.45.
constexpr double first_order_part = 0.5;
// Relative residual left by factors of the exact matrix.
constexpr double exact = 1e-6;

/// Throws SolveFailure if the factors do not match this operator (effects missing in the narrow matrix).
void check_factors(const SolidProblem& problem, elastic::TiedMatrix& factors, double shift) {
  const std::size_t n = problem.elastic.n_unknowns();
  std::vector<double> x(n), force(n), back(n);
  for (std::size_t i = 0; i < n; ++i) x[i] = std::sin(1.0 + double(i % 1000));
  problem.kernel.apply_with_mass(x, {}, shift, true, force);
  factors.apply(x, back);
  for (std::size_t i = 0; i < n; ++i) back[i] -= force[i];
  if (!(norm(problem.mesh.comm, back) <= exact * norm(problem.mesh.comm, force)))
    throw SolveFailure("The factors do not match the stiffness.");
}

/// True if the search uses factors. Collective.
bool goes_by_factors(const SolidProblem& problem, const MethodParameters& method) {
  using Preconditioner = MethodParameters::Preconditioner;
  if (!elastic::TiedMatrix::suits(problem.mesh) || !problem.is_symmetric()) return false;
  if (method.preconditioner != Preconditioner::automatic)
    return method.preconditioner == Preconditioner::factors;
  const mesh::Mesh& mesh = problem.mesh;
  const auto blocks = GlobalIndex(problem.elastic.n_unknowns()) / mesh.dim + 2 * mesh.points.n_owned();
  return parallel::sum(mesh.comm, blocks) * mesh.dim <= (mesh.dim == 2 ? most_rows_2d : most_rows_3d);
}

/// The lowest `n` modes, with an approximate inverse of K + shift M.
modes::EigenModes search(const SolidProblem& problem, int n, double shift, linalg::LinearMap solve) {
  const elastic::ElasticKernel& kernel = problem.kernel;
  const modes::Pencil of{.comm = problem.mesh.comm,
                         .n = problem.elastic.n_unknowns(),
                         .k = [&](std::span<const double> x, std::span<double> y) { kernel.apply(x, {}, y); },
                         .m = [&](std::span<const double> x,
                                  std::span<double> y) { kernel.apply_with_mass(x, {}, 1, false, y); },
                         .solve = std::move(solve)};
  return modes::lowest_modes(of, n, -shift);
}

/// Finds the modes with the factors of the shifted stiffness.
modes::EigenModes search_by_factors(const SolidProblem& problem, std::span<const double> cell_mass, int n,
                                    double shift) {
  std::vector<double> density;
  for (Index c = 0; c < problem.mesh.cells.n_owned(); ++c)
    density.push_back(cell_mass[std::size_t(c)] / problem.geometry().volume[std::size_t(c)]);
  elastic::TiedMatrix shifted(problem.mesh, problem.elastic, {.mass = shift, .density = density});
  check_factors(problem, shifted, shift);
  shifted.factorise();
  return search(problem, n, shift,
                [&](std::span<const double> x, std::span<double> y) { shifted.solve(x, y); });
}

/// Finds the modes with the preconditioner of the method.
modes::EigenModes search_by_iteration(const SolidProblem& problem, const MethodParameters& method,
                                      std::span<const double> cell_mass, int n, double shift) {
  std::vector<double> inertia;
  for (const double m : cell_mass) inertia.push_back(shift * m);
  const auto shifted =
      make_solution_method({problem.mesh, problem.elastic, inertia, problem.kernel, shift}, method);
  return search(problem, n, shift, [&](std::span<const double> x, std::span<double> y) {
    std::ranges::fill(y, 0);
    if (norm(problem.mesh.comm, x) > 0) shifted->solve(x, y);
  });
}

}  // namespace

std::optional<SolidProblem> vibration(const SolidBody& body) {
  if (!body.has_mass()) return {};
  return SolidProblem{body.mesh(), body.elastic(), {}, body.kernel(), 0};
}

modes::EigenModes solid_modes(const SolidProblem& problem, MethodParameters method,
                              std::span<const double> cell_mass, int n) {
  const double scale = slowest_scale(problem, cell_mass);
  const bool chooses = method.preconditioner == MethodParameters::Preconditioner::automatic;
  method.corrections_kept = 0;  // one right-hand side says nothing about the next
  method.relative_tolerance = std::min(method.relative_tolerance, 1e-10);
  const bool by_factors = goes_by_factors(problem, method);
  modes::EigenModes modes;
  try {
    modes = by_factors ? search_by_factors(problem, cell_mass, n, shift_part * scale)
                       : search_by_iteration(problem, method, cell_mass, n, shift_part * scale);
  } catch (const SolveFailure& e) {
    if (!chooses || !by_factors) throw;
    log::info("modes: the search with factors of the matrix failed: {}", e.what());
    method.preconditioner = MethodParameters::Preconditioner::multigrid;
    modes = search_by_iteration(problem, method, cell_mass, n, shift_part * scale);
  }
  for (double& value : modes.eigenvalue)
    if (value < rigid_part * scale) value = 0;
  return modes;
}

std::vector<double> mode_errors(const SolidBody& body, const modes::EigenModes& modes) {
  const mesh::Mesh& mesh = body.mesh();
  std::vector<double> errors;
  for (std::size_t m = 0; m < modes.shape.size(); ++m) {
    if (!(modes.eigenvalue[m] > 0)) continue;  // a rigid-body mode
    const std::vector<double>& shape = modes.shape[m];
    const MissedStrain of_mesh =
        missed_strain(body, shape, {}, [](const Tensor3& h) { return Tensor3(0.5 * (h + h.transpose())); });
    // In a loaded body the stress stiffness contributes to the eigenvalue.
    const elastic::ElasticField u{shape, {}};
    const double share =
        parallel::sum(mesh.comm, body.kernel().product(elastic::ElasticPart::stiffness, u, u)) /
        modes.eigenvalue[m];
    const double missed =
        std::max({of_mesh.recovered, of_mesh.variation, first_order_part * std::sqrt(of_mesh.recovered)});
    errors.push_back(0.5 * share * missed);
  }
  return errors;
}

modes::ModalModel modal_model(const SolidProblem& problem, const modes::EigenModes& modes) {
  const mesh::Geometry& geometry = problem.geometry();
  const mesh::Mesh& mesh = problem.mesh;
  const std::size_t dim = mesh.dim, count = modes.shape.size();
  std::vector<Index> points;
  std::vector<bool> is_taken(mesh.points.n_local(), false);
  std::vector<GlobalIndex> faces;  // boundary_id, corners, their ids
  for (const mesh::Patch& patch : mesh.patches)
    for (Index f = patch.first; f < patch.first + patch.count && !patch.bonded; ++f) {
      faces.push_back(mesh.boundary_id[f - mesh.n_interior]);
      faces.push_back(GlobalIndex(mesh.face_points[f].size()));
      for (const Index v : mesh.face_points[f]) {
        faces.push_back(mesh.point_id[v]);
        if (!is_taken[v]) points.push_back(v);
        is_taken[v] = true;
      }
    }
  std::vector<SurfacePoint> places;
  for (const Index v : points) {
    const Vec3& x = geometry.points[v];
    places.push_back({mesh.point_id[v], {x[0], x[1], x[2]}});
  }
  std::vector<double> shapes(points.size() * 3 * count, 0),
      at_points(std::size_t(mesh.points.n_local()) * dim);
  for (std::size_t m = 0; m < count; ++m) {
    problem.kernel.point_values(modes.shape[m], {}, at_points);
    mesh.points.update_ghosts(at_points, mesh.dim);
    for (std::size_t i = 0; i < points.size(); ++i)
      for (std::size_t a = 0; a < dim; ++a)
        shapes[(3 * i + a) * count + m] = at_points[std::size_t(points[i]) * dim + a];
  }
  modes::ModalModel model;
  model.participation = participation(problem, modes);
  const std::vector<SurfacePoint> all = parallel::gather(mesh.comm, places);
  const std::vector<double> all_shapes = parallel::gather(mesh.comm, shapes);
  const std::vector<GlobalIndex> all_faces = parallel::gather(mesh.comm, faces);
  if (parallel::comm_rank(mesh.comm) != 0) return {};
  for (const double value : modes.eigenvalue)
    model.frequency.push_back(std::sqrt(std::max(0.0, value)) / (2 * std::numbers::pi));
  // A vertex shared by ranks appears more than once, with equal values.
  std::map<GlobalIndex, std::size_t> source;
  for (std::size_t i = 0; i < all.size(); ++i) source.try_emplace(all[i].id, i);
  std::map<GlobalIndex, Index> number;
  for (const auto& [id, i] : source) {
    number[id] = static_cast<Index>(model.vertices.size());
    model.vertices.push_back({all[i].x[0], all[i].x[1], all[i].x[2]});
    const auto first = all_shapes.begin() + std::ptrdiff_t(i * 3 * count);
    model.vertex_shape.insert(model.vertex_shape.end(), first, first + std::ptrdiff_t(3 * count));
  }
  std::map<GlobalIndex, std::vector<Index>> corners;
  for (std::size_t i = 0; i < all_faces.size();) {
    std::vector<Index>& face = corners[all_faces[i]];
    const auto n = static_cast<std::size_t>(all_faces[i + 1]);
    for (std::size_t k = 0; k < n; ++k) face.push_back(number.at(all_faces[i + 2 + k]));
    i += 2 + n;
  }
  for (const auto& [id, face] : corners) model.faces.push_row(face);
  if (dim == 3) modes::average_faces(model);
  return model;
}

namespace {

/// Applies A to unit vectors; rows rank by rank. On rank 0.
Eigen::MatrixXd probe(MPI_Comm comm, std::size_t n_local, GlobalIndex n, const ElasticApplication& apply) {
  const GlobalIndex first = parallel::exclusive_scan(comm, GlobalIndex(n_local));
  const bool root = parallel::comm_rank(comm) == 0;
  Eigen::MatrixXd a(root ? n : 0, root ? n : 0);
  std::vector<double> x(n_local, 0), y(n_local);
  for (GlobalIndex j = 0; j < n; ++j) {
    const bool mine = j >= first && j < first + GlobalIndex(n_local);
    if (mine) x[std::size_t(j - first)] = 1;
    apply(x, y);
    if (mine) x[std::size_t(j - first)] = 0;
    const std::vector<double> column = parallel::gather(comm, y);
    if (root) a.col(j) = Eigen::Map<const Eigen::VectorXd>(column.data(), n);
  }
  return a;
}

std::vector<double> columns(const Eigen::MatrixXd& a) { return {a.data(), a.data() + a.size()}; }

void check_size(GlobalIndex n) {
  if (n > largest_spectrum)
    throw Error(
        "output.spectrum: the mesh has {} displacement components; the spectrum is computed for at most "
        "{}. Use a coarser mesh of the same kind.",
        n, largest_spectrum);
}

}  // namespace

std::vector<std::complex<double>> symmetric_spectrum(const mesh::Mesh& mesh, std::size_t n_unknowns,
                                                     const ElasticApplication& stiffness,
                                                     const ElasticApplication& mass) {
  const GlobalIndex n = parallel::sum(mesh.comm, GlobalIndex(n_unknowns));
  check_size(n);
  const Eigen::MatrixXd a = probe(mesh.comm, n_unknowns, n, stiffness);
  const Eigen::MatrixXd b = probe(mesh.comm, n_unknowns, n, mass);
  if (parallel::comm_rank(mesh.comm) != 0) return {};
  std::vector<Eigen::Index> massive, massless;
  for (Eigen::Index i = 0; i < n; ++i)
    (b(i, i) > 1e-12 * b.trace() / double(n) ? massive : massless).push_back(i);
  Eigen::MatrixXd k = a(massive, massive), m = b(massive, massive);
  if (!massless.empty()) k -= a(massive, massless) * a(massless, massless).ldlt().solve(a(massless, massive));
  k = (0.5 * (k + k.transpose())).eval();
  m = (0.5 * (m + m.transpose())).eval();
  // An oblique support leaves a massless direction on the diagonal blocks.
  m.diagonal().array() += 1e-13 * m.trace() / double(m.rows());
  const std::vector<double> values = linalg::symmetric_eigenvalues(columns(k), columns(m), int(k.rows()));
  return {values.begin(), values.end()};
}

std::vector<std::complex<double>> spectrum(const mesh::Mesh& mesh, std::span<const double> cell_mass,
                                           std::size_t n_unknowns, const ElasticApplication& apply) {
  const std::size_t n_cells = cell_mass.size() * mesh.dim;
  const GlobalIndex n = parallel::sum(mesh.comm, GlobalIndex(n_unknowns)),
                    n_massive = parallel::sum(mesh.comm, GlobalIndex(n_cells));
  check_size(n_massive);
  // Mass of each row, 0 for faces, in the order of the gathered rows.
  std::vector<double> local_mass(n_unknowns, 0);
  for (std::size_t i = 0; i < n_cells; ++i) local_mass[i] = cell_mass[i / mesh.dim];
  const std::vector<double> mass = parallel::gather(mesh.comm, local_mass);
  const Eigen::MatrixXd a = probe(mesh.comm, n_unknowns, n, apply);
  if (parallel::comm_rank(mesh.comm) != 0) return {};
  std::vector<Eigen::Index> massive, massless;
  for (Eigen::Index i = 0; i < n; ++i) (mass[i] > 0 ? massive : massless).push_back(i);
  Eigen::MatrixXd k = a(massive, massive);
  if (!massless.empty())
    k -= a(massive, massless) * a(massless, massless).partialPivLu().solve(a(massless, massive));
  for (Eigen::Index i = 0; i < k.rows(); ++i) k.row(i) /= mass[massive[i]];
  std::vector<std::complex<double>> result = linalg::general_eigenvalues(columns(k), int(k.rows()));
  std::ranges::sort(result, {}, [](const std::complex<double>& z) { return std::pair(z.real(), z.imag()); });
  return result;
}

std::vector<std::complex<double>> eigenvalues(const SolidBody& body) {
  const mesh::Geometry& geometry = body.geometry();
  const mesh::Mesh& mesh = body.mesh();
  const elastic::ElasticKernel& kernel = body.kernel();
  if (body.has_mass())
    return symmetric_spectrum(
        mesh, body.elastic().n_unknowns(),
        [&](std::span<const double> x, std::span<double> y) { kernel.apply(x, {}, y); },
        [&](std::span<const double> x, std::span<double> y) { kernel.apply_with_mass(x, {}, 1, false, y); });
  std::vector<double> mass;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) mass.push_back(body.density(c) * geometry.volume[c]);
  const std::vector<double> still(body.prescribed().size() * mesh.dim, 0);
  return spectrum(mesh, mass, body.elastic().n_unknowns(),
                  [&](std::span<const double> x, std::span<double> y) { kernel.apply(x, still, y); });
}

}  // namespace couplet::solid
