// SPDX-License-Identifier: Apache-2.0
#include "coupler/mapping/surface_rows.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/point_tree.hpp"
#include "common/parallel/collective.hpp"
#include "coupler/mapping/corner_weights.hpp"
#include "coupler/mapping/map_projection.hpp"
#include "coupler/mapping/overlay.hpp"
#include "coupler/mapping/slopes.hpp"
#include "coupler/mapping/surroundings.hpp"

namespace couplet::coupler {
namespace {

using Eigen::MatrixXd;

/// Weights of one source in a row, as the dual functions give them and what they have more than the corner functions
/// themselves: that part sums to nothing over the corners of each face.
struct Weights {
  double dual, more;
};

/// A part of a row: so much of the value at a face of the structure, whose mean is taken about `place`.
struct Share {
  GlobalIndex row, source;
  Weights weight;
  Vec3 place;
};

std::vector<GlobalIndex> sorted(std::vector<GlobalIndex> list) {
  std::ranges::sort(list);
  list.erase(std::unique(list.begin(), list.end()), list.end());
  return list;
}

/// The faces of the structure that may cover those of `mine`, and around them those that their slopes look at.
SurfacePart around(MPI_Comm comm, const Surroundings& structure, const coupling::Interface& mine,
                   double widest, MappingParameters::Type type) {
  if (parallel::comm_size(comm) == 1) return structure.with(structure.faces().positions);
  std::vector<double> far;
  for (Index f = 0; f < Index(mine.face_centres.size()); ++f)
    far.push_back(reach(mine, f) / 2 + std::max(widest, reach(mine, f)) / 2);
  const Nearby near = nearby(comm, mine.face_centres, far, nearest_faces, structure.faces());
  std::vector<GlobalIndex> faces = near.positions;
  if (type == MappingParameters::Type::rbf) {
    const Nearby further = nearby(comm, near.points, {}, Slopes::looks_at(mine.dim), structure.faces());
    faces.insert(faces.end(), further.positions.begin(), further.positions.end());
  }
  const std::vector<GlobalIndex> touching = structure.faces_around(structure.with(near.positions).vertices);
  faces.insert(faces.end(), touching.begin(), touching.end());
  return structure.with(sorted(faces));
}

/// Integrals over one face of `surface` of its corner functions and their duals times the structure's field.
class FaceIntegrals {
 public:
  FaceIntegrals(const coupling::Interface& structure, MappingParameters::Type type)
      : structure_(structure), tree_(structure.face_centres), slopes_(structure, type) {
    for (Index s = 0; s < Index(structure.face_centres.size()); ++s) {
      widest_ = std::max(widest_, reach(structure, s));
      Vec3 mean = Vec3::Zero();
      const std::vector<double> weights = corner_weights(structure, s);
      const auto vertex = corners(structure, s);
      for (std::size_t i = 0; i < weights.size(); ++i) mean += weights[i] * structure.vertices[vertex[i]];
      means_.push_back(mean);
    }
  }
  /// Where the mean over a face of the structure is the value of a linear field.
  const Vec3& mean(Index s) const { return means_[std::size_t(s)]; }

  /// Calls add(corner, face of the structure, weights); without `dual` the corner functions themselves.
  template <class Add>
  void operator()(const coupling::Interface& surface, Index face, bool dual, const Add& add) {
    const Vec3& centre = surface.face_centres[face];
    std::vector<Index> candidates = tree_.within(centre, reach(surface, face) + widest_);
    if (candidates.size() < nearest_faces) {
      const std::vector<Index> near = tree_.nearest(centre, nearest_faces);
      candidates.insert(candidates.end(), near.begin(), near.end());
    }
    std::ranges::sort(candidates);
    candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
    const std::vector<Cover> parts = covers(surface, face, structure_, candidates);
    const auto vertex = corners(surface, face);
    const auto n = Eigen::Index(vertex.size());
    // Without weight at first: what a curved surface needs beside the dual functions is spread over more faces.
    if (surface.dim == 3 && dual)
      for (const Index s : tree_.within(centre, 2 * reach(surface, face)))
        if (surface.face_areas[face].dot(structure_.face_areas[s]) < 0)
          for (Eigen::Index i = 0; i < n; ++i) add(i, s, {0, 0});
    Eigen::Matrix3Xd at(3, n);
    for (Eigen::Index i = 0; i < n; ++i) at.col(i) = surface.vertices[vertex[std::size_t(i)]];
    MatrixXd test = MatrixXd::Identity(n, n);
    if (dual) {
      MatrixXd all = MatrixXd::Zero(n, n);
      for (const Cover& part : parts) all += part.products;
      const Eigen::VectorXd sizes = all.rowwise().sum();
      test = sizes.asDiagonal() * all.inverse();
    }
    for (const Cover& part : parts) {
      const MatrixXd tested = test * part.products, more = tested - part.products;
      const Slope& slope = slopes_.at(part.other);
      const auto way = [&](const MatrixXd& m, Eigen::Index i) {
        return Vec3(at * m.row(i).transpose() - m.row(i).sum() * mean(part.other));
      };
      for (Eigen::Index i = 0; i < n; ++i) {
        add(i, part.other, {tested.row(i).sum(), more.row(i).sum()});
        const Vec3 way_dual = way(tested, i), way_more = way(more, i);
        for (std::size_t k = 0; k < slope.around.size(); ++k) {
          const auto along = slope.weights.col(Eigen::Index(k));
          add(i, slope.around[k], {way_dual.dot(along), way_more.dot(along)});
        }
      }
    }
  }

