// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/parameters/interface_data.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <numeric>

#include "common/base/error.hpp"
#include "common/base/point_tree.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::solid {
namespace {

/// A face, its neighbors, and the matrix from differences of their values to a gradient (3 x k).
struct FaceSurroundings {
  std::vector<Index> around;
  Eigen::Matrix3Xd gradient;
};

FaceSurroundings surroundings_of(Index face, const std::vector<Vec3>& centres, const base::PointTree& tree) {
  constexpr std::size_t most = 8;
  std::vector<Index> others = tree.nearest(centres[face], most + 1);
  std::erase(others, face);
  const std::size_t n = std::min(most, others.size());
  others.resize(n);
  // Only the nearest ring of faces is needed; in a strip that is one face on each side.
  Eigen::MatrixX3d offsets(Eigen::Index(n), 3);
  for (std::size_t i = 0; i < n; ++i) offsets.row(Eigen::Index(i)) = centres[others[i]] - centres[face];
  // Weighted by the inverse squared distance, so that near faces dominate.
  Eigen::VectorXd weight = offsets.rowwise().squaredNorm().cwiseInverse();
  const Eigen::MatrixX3d weighted = weight.asDiagonal() * offsets;
  FaceSurroundings found{std::move(others), Eigen::Matrix3Xd::Zero(3, Eigen::Index(n))};
  if (n == 0) return found;  // a single face: its value everywhere
  Eigen::JacobiSVD<Eigen::MatrixXd> svd(weighted, Eigen::ComputeThinU | Eigen::ComputeThinV);
  svd.setThreshold(0.05);
  found.gradient = svd.solve(Eigen::MatrixXd(weight.asDiagonal()));
  return found;
}

}  // namespace

FaceInterpolation::FaceInterpolation(const std::vector<Vec3>& centres, std::span<const Vec3> points) {
  if (centres.empty()) return;
  const base::PointTree tree(centres);
  std::vector<FaceSurroundings> surroundings(centres.size());
  std::vector<bool> made(centres.size(), false);
  first_.push_back(0);
  for (const Vec3& x : points) {
    const Index a = tree.nearest(x, 1).front();
    if (!made[a]) surroundings[a] = surroundings_of(a, centres, tree), made[a] = true;
    nearest_.push_back(a);
    const Eigen::RowVectorXd weights = (x - centres[a]).transpose() * surroundings[a].gradient;
    for (std::size_t k = 0; k < surroundings[a].around.size(); ++k)
      face_.push_back(surroundings[a].around[k]), weight_.push_back(weights[Eigen::Index(k)]);
    first_.push_back(static_cast<Index>(face_.size()));
  }
}

double FaceInterpolation::value(std::size_t point, std::span<const double> faces) const {
  const double here = faces[nearest_[point]];
  double sum = here, low = here, high = here;
  for (Index k = first_[point]; k < first_[point + 1]; ++k) {
    const double other = faces[face_[k]];
    sum += weight_[k] * (other - here);
    low = std::min(low, other), high = std::max(high, other);
  }
  return std::clamp(sum, low, high);
}

void declare(config::Section& s, InterfaceData& d) {
  using Load = InterfaceData::Load;
  s.choice("load", d.load, {{"forces", Load::forces}, {"pressure", Load::pressure}})
      .doc("data received at the faces: pressure-force and viscous-force, or a single pressure");
  s.value("temperature", d.temperature)
      .doc(
          "receive a temperature at the faces; the solid uses it along the interface, linear between the "
          "faces and constant through its thickness");
}

std::vector<coupling::Interface::Datum> taken(const InterfaceData& data) {
  using Place = coupling::Interface::Place;
  std::vector<coupling::Interface::Datum> list;
  if (data.load == InterfaceData::Load::pressure)
    list = {{"pressure", "Pa", Place::faces, 1}};
  else
    list = {{"pressure-force", "N", Place::faces}, {"viscous-force", "N", Place::faces}};
  if (data.temperature) list.push_back({"temperature", "K", Place::faces, 1});
  return list;
}

// All centers are stored on each rank only during the search for the nearest ones.
InterfaceTemperature::InterfaceTemperature(MPI_Comm comm, const std::vector<Vec3>& centres,
                                           const std::vector<std::span<const Vec3>>& places)
    : comm_(comm) {
  const auto n_here = static_cast<Index>(centres.size());
  const std::vector<Index> counts = parallel::all_gather(comm, std::vector<Index>{n_here});
  std::vector<Index> first{0};  // of each rank's faces in the list of all, and one more
  for (const Index n : counts) first.push_back(first.back() + n);
  const Index mine = first[parallel::comm_rank(comm)];
  const std::vector<Vec3> all = parallel::all_gather(comm, centres);
  for (const auto& points : places) at_.emplace_back(all, points);

  std::vector<Index> local(all.size(), -1);
  std::iota(local.begin() + mine, local.begin() + mine + n_here, 0);
  std::vector<int> owner;
  std::vector<Index> remote;
  const auto number = [&](Index& f) {
    if (local[f] < 0) {
      local[f] = n_here + static_cast<Index>(owner.size());
      owner.push_back(int(std::ranges::upper_bound(first, f) - first.begin()) - 1);
      remote.push_back(f - first[owner.back()]);
    }
    f = local[f];
  };
  for (FaceInterpolation& interpolation : at_) interpolation.for_each_face(number);
  faces_ = parallel::IndexMap(comm, n_here, owner, remote);
}

std::vector<double> InterfaceTemperature::with_others(const std::vector<double>& here) const {
  if (!parallel::any(comm_, !here.empty())) return {};
  const Index n_owned = faces_.n_owned();
  if (parallel::any(comm_, std::ssize(here) != n_owned))
    throw Error(
        "Expected {1} temperatures on this rank, one per interface face, but received {0} (here or on "
        "another rank).",
        here.size(), n_owned);
  std::vector<double> values = here;
  values.resize(faces_.n_local());
  faces_.update_ghosts(values);
  return values;
}

}  // namespace couplet::solid
