// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/symmetric/symmetric_kernel.hpp"

#include "common/base/processor_clones.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::elastic {
namespace {

// Tensor indices of xx, yy, zz, xy, yz, xz, and in 2-D of xx, yy, xy.
constexpr int entry[2][6] = {{0, 1, 3, 0, 0, 0}, {0, 1, 2, 3, 4, 5}};

}  // namespace

SymmetricKernel::SymmetricKernel(const mesh::Mesh& mesh, const ElasticOperator& rows)
    : mesh_(mesh), rows_(rows), space_(mesh, rows) {
  if (is_axisymmetric(rows)) {
    for (Index f = 0; f < mesh.n_flux_faces(); ++f)
      if (mesh.owner[f] < mesh.cells.n_owned()) make_ring(f);
    return;
  }
  const SharedFaces shared = shared_faces(mesh, rows);
  const auto all = [](Index) { return true; };
  plain_ = {make_group(mesh, rows, shared, nullptr, all), {}, {}};
  add_laws(plain_);
  if (parallel::any(mesh.comm, shared.n_mine > 0)) {
    edges_ = std::make_unique<SharedEdges>(mesh, rows, shared);
    sharing_ = {make_group(mesh, rows, shared, edges_.get(), all), {}, {}};
    add_laws(sharing_);
    kept_.resize(sharing_.blocks.size());
    share_ = shared.share;
    shared_index_.assign(mesh.n_flux_faces(), -1);
    for (std::size_t i = 0; i < shared.faces.size(); ++i) shared_index_[shared.faces[i]] = Index(i);
  }
  if (!rows.volume_by_cells()) {
    plain_.volumes = {};  // needed only for volume strains of cells
    return;
  }
  pressure_.assign(space_.n_nodes(), 0);
  const std::vector<double> volume = pyramid_volumes(mesh, rows.geometry());
  for (Index c = 0; c < mesh.cells.n_owned(); ++c)
    bulk_.push_back(bulk_of_cells(rows.lame(c), rows.volume_strain()) / volume[c]);
}

void SymmetricKernel::add_laws(LawGroup& group) const {
  rows_.is_anisotropic() ? group.matrix.resize(group.blocks.size()) : group.hooke.resize(group.blocks.size());
  const int n = mesh_.dim == 3 ? 6 : 3;
  for (std::size_t i = 0; i < group.blocks.size() * 4; ++i) {
    const Index f = group.faces[std::min(i, group.faces.size() - 1)];
    const double volume = group.volumes[i / 4].whole[i % 4];
    if (!rows_.is_anisotropic()) {
      const LameConstants lame = part_of_faces(face_lame(mesh_, rows_, f), rows_.volume_strain());
      group.hooke[i / 4].mu[i % 4] = volume * lame.mu;
      group.hooke[i / 4].lambda[i % 4] = volume * lame.lambda;
      continue;
    }
    const ElasticMatrix c = face_matrix(mesh_, rows_, f);
    for (int a = 0, at = 0; a < n; ++a)
      for (int b = a; b < n; ++b)
        group.matrix[i / 4].c[at++][i % 4] = volume * c(entry[mesh_.dim - 2][a], entry[mesh_.dim - 2][b]);
  }
}

void SymmetricKernel::make_ring(Index f) {
  const FaceRows face = ring_rows(mesh_, rows_, f);
  const LameConstants lame = face_lame(mesh_, rows_, f);
  RingFace& to = rings_.emplace_back();
  to.mu = face.volume * lame.mu;
  to.lambda = face.volume * lame.lambda;
  to.shear = face.has_shear ? to.mu : 0;
  for (std::size_t i = 0; i < 4; ++i) {
    to.place[i] = face.row[i].place;
    std::copy_n(face.row[i].b.data(), 3, to.b[i]);
  }
}

