// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/solve/current_rigid_modes.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <numeric>

#include "common/elasticity/elastic_nodes.hpp"
#include "common/elasticity/symmetric/symmetric_faces.hpp"
#include "common/fv/vertex_interpolation.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::elastic {
namespace {

using Block = Eigen::Matrix<double, 6, 6>;

// Fraction of the largest diagonal entry for modes that move no cell (the spin of a single row of cells),
// whose row would be empty.
constexpr double floor_of_diagonal = 1e-10;
// Limits lambda, because nearly incompressible strains between aggregates would lock the coarse space.
constexpr double most_lambda_over_mu = 3;

/// Displacement of mode m at an arm: translations, then rotations (two and one in 2-D).
Vec3 mode(int m, int dim, const Vec3& arm) {
  if (m < dim) return Vec3::Unit(m);
  if (dim == 2) return Vec3::UnitZ().cross(arm);
  return Vec3::Unit(m - dim).cross(arm);
}

/// Partitions positions into nearly equal parts 0 .. n - 1 by repeated bisection along the longest side.
std::vector<Index> bisect(std::span<const Vec3> places, int n_parts) {
  std::vector<Index> order(places.size()), part(places.size());
  std::iota(order.begin(), order.end(), 0);
  struct PlaceRange {
    std::size_t first, last;
    int part, n;
  };
  std::vector<PlaceRange> open{{0, places.size(), 0, n_parts}};
  while (!open.empty()) {
    const PlaceRange piece = open.back();
    open.pop_back();
    if (piece.n <= 1) {
      for (std::size_t i = piece.first; i < piece.last; ++i) part[order[i]] = piece.part;
      continue;
    }
    Vec3 lower = Vec3::Constant(std::numeric_limits<double>::max()), upper = -lower;
    for (std::size_t i = piece.first; i < piece.last; ++i) {
      lower = lower.cwiseMin(places[order[i]]);
      upper = upper.cwiseMax(places[order[i]]);
    }
    int axis = 0;
    (upper - lower).maxCoeff(&axis);
    const int half = piece.n / 2;
    const std::size_t middle = piece.first + (piece.last - piece.first) * half / piece.n;
    std::nth_element(
        order.begin() + piece.first, order.begin() + middle, order.begin() + piece.last,
        [&](Index a, Index b) { return std::pair(places[a][axis], a) < std::pair(places[b][axis], b); });
    open.push_back({piece.first, middle, piece.part, half});
    open.push_back({middle, piece.last, piece.part + half, piece.n - half});
  }
  return part;
}

void sum_over_ranks(MPI_Comm comm, std::span<double> values) {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_SUM, comm);
}

}  // namespace

CurrentRigidModes::CurrentRigidModes(const mesh::Mesh& mesh, const ElasticOperator& rows, int n_aggregates,
                                     std::vector<double> node_inertia)
    : mesh_(mesh),
      geometry_(rows.geometry()),
      rows_(rows),
      modes_(mesh.dim == 2 ? 3 : 6),
      inertia_(std::move(node_inertia)),
      number_{fv::number_nodes(mesh, rows.unknown_faces()), {}} {
  for (Index i = 0; i < n_node_places(mesh); ++i)
    if (number_.node[i] >= 0) number_.node[i] = i;
  const mesh::Geometry& geometry = rows.geometry();
  const double share = double(mesh.cells.n_owned()) / double(mesh.cells.n_global());
  const int n_here = std::max(1, int(share * n_aggregates + 0.5));
  const std::span<const Vec3> places(geometry.cell_centre.data(), std::size_t(mesh.cells.n_owned()));
  const std::vector<Index> local = bisect(places, n_here);
  const std::vector<int> all = parallel::all_gather(mesh.comm, std::vector<int>{n_here});
  int before = 0, total = 0;
  for (std::size_t r = 0; r < all.size(); ++r) {
    if (int(r) < parallel::comm_rank(mesh.comm)) before += all[r];
    total += all[r];
  }
  std::vector<double> number(std::size_t(mesh.cells.n_local()), 0);
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) number[c] = before + local[c];
  mesh.cells.update_ghosts(number);
  for (const double n : number) aggregate_.push_back(static_cast<Index>(n));
  centre_.assign(std::size_t(total), Vec3::Zero());
}

Index CurrentRigidModes::aggregate_of(Index node) const {
  if (node < mesh_.cells.n_local()) return aggregate_[node];
  return aggregate_[mesh_.owner[node - mesh_.cells.n_local() + mesh_.n_interior]];
}