 private:
  const coupling::Interface& structure_;
  base::PointTree tree_;
  Slopes slopes_;
  std::vector<Vec3> means_;
  double widest_ = 0;
};

/// Brings a row (weights at places, their sum 1) to carry linear fields to x: the least change of the weights, in
/// the directions in which the places spread far enough for it.
void make_linear(const Vec3& x, const std::vector<Vec3>& places, std::vector<double>& weights) {
  const double n = double(places.size());
  Vec3 off = x, mean = Vec3::Zero();
  for (std::size_t i = 0; i < places.size(); ++i) off -= weights[i] * places[i], mean += places[i] / n;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vec3& p : places) spread += (p - mean) * (p - mean).transpose() / n;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  const double widest = std::sqrt(std::max(0., solver.eigenvalues()[2]));
  Vec3 change = Vec3::Zero();
  for (int d = 0; d < 3; ++d) {
    const Vec3 direction = solver.eigenvectors().col(d);
    const double deviation = std::sqrt(std::max(0., solver.eigenvalues()[d])), by = direction.dot(off);
    if (deviation > 1e-6 * widest && std::abs(by) < 2 * deviation)
      change += by / (n * solver.eigenvalues()[d]) * direction;
  }
  for (std::size_t i = 0; i < places.size(); ++i) weights[i] += change.dot(places[i] - mean);
}

/// A row of sum 1 that carries linear fields to x. Where a curved surface stands off the other's chords, the dual
/// functions miss the place of their vertex: first so much of `more` is added as brings them nearest to it, which is
/// the same at all vertices of a uniform mesh and so leaves a uniform traction uniform; then the least change.
void finish_row(int dim, const Vec3& x, const std::vector<Vec3>& places, std::vector<Weights>& row,
                std::vector<double>& weights) {
  double total = 0, longest = 0;
  for (const Weights& w : row) total += w.dual;
  Vec3 off = x, by_more = Vec3::Zero();
  for (std::size_t i = 0; i < row.size(); ++i) {
    row[i].dual /= total, row[i].more /= total;
    off -= row[i].dual * places[i], by_more += row[i].more * (places[i] - x);
    longest = std::max(longest, (places[i] - x).norm());
  }
  const double part = dim == 2 && off.norm() > 1e-9 * longest && by_more.norm() > 1e-9 * longest
                          ? std::clamp(off.dot(by_more) / by_more.squaredNorm(), -1., 1.)
                          : 0;
  weights.clear();
  for (const Weights& w : row) weights.push_back(w.dual + part * w.more);
  // Once more for what rounding leaves of the first.
  for (int pass = 0; pass < 2; ++pass) make_linear(x, places, weights);
}

/// Rows from shares sorted by row; `first`: position of the first.
void finish(int dim, const std::vector<Share>& shares, GlobalIndex first, const std::vector<Vec3>& points,
            std::vector<Transfer::Entry>& entries) {
  std::vector<GlobalIndex> sources;
  std::vector<Vec3> places;
  std::vector<Weights> row;
  std::vector<double> weights;
  for (std::size_t begin = 0, end = 0; begin < shares.size(); begin = end) {
    sources.clear(), places.clear(), row.clear();
    for (; end < shares.size() && shares[end].row == shares[begin].row; ++end) {
      const Share& s = shares[end];
      if (sources.empty() || s.source != sources.back())
        sources.push_back(s.source), places.push_back(s.place), row.push_back({0, 0});
      row.back().dual += s.weight.dual, row.back().more += s.weight.more;
    }
    finish_row(dim, points[std::size_t(shares[begin].row - first)], places, row, weights);
    for (std::size_t i = 0; i < sources.size(); ++i)
      if (std::abs(weights[i]) > 1e-15) entries.push_back({shares[begin].row, sources[i], weights[i]});
  }
}

/// Each share on the rank that has its row.
std::vector<Share> by_owner(MPI_Comm comm, const coupling::Starts& rows, std::vector<Share> shares) {
  if (parallel::comm_size(comm) == 1) return shares;
  std::vector<std::vector<Share>> send(std::size_t(parallel::comm_size(comm)));
  for (const Share& s : shares) send[std::size_t(coupling::owner_of(rows, s.row))].push_back(s);
  std::vector<Share> mine;
  for (const auto& part : parallel::all_to_all(comm, send)) mine.insert(mine.end(), part.begin(), part.end());
  std::ranges::stable_sort(mine, [](const Share& a, const Share& b) {
    return a.row != b.row ? a.row < b.row : a.source < b.source;
  });
  return mine;
}

/// What the faces of `mine` add to rows of their corners or of their own; each pair once.
std::vector<Share> shares_of(const SurfacePart& structure, const SurfacePart& mine,
                             MappingParameters::Type type, bool at_vertices) {
  FaceIntegrals integrals(structure.surface, type);
  std::vector<std::vector<std::pair<Index, Weights>>> rows(at_vertices ? mine.vertices.size()
                                                                       : mine.faces.size());
  for (Index f = 0; f < Index(mine.faces.size()); ++f) {
    const auto vertex = corners(mine.surface, f);
    integrals(mine.surface, f, at_vertices, [&](Eigen::Index corner, Index s, const Weights& weight) {
      auto& row = rows[std::size_t(at_vertices ? vertex[std::size_t(corner)] : f)];
      auto known = std::ranges::find(row, s, &std::pair<Index, Weights>::first);
      if (known == row.end()) known = row.insert(row.end(), {s, {0, 0}});
      known->second.dual += weight.dual, known->second.more += weight.more;
    });
  }
  std::vector<Share> shares;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    std::ranges::sort(rows[r], {}, &std::pair<Index, Weights>::first);
    for (const auto& [s, weight] : rows[r])
      shares.push_back({at_vertices ? mine.vertices[r] : mine.faces[r], structure.faces[std::size_t(s)],
                        weight, integrals.mean(s)});
  }
  return shares;
}