/// V sigma of block i of the group without the pressure of cells.
template <int D>
inline void SymmetricKernel::stress_of(const LawGroup& group, std::size_t i, const Four (&g)[D][D],
                                       Four (&stress)[D][D]) const {
  if (group.matrix.empty()) {
    const Four mu = blocks::wide(group.hooke[i].mu);
    Four trace = g[0][0];
    for (int a = 1; a < D; ++a) trace += g[a][a];
    trace *= blocks::wide(group.hooke[i].lambda);
    for (int a = 0; a < D; ++a) {
      for (int b = a; b < D; ++b) {
        stress[a][b] = mu * (g[a][b] + g[b][a]);
        stress[b][a] = stress[a][b];
      }
      stress[a][a] += trace;
    }
    return;
  }
  constexpr int n = D == 3 ? 6 : 3;
  Four strain[n], s[n] = {};
  for (int k = 0; k < n; ++k) {
    const int a = first_index[entry[D - 2][k]], b = second_index[entry[D - 2][k]];
    strain[k] = k < D ? g[a][b] : g[a][b] + g[b][a];
  }
  for (int a = 0, at = 0; a < n; ++a)
    for (int b = a; b < n; ++b, ++at) {
      const Four c = blocks::wide(group.matrix[i].c[at]);
      s[a] += c * strain[b];
      if (b != a) s[b] += c * strain[a];
    }
  for (int k = 0; k < n; ++k) {
    const int a = first_index[entry[D - 2][k]], b = second_index[entry[D - 2][k]];
    stress[a][b] = stress[b][a] = s[k];
  }
}

/// Adds V_fP p_P + V_fQ p_Q to V sigma, where p is the mean stress of the cells.
template <int D>
inline void SymmetricKernel::add_pressure_of_cells(const LawGroup& group, std::size_t i,
                                                   Four (&stress)[D][D]) const {
  if (pressure_.empty()) return;
  const Four pressure = blocks::wide(group.volumes[i].whole) *
                        blocks::between(group.blocks[i], group.volumes[i], pressure_.data());
  for (int a = 0; a < D; ++a) stress[a][a] += pressure;
}

// Adds the forces of V sigma of four faces to their nodes and points.
template <int D>
inline void SymmetricKernel::faces_loop() {
  const double* values = space_.values();
  double* forces = space_.forces();
  for (std::size_t i = 0; i < plain_.blocks.size(); ++i) {
    Four g[D][D], stress[D][D];
    blocks::gradient<D>(plain_.blocks[i], values, g);
    stress_of<D>(plain_, i, g, stress);
    add_pressure_of_cells<D>(plain_, i, stress);
    blocks::push<D>(plain_.blocks[i], stress, forces);
  }
}

/// Adds V_fP tr e_f to the cells.
template <int D>
inline void SymmetricKernel::volumes_loop() {
  for (const LawGroup* group : {&plain_, &sharing_})
    for (std::size_t i = 0; i < group->blocks.size(); ++i) {
      Four g[D][D];
      blocks::gradient<D>(group->blocks[i], space_.values(), g);
      Four trace = g[0][0];
      for (int a = 1; a < D; ++a) trace += g[a][a];
      blocks::add_to_cells(group->blocks[i], group->volumes[i], trace, pressure_.data());
    }
}

// Stores the faces' own part and adds t V / 3 e to the edges.
inline void SymmetricKernel::shared_first_loop() {
  const double* values = space_.values();
  for (std::size_t i = 0; i < sharing_.blocks.size(); ++i) {
    Four g[3][3], stress[3][3];
    blocks::gradient<3>(sharing_.blocks[i], values, g);
    stress_of<3>(sharing_, i, g, stress);
    const Four own = blocks::wide(sharing_.volumes[i].own),
               scale = 0.5 * blocks::part_of_edges(sharing_.volumes[i]);
    Four strain[6];
    for (int k = 0; k < 6; ++k) {
      lanes::store<3>(kept_[i].stress[k], own * stress[first_index[k]][second_index[k]]);
      strain[k] = scale * (g[first_index[k]][second_index[k]] + g[second_index[k]][first_index[k]]);
    }
    const Four xyz[3] = {strain[0], strain[1], strain[2]}, rest[3] = {strain[3], strain[4], strain[5]};
    Four low[4], high[4];
    blocks::transpose(xyz, low);
    blocks::transpose(rest, high);
    for (int k = 0; k < 4; ++k)
      for (const Index e : sharing_.edges[i][std::size_t(k)]) {
        double* at = edges_->at(e);
        for (int c = 0; c < 3; ++c) at[c] += low[k][c], at[3 + c] += high[k][c];
      }
  }
}

