// SPDX-License-Identifier: Apache-2.0

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "common/parallel/collective.hpp"
#include "coupler/exchange/side.hpp"
#include "coupler/mapping/face_weights.hpp"
#include "coupler/mapping/sparse_map.hpp"

namespace couplet::coupler {
namespace {

/// Part of a row: weight of the value at a face of the structure, with its mean at `place`.
struct Share {
  GlobalIndex row, source;
  DualWeights weight;
  Vec3 place;
};

std::vector<GlobalIndex> sorted(std::vector<GlobalIndex> list) {
  std::ranges::sort(list);
  list.erase(std::unique(list.begin(), list.end()), list.end());
  return list;
}

/// Faces of the structure that may cover those of `mine`, and the neighbors needed for their slopes.
SurfacePart around(MPI_Comm comm, const Surroundings& structure, const coupling::Interface& mine,
                   double widest) {
  if (parallel::comm_size(comm) == 1) return structure.with(structure.faces().positions);
  std::vector<double> far;
  for (Index f = 0; f < Index(mine.face_centres.size()); ++f)
    far.push_back(reach(mine, f) / 2 + std::max(widest, reach(mine, f)) / 2);
  const PointSet near = nearby(comm, mine.face_centres, far, nearest_faces, structure.faces());
  std::vector<GlobalIndex> faces = near.positions;
  const std::vector<GlobalIndex> touching = structure.faces_around(structure.with(near.positions).vertices);
  faces.insert(faces.end(), touching.begin(), touching.end());
  return structure.with(sorted(faces));
}

/// Corrects a row (weights at places, with sum 1) to be exact for linear fields at the origin, by the smallest
/// change in directions of sufficient extent.
void make_linear(const std::vector<Vec3>& places, std::vector<double>& weights) {
  const double n = double(places.size());
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : places) mean += p / n;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vec3& p : places) spread += (p - mean) * (p - mean).transpose() / n;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  const double widest = std::sqrt(std::max(0., solver.eigenvalues()[2]));
  // Repeated to remove round-off of the first pass.
  for (int pass = 0; pass < 2; ++pass) {
    Vec3 off = Vec3::Zero(), change = Vec3::Zero();
    for (std::size_t i = 0; i < places.size(); ++i) off -= weights[i] * places[i];
    for (int d = 0; d < 3; ++d) {
      const Vec3 direction = solver.eigenvectors().col(d);
      const double deviation = std::sqrt(std::max(0., solver.eigenvalues()[d])), by = direction.dot(off);
      if (deviation > 1e-6 * widest && std::abs(by) < 2 * deviation)
        change += by / (n * solver.eigenvalues()[d]) * direction;
    }
    double level = 0;  // round-off of the mean, which would change the sum
    for (const Vec3& p : places) level += change.dot(p - mean) / n;
    for (std::size_t i = 0; i < places.size(); ++i) weights[i] += change.dot(places[i] - mean) - level;
  }
}

/// Row with sum 1 that is exact for linear fields at the origin. Places are relative to the row's own, because
/// in a direction of small extent the round-off of absolute positions would change the sum. On a curved surface, the dual functions miss the
/// position of their vertex. A share of `more` first moves them nearest to it. This share is the same at all
/// vertices of a uniform mesh, so a uniform traction remains uniform. Then the smallest change follows.
void finish_row(int dim, const std::vector<Vec3>& places, std::vector<DualWeights>& row,
                std::vector<double>& weights) {
  double total = 0, longest = 0;
  for (const DualWeights& w : row) total += w.dual;
  Vec3 off = Vec3::Zero(), by_more = Vec3::Zero();
  for (std::size_t i = 0; i < row.size(); ++i) {
    row[i].dual /= total, row[i].more /= total;
    off -= row[i].dual * places[i], by_more += row[i].more * places[i];
    longest = std::max(longest, places[i].norm());
  }
  const double part = dim == 2 && off.norm() > 1e-9 * longest && by_more.norm() > 1e-9 * longest
                          ? std::clamp(off.dot(by_more) / by_more.squaredNorm(), -1., 1.)
                          : 0;
  weights.clear();
  for (const DualWeights& w : row) weights.push_back(w.dual + part * w.more);
  make_linear(places, weights);
}

/// Work arrays for one row at a time.
class RowBuffers {
 public:
  void clear() { sources_.clear(), places_.clear(), row_.clear(); }
  /// Equal sources must be consecutive.
  void add(GlobalIndex source, const Vec3& place, const DualWeights& weight) {
    if (sources_.empty() || source != sources_.back())
      sources_.push_back(source), places_.push_back(place), row_.push_back({0, 0});
    row_.back().dual += weight.dual, row_.back().more += weight.more;
  }
  void finish(int dim, GlobalIndex row, const Vec3& x, std::vector<Transfer::Entry>& entries) {
    for (Vec3& place : places_) place -= x;
    finish_row(dim, places_, row_, weights_);
    for (std::size_t i = 0; i < sources_.size(); ++i)
      if (std::abs(weights_[i]) > 1e-15) entries.push_back({row, sources_[i], weights_[i]});
  }

