// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/output/spectrum.hpp"

#include <Eigen/Dense>
#include <algorithm>

#include "common/base/error.hpp"
#include "common/linalg/dense_eigenvalues.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::solid {
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
        "output.spectrum: the scene has {} displacement components; the spectrum is computed for at most "
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