// Adds the forces including the stress of the edges.
inline void SymmetricKernel::shared_second_loop() {
  double* forces = space_.forces();
  for (std::size_t i = 0; i < sharing_.blocks.size(); ++i) {
    Four stress[3][3];
    const Four weight = blocks::part_of_edges(sharing_.volumes[i]);
    for (int k = 0; k < 6; ++k) {
      Four of_edges{};
      for (int j = 0; j < 4; ++j) {
        const auto& edges = sharing_.edges[i][std::size_t(j)];
        of_edges[j] = edges_->at(edges[0])[k] + edges_->at(edges[1])[k] + edges_->at(edges[2])[k];
      }
      stress[first_index[k]][second_index[k]] = blocks::wide(kept_[i].stress[k]) + weight * of_edges;
      stress[second_index[k]][first_index[k]] = stress[first_index[k]][second_index[k]];
    }
    add_pressure_of_cells<3>(sharing_, i, stress);
    blocks::push<3>(sharing_.blocks[i], stress, forces);
  }
}

namespace {

// Loops compiled for several generations of processors, selected at program start.
COUPLET_PROCESSOR_CLONES void plane_faces_pass(SymmetricKernel& kernel) { kernel.faces_loop<2>(); }
COUPLET_PROCESSOR_CLONES void space_faces_pass(SymmetricKernel& kernel) { kernel.faces_loop<3>(); }
COUPLET_PROCESSOR_CLONES void shared_first_pass(SymmetricKernel& kernel) { kernel.shared_first_loop(); }
COUPLET_PROCESSOR_CLONES void shared_second_pass(SymmetricKernel& kernel) { kernel.shared_second_loop(); }
COUPLET_PROCESSOR_CLONES void volumes_pass(SymmetricKernel& kernel, int dim) {
  dim == 2 ? kernel.volumes_loop<2>() : kernel.volumes_loop<3>();
}

}  // namespace

/// Sums V theta of the owned cells, stored in place of their pressures.
std::span<double> SymmetricKernel::sum_volumes() {
  std::ranges::fill(pressure_, 0.0);
  volumes_pass(*this, mesh_.dim);
  const std::span<double> cells = std::span(pressure_).first(std::size_t(mesh_.cells.n_local()));
  mesh_.cells.add_to_owners(cells);
  return cells;
}

void SymmetricKernel::find_pressures() {
  const std::span<double> cells = sum_volumes();
  for (std::size_t c = 0; c < bulk_.size(); ++c) cells[c] *= bulk_[c];
  mesh_.cells.update_ghosts(cells);
}

void SymmetricKernel::find_edge_means() {
  edges_->clear();
  shared_first_pass(*this);
  edges_->finish_means();
}

void SymmetricKernel::add_internal_forces() {
  if (!pressure_.empty()) find_pressures();
  rings_.empty() ? forces_of_stress() : forces_of_rings();
}

void SymmetricKernel::add_internal_forces(std::span<const double> pressure, std::span<double> defect) {
  const std::span<double> cells = sum_volumes();
  for (std::size_t c = 0; c < bulk_.size(); ++c) {
    defect[c] = cells[c] - pressure[c] / bulk_[c];
    cells[c] = pressure[c];
  }
  mesh_.cells.update_ghosts(cells);
  forces_of_stress();
}

void SymmetricKernel::forces_of_stress() {
  mesh_.dim == 2 ? plane_faces_pass(*this) : space_faces_pass(*this);
  if (!edges_) return;
  find_edge_means();
  edges_->to_stress();
  shared_second_pass(*this);
}

void SymmetricKernel::forces_of_rings() {
  for (const RingFace& f : rings_) {
    double radial = 0, axial = 0, hoop = 0, slide = 0;  // strains, the last one an angle
    for (std::size_t i = 0; i < 4; ++i) {
      const Vec3 u = space_.value(f.place[i]);
      radial += f.b[i][0] * u[0];
      axial += f.b[i][1] * u[1];
      hoop += f.b[i][2] * u[0];
      slide += f.b[i][1] * u[0] + f.b[i][0] * u[1];
    }
    const double mean = f.lambda * (radial + axial + hoop);
    const double stress[4] = {mean + 2 * f.mu * radial, mean + 2 * f.mu * axial, mean + 2 * f.mu * hoop,
                              f.shear * slide};
    for (std::size_t i = 0; i < 4; ++i) {
      auto to = space_.force(f.place[i]);
      to[0] += stress[0] * f.b[i][0] + stress[3] * f.b[i][1] + stress[2] * f.b[i][2];
      to[1] += stress[1] * f.b[i][1] + stress[3] * f.b[i][0];
    }
  }
}