Vec3 CurrentRigidModes::place(Index node, const DeformedBody& body) const {
  const Vec3& x = node < mesh_.cells.n_local()
                      ? geometry_.cell_centre[node]
                      : geometry_.face_centre[node - mesh_.cells.n_local() + mesh_.n_interior];
  return x + body.displacement[node];
}

Index CurrentRigidModes::unknown_node(std::size_t i) const {
  const std::size_t n_cells = std::size_t(mesh_.cells.n_owned());
  if (i < n_cells) return static_cast<Index>(i);
  return mesh_.cells.n_local() + rows_.unknown_faces()[i - n_cells] - mesh_.n_interior;
}

void CurrentRigidModes::find_arms(const DeformedBody& body) {
  std::vector<double> sums(centre_.size() * 4, 0);
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    double* at = sums.data() + std::size_t(aggregate_[c]) * 4;
    const Vec3 x = place(c, body);
    for (int a = 0; a < 3; ++a) at[a] += geometry_.volume[c] * x[a];
    at[3] += geometry_.volume[c];
  }
  sum_over_ranks(mesh_.comm, sums);
  for (std::size_t a = 0; a < centre_.size(); ++a)
    centre_[a] = Vec3(sums[4 * a], sums[4 * a + 1], sums[4 * a + 2]) / sums[4 * a + 3];
  arm_.clear();
  for (std::size_t i = 0; i < rows_.n_unknowns() / std::size_t(mesh_.dim); ++i) {
    const Index node = unknown_node(i);
    arm_.push_back(place(node, body) - centre_[aggregate_of(node)]);
  }
}

/// Adds V dE_m : C : dE_n between the modes of the aggregates in a face's stencil.
void CurrentRigidModes::add_faces(const DeformedBody& body, std::vector<double>& matrix) const {
  FaceTerms terms_of(mesh_, rows_, number_);
  const std::size_t n = centre_.size() * std::size_t(modes_);
  struct ModeStrain {
    Index aggregate;
    Block strain;  // columns: modes; rows: xx yy zz, and the shears times sqrt(2)
  };
  std::vector<ModeStrain> parts;
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
    if (mesh_.owner[f] >= mesh_.cells.n_owned()) continue;
    const FaceRows face = symmetric_rows(mesh_, rows_, f);
    const FaceTermList& terms = terms_of.of_face(face);
    const Index first = aggregate_of(Index(terms.front().block));
    const auto same = [&](const FaceTerm& t) { return aggregate_of(Index(t.block)) == first; };
    if (std::ranges::all_of(terms, same)) continue;
    parts.clear();
    for (const FaceTerm& t : terms) {
      const auto node = Index(t.block);
      const Index a = aggregate_of(node);
      auto part = std::ranges::find(parts, a, &ModeStrain::aggregate);
      if (part == parts.end()) part = parts.insert(parts.end(), {a, Block::Zero()});
      const Vec3 arm = place(node, body) - centre_[a];
      const Tensor3 pull = body.gradient[f].transpose() * t.turn;
      for (int m = 0; m < modes_; ++m) {
        const Tensor3 e = pull * mode(m, mesh_.dim, arm) * t.b.transpose();
        const double root = std::sqrt(0.5);
        Eigen::Matrix<double, 6, 1> v;
        v << e(0, 0), e(1, 1), e(2, 2), root * (e(0, 1) + e(1, 0)), root * (e(1, 2) + e(2, 1)),
            root * (e(0, 2) + e(2, 0));
        part->strain.col(m) += v;
      }
    }
    const LameConstants lame = face_lame(mesh_, rows_, f);
    Block c = 2 * lame.mu * Block::Identity();
    c.topLeftCorner<3, 3>().array() += std::min(lame.lambda, most_lambda_over_mu * lame.mu);
    for (const ModeStrain& i : parts)
      for (const ModeStrain& j : parts) {
        const Block block = face.volume * i.strain.transpose() * c * j.strain;
        for (int a = 0; a < modes_; ++a)
          for (int b = 0; b < modes_; ++b)
            matrix[(std::size_t(i.aggregate) * modes_ + a) * n + std::size_t(j.aggregate) * modes_ + b] +=
                block(a, b);
      }
  }
}