 private:
  std::vector<GlobalIndex> sources_;
  std::vector<Vec3> places_;
  std::vector<DualWeights> row_;
  std::vector<double> weights_;
};

/// Builds rows from sorted shares. `first`: position of the first row.
void finish(int dim, const std::vector<Share>& shares, GlobalIndex first, const std::vector<Vec3>& points,
            std::vector<Transfer::Entry>& entries) {
  RowBuffers buffers;
  for (std::size_t begin = 0, end = 0; begin < shares.size(); begin = end) {
    buffers.clear();
    for (; end < shares.size() && shares[end].row == shares[begin].row; ++end)
      buffers.add(shares[end].source, shares[end].place, shares[end].weight);
    const GlobalIndex row = shares[begin].row;
    buffers.finish(dim, row, points[std::size_t(row - first)], entries);
  }
}

/// Sends each share to the rank of its row.
std::vector<Share> shares_by_owner(MPI_Comm comm, const coupling::Starts& rows, std::vector<Share> shares) {
  std::vector<Share> mine =
      to_owners(comm, std::move(shares), [&](const Share& s) { return coupling::owner_of(rows, s.row); });
  std::ranges::stable_sort(mine, [](const Share& a, const Share& b) {
    return a.row != b.row ? a.row < b.row : a.source < b.source;
  });
  return mine;
}

/// Rows of a map assembled face by face. A row is finished with its last face, so few are open at a time if
/// neighbors follow each other. Rows with contributions of faces on other ranks remain as shares.
class OpenRows {
 public:
  /// `faces_of`: number of faces per row. `whole`: true if these are all. `rows`: positions of the rows.
  OpenRows(std::vector<Index> faces_of, std::vector<char> whole, const std::vector<GlobalIndex>& rows,
           std::size_t sources)
      : left_(std::move(faces_of)),
        whole_(std::move(whole)),
        rows_(rows),
        open_(left_.size()),
        place_(sources, -1) {}

  /// Adds the contributions of a face to the row of its corner i of n.
  void add(std::size_t row, const FaceIntegrals& integrals, std::size_t i, std::size_t n) {
    auto& list = open_[row];
    if (list.empty()) list.reserve(32);
    for (std::size_t k = 0; k < list.size(); ++k) place_[std::size_t(list[k].first)] = Index(k);
    for (std::size_t k = 0; k < integrals.sources().size(); ++k) {
      const Index source = integrals.sources()[k];
      const DualWeights& weight = integrals.weights()[k * n + i];
      if (const Index place = place_[std::size_t(source)]; place < 0)
        list.push_back({source, weight});
      else
        list[std::size_t(place)].second.dual += weight.dual,
            list[std::size_t(place)].second.more += weight.more;
    }
    for (const auto& [source, weight] : list) place_[std::size_t(source)] = -1;
  }
  /// Completes one of its faces. Calls finished(row, parts by source) for a row that was completed by it.
  template <class Finished>
  void done(std::size_t row, const SurfacePart& structure, const FaceIntegrals& integrals,
            const Finished& finished) {
    if (--left_[row] > 0) return;
    std::vector<Part> list = std::exchange(open_[row], {});
    std::ranges::sort(list, {}, &Part::first);
    if (whole_[row])
      finished(row, list);
    else
      for (const auto& [s, weight] : list)
        shares.push_back({rows_[row], structure.faces[std::size_t(s)], weight, integrals.mean(s)});
  }
  using Part = std::pair<Index, DualWeights>;
  std::vector<Share> shares;

 private:
  std::vector<Index> left_;
  std::vector<char> whole_;
  const std::vector<GlobalIndex>& rows_;
  std::vector<std::vector<Part>> open_;
  std::vector<Index> place_;  // of a source in the row at work; -1 if it has none
};

/// Vertices of `part` that belong to this rank and to no face of another rank. Collective.
std::vector<char> alone_at(MPI_Comm comm, const std::vector<GlobalIndex>& vertices, const PointSet& own) {
  const auto rank = std::size_t(parallel::comm_rank(comm));
  const GlobalIndex first = own.starts[rank], end = own.starts[rank + 1];
  std::vector<char> touched(own.points.size(), 0), alone;
  std::vector<GlobalIndex> others;
  for (const GlobalIndex v : vertices)
    if (v < first || v >= end) others.push_back(v);
  for (const GlobalIndex v :
       to_owners(comm, std::move(others), [&](GlobalIndex v) { return coupling::owner_of(own.starts, v); }))
    touched[std::size_t(v - first)] = 1;
  for (const GlobalIndex v : vertices)
    alone.push_back(v >= first && v < end && !touched[std::size_t(v - first)]);
  return alone;
}