void SymmetricKernel::face_gradients(const ElasticKernel::TakeGradient& take, Index first_face, Index end) {
  if (edges_) find_edge_means();
  if (!pressure_.empty()) find_pressures();
  for (Index f = first_face; f < end; ++f) {
    const FaceRows face = face_rows(mesh_, rows_, f);
    Tensor3 gradient = Tensor3::Zero();
    for (std::size_t i = 0; !face.is_ring && i < std::size_t(face.n); i += 2) {
      const auto& [plus, b] = face.row[i == 0 ? 1 : i];
      gradient += b * (space_.value(plus) - space_.value(face.row[i == 0 ? 0 : i + 1].place)).transpose();
    }
    for (std::size_t i = 0; face.is_ring && i < std::size_t(face.n); ++i) {
      const auto& [place, b] = face.row[i];
      const Vec3 u = space_.value(place);
      for (Index j = 0; j < 2; ++j)
        for (Index k = 0; k < 2; ++k)
          if (j == k || face.has_shear) gradient(j, k) += b[j] * u[k];
      gradient(2, 2) += b[2] * u[0];
    }
    // Uses the surface itself, because the middle of the half cell would be only first-order accurate.
    if (face.is_ring && f >= mesh_.n_interior && face.has_shear)
      gradient(2, 2) = space_.value(face.row[1].place)[0] / rows_.geometry().face_centre[f][0];
    if (edges_ && shared_index_[f] >= 0) {
      const Tensor3 own = 0.5 * (gradient + gradient.transpose());
      Tensor3 of_edges = Tensor3::Zero();
      for (const Index e : edges_->edges_of(shared_index_[f])) of_edges += edge_tensor(*edges_, e) / 3;
      gradient += share_[std::size_t(shared_index_[f])] * (of_edges - own);
    }
    if (!pressure_.empty()) {
      // With Hooke's law this gives 2 mu dev(e) + p I.
      const auto [here, there] = pyramids(mesh_, rows_.geometry(), f);
      const LameConstants lame = face_lame(mesh_, rows_, f);
      double mean = here * pressure_[std::size_t(mesh_.owner[f])];
      if (f < mesh_.n_interior) mean += there * pressure_[std::size_t(mesh_.neighbour[f])];
      mean /= here + there;
      const double gap = mean - bulk_of_cells(lame, rows_.volume_strain()) * gradient.trace();
      for (int a = 0; a < mesh_.dim; ++a) gradient(a, a) += gap / (2 * lame.mu + mesh_.dim * lame.lambda);
    }
    take(f, gradient);
  }
}

/// Shared pressure of the faces. Nothing is shared if the volume strain is that of the cells.
std::vector<double> SymmetricKernel::shared_pressure(std::span<const double> pressure) {
  std::vector<double> result(pressure.begin(), pressure.end());
  if (!edges_ || rows_.volume_by_cells()) return result;
  edges_->clear();
  for (std::size_t i = 0; i < sharing_.faces.size(); ++i)
    for (const Index e : edges_->edges_of(i))
      for (int a = 0; a < 3; ++a)
        edges_->at(e)[a] +=
            share_[i] / 3 * sharing_.volumes[i / 4].whole[i % 4] * pressure[sharing_.faces[i]];
  edges_->finish_means();
  for (std::size_t i = 0; i < sharing_.faces.size(); ++i) {
    double of_edges = 0;
    for (const Index e : edges_->edges_of(i)) of_edges += edges_->at(e)[0] / 3;
    double& here = result[sharing_.faces[i]];
    here += share_[i] * (of_edges - here);
  }
  return result;
}

void SymmetricKernel::spread_pressure(std::span<const double> pressure) {
  const std::vector<double> shared = shared_pressure(pressure);
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
    if (mesh_.owner[f] >= mesh_.cells.n_owned()) continue;  // belongs to another rank
    const FaceRows face = face_rows(mesh_, rows_, f);
    for (const FaceRows::Row& row : face.all()) {
      const Vec3 b = face.is_ring ? Vec3(row.b[0] + row.b[2], row.b[1], 0) : row.b;
      space_.force(row.place) += shared[f] * face.volume * b;
    }
  }
}

}  // namespace couplet::elastic