/// Adds S k of the springs for the mean motion of their faces, even if one aggregate performs all of it.
void CurrentRigidModes::add_springs(const DeformedBody& body, std::vector<double>& matrix) const {
  FaceTerms terms_of(mesh_, rows_, number_);
  const std::size_t n = centre_.size() * std::size_t(modes_);
  for (const Index f : rows_.known_faces()) {
    const BoundaryRow& s = rows_.at(f);
    if (mesh_.owner[f] >= mesh_.cells.n_owned() || s.spring.isZero(0)) continue;
    const Tensor3 open = Tensor3::Identity() - s.known;
    const Tensor3 spring = geometry_.face_area[f].norm() * open * s.spring * open;
    std::map<Index, Eigen::Matrix<double, 3, 6>> motion;  // of the face by the modes of each aggregate
    for (const FaceTerm& t : terms_of.of_mean(f)) {
      const auto node = Index(t.block);
      const Index a = aggregate_of(node);
      auto& moves = motion.try_emplace(a, Eigen::Matrix<double, 3, 6>::Zero()).first->second;
      for (int m = 0; m < modes_; ++m)
        moves.col(m) += t.b[0] * (t.turn * mode(m, mesh_.dim, place(node, body) - centre_[a]));
    }
    for (const auto& [i, of_i] : motion)
      for (const auto& [j, of_j] : motion) {
        const Block block = of_i.transpose() * spring * of_j;
        for (int a = 0; a < modes_; ++a)
          for (int b = 0; b < modes_; ++b)
            matrix[(std::size_t(i) * modes_ + a) * n + std::size_t(j) * modes_ + b] += block(a, b);
      }
  }
}

/// Part of a vector at an unknown node that is not known. Modes move only this part.
Vec3 CurrentRigidModes::free_part(std::size_t i, const Vec3& v) const {
  const std::size_t n_cells = std::size_t(mesh_.cells.n_owned());
  if (i < n_cells) return v;
  const Index f = rows_.unknown_faces()[i - n_cells];
  return v - rows_.at(f).known * v;
}

void CurrentRigidModes::add_inertia(std::vector<double>& matrix) const {
  const std::size_t n = centre_.size() * std::size_t(modes_);
  for (std::size_t i = 0; i < inertia_.size(); ++i) {
    const std::size_t first = std::size_t(aggregate_of(unknown_node(i))) * modes_;
    for (int a = 0; a < modes_; ++a)
      for (int b = 0; b < modes_; ++b)
        matrix[(first + a) * n + first + b] +=
            inertia_[i] * mode(a, mesh_.dim, arm_[i]).dot(mode(b, mesh_.dim, arm_[i]));
  }
}

void CurrentRigidModes::update(const DeformedBody& body) {
  find_arms(body);
  const Index n = static_cast<Index>(centre_.size()) * modes_;
  std::vector<double> matrix(std::size_t(n) * n, 0);
  add_faces(body, matrix);
  add_springs(body, matrix);
  add_inertia(matrix);
  sum_over_ranks(mesh_.comm, matrix);
  double largest = 0;
  for (Index i = 0; i < n; ++i) largest = std::max(largest, matrix[std::size_t(i) * n + i]);
  std::vector<Eigen::Triplet<double>> entries;
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) {
      const double value = matrix[std::size_t(i) * n + j] + (i == j ? floor_of_diagonal * largest : 0);
      if (value != 0) entries.emplace_back(i, j, value);
    }
  Eigen::SparseMatrix<double> sparse(n, n);
  sparse.setFromTriplets(entries.begin(), entries.end());
  factors_ = std::make_unique<Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>>(sparse);
}

void CurrentRigidModes::add_correction(std::span<const double> r, std::span<double> z) const {
  if (!factors_ || factors_->info() != Eigen::Success) return;
  const int dim = mesh_.dim;
  Eigen::VectorXd coarse = Eigen::VectorXd::Zero(Index(centre_.size()) * modes_);
  for (std::size_t i = 0; i < arm_.size(); ++i) {
    Vec3 force = Vec3::Zero();
    for (int a = 0; a < dim; ++a) force[a] = r[i * dim + a];
    force = free_part(i, force);
    const Index first = aggregate_of(unknown_node(i)) * modes_;
    for (int m = 0; m < modes_; ++m) coarse[first + m] += force.dot(mode(m, dim, arm_[i]));
  }
  sum_over_ranks(mesh_.comm, {coarse.data(), std::size_t(coarse.size())});
  const Eigen::VectorXd motion = factors_->solve(coarse);
  for (std::size_t i = 0; i < arm_.size(); ++i) {
    const Index first = aggregate_of(unknown_node(i)) * modes_;
    Vec3 u = Vec3::Zero();
    for (int m = 0; m < modes_; ++m) u += motion[first + m] * mode(m, dim, arm_[i]);
    u = free_part(i, u);
    for (int a = 0; a < dim; ++a) z[i * dim + a] += u[a];
  }
}

}  // namespace couplet::elastic