/// Rows with contributions from faces of `mine`, at their corners or centers.
struct Targets {
  const PointSet& points;  ///< of this rank
  bool at_vertices;
  GlobalIndex first;
};

/// Finished rows go to `entries`, the others are returned.
std::vector<Share> shares_of(MPI_Comm comm, const SurfacePart& structure, const SurfacePart& mine,
                             const Targets& targets, std::vector<Transfer::Entry>& entries) {
  const std::vector<GlobalIndex>& list = targets.at_vertices ? mine.vertices : mine.faces;
  std::vector<char> whole =
      targets.at_vertices ? alone_at(comm, list, targets.points) : std::vector<char>(list.size(), 1);
  if (mine.faces.empty()) return {};
  FaceIntegrals integrals(structure.surface);
  std::vector<Index> faces_of(list.size(), targets.at_vertices ? 0 : 1);
  if (targets.at_vertices)
    for (const Index v : mine.surface.face_vertices) ++faces_of[v];
  OpenRows rows(std::move(faces_of), std::move(whole), list, structure.faces.size());
  RowBuffers buffers;
  const auto finished = [&](std::size_t row, const std::vector<OpenRows::Part>& parts) {
    buffers.clear();
    for (const auto& [s, weight] : parts)
      buffers.add(structure.faces[std::size_t(s)], integrals.mean(s), weight);
    buffers.finish(structure.surface.dim, list[row],
                   targets.points.points[std::size_t(list[row] - targets.first)], entries);
  };
  // More than adjacent surfaces with faces of equal size have.
  entries.reserve(40 * targets.points.points.size());
  for (Index f = 0; f < Index(mine.faces.size()); ++f) {
    const auto vertex = corners(mine.surface, f);
    const std::size_t n = vertex.size();
    integrals.find(mine.surface, f, targets.at_vertices);
    for (std::size_t i = 0; i < n; ++i)
      rows.add(std::size_t(targets.at_vertices ? vertex[i] : f), integrals, i, n);
    for (std::size_t i = 0; i < (targets.at_vertices ? n : 1); ++i)
      rows.done(std::size_t(targets.at_vertices ? vertex[i] : f), structure, integrals, finished);
  }
  return std::move(rows.shares);
}

std::vector<Transfer::Entry> rows(MPI_Comm comm, const coupling::Interface& structure,
                                  const coupling::Interface& surface, bool at_vertices) {
  const Surroundings theirs(comm, structure), ours(comm, surface);
  const PointSet vertices = ours.vertices(), faces = ours.faces();
  const SurfacePart mine = ours.with(faces.positions);
  const SurfacePart near = around(comm, theirs, mine.surface, theirs.widest());
  const PointSet& points = at_vertices ? vertices : faces;
  const Targets targets{points, at_vertices, points.starts[std::size_t(parallel::comm_rank(comm))]};
  std::vector<Transfer::Entry> entries;
  std::vector<Share> shares = shares_of(comm, near, mine, targets, entries);
  std::vector<char> has(points.points.size(), 0);
  for (const auto& e : entries) has[std::size_t(e.target - targets.first)] = 1;
  const std::vector<Share> known = shares_by_owner(comm, points.starts, std::move(shares));
  finish(structure.dim, known, targets.first, points.points, entries);
  for (const Share& s : known) has[std::size_t(s.row - targets.first)] = 1;
  // Vertices without a face.
  std::vector<Vec3> lone;
  std::vector<GlobalIndex> positions;
  for (std::size_t i = 0; i < has.size(); ++i)
    if (!has[i]) lone.push_back(points.points[i]), positions.push_back(points.positions[i]);
  add_interpolation(comm, theirs.faces(), lone, positions, structure.dim == 2 ? 3 : 5, entries);
  return by_owner(comm, points.starts, std::move(entries));
}

}  // namespace

std::vector<Transfer::Entry> faces_to_vertices(MPI_Comm comm, const coupling::Interface& structure,
                                               const coupling::Interface& surface) {
  return rows(comm, structure, surface, true);
}

std::vector<Transfer::Entry> faces_to_faces(MPI_Comm comm, const coupling::Interface& structure,
                                            const coupling::Interface& surface) {
  return rows(comm, structure, surface, false);
}

}  // namespace couplet::coupler