std::vector<Transfer::Entry> rows(MPI_Comm comm, const coupling::Interface& structure,
                                  const coupling::Interface& surface, MappingParameters::Type type,
                                  bool at_vertices) {
  const Surroundings theirs(comm, structure), ours(comm, surface);
  const PointSet vertices = ours.vertices(), faces = ours.faces();
  const SurfacePart mine = ours.with(faces.positions);
  const SurfacePart own = theirs.with(theirs.faces().positions);
  double widest = 0;
  for (Index s = 0; s < Index(own.faces.size()); ++s) widest = std::max(widest, reach(own.surface, s));
  const SurfacePart near = around(comm, theirs, mine.surface, parallel::max(comm, widest), type);
  std::vector<Share> shares =
      mine.faces.empty() ? std::vector<Share>{} : shares_of(near, mine, type, at_vertices);
  std::vector<Transfer::Entry> entries;
  const PointSet& targets = at_vertices ? vertices : faces;
  const GlobalIndex first = targets.starts[std::size_t(parallel::comm_rank(comm))];
  const std::vector<Share> known = by_owner(comm, targets.starts, std::move(shares));
  finish(structure.dim, known, first, targets.points, entries);
  // A vertex of no face.
  std::vector<char> has(targets.points.size(), 0);
  for (const Share& s : known) has[std::size_t(s.row - first)] = 1;
  std::vector<Vec3> lone;
  std::vector<GlobalIndex> positions;
  for (std::size_t i = 0; i < has.size(); ++i)
    if (!has[i]) lone.push_back(targets.points[i]), positions.push_back(targets.positions[i]);
  const std::size_t k = structure.dim == 2 ? 3 : 5;
  const Nearby next = nearby(comm, lone, {}, k, theirs.faces());
  if (!lone.empty())
    add_entries(local_interpolation(next.points, lone, k), positions, next.positions, entries);
  return entries;
}

}  // namespace

std::vector<Transfer::Entry> faces_to_vertices(MPI_Comm comm, const coupling::Interface& structure,
                                               const coupling::Interface& surface,
                                               MappingParameters::Type type) {
  return rows(comm, structure, surface, type, true);
}

std::vector<Transfer::Entry> faces_to_faces(MPI_Comm comm, const coupling::Interface& structure,
                                            const coupling::Interface& surface,
                                            MappingParameters::Type type) {
  return rows(comm, structure, surface, type, false);
}

}  // namespace couplet::coupler
