// SPDX-License-Identifier: Apache-2.0
#include "common/coupling/mesh_motion.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "common/base/error.hpp"
#include "common/coupling/wait.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::coupling {
namespace {

constexpr int motion_tag = 7101;
const char* const mover_name = "the mesh mover";
const char* const fluid_name = "the fluid";

/// Status at the start of a message. It is followed by dim displacements per point in the agreed order, and
/// velocities if there are any.
enum class Status : int { moved, failed };

/// Points that one rank of the other program sends or receives.
struct PeerPoints {
  int rank;
  std::vector<Index> points;
};

int remote_size(MPI_Comm peers) {
  int size = 0;
  MPI_Comm_remote_size(peers, &size);
  return size;
}

/// Synchronizes without blocking the other side's processor while it reads its mesh.
void meet(MPI_Comm peers, const char* whom) {
  MPI_Request request;
  MPI_Ibarrier(peers, &request);
  wait_politely(request, whom);
}

/// Ids of the points owned by every rank of the other side. Both sides throw if the numbers of points differ.
std::vector<std::vector<GlobalIndex>> exchange_owned_ids(MPI_Comm peers, const mesh::Mesh& mesh) {
  const int n_remote = remote_size(peers);
  const GlobalIndex mine[3] = {mesh.points.n_global(), mesh.dim, mesh.points.n_owned()};
  std::vector<GlobalIndex> theirs(3 * std::size_t(n_remote));
  MPI_Allgather(mine, 3, MPI_INT64_T, theirs.data(), 3, MPI_INT64_T, peers);
  if (theirs[0] != mine[0] || theirs[1] != mine[1])
    throw Error(
        "The meshes of the fluid and the mesh mover differ: {} points in {}-D on this side, {} points in "
        "{}-D on the other. Both participants must read the same mesh file.",
        mine[0], mine[1], theirs[0], theirs[1]);
  std::vector<int> counts, first;
  GlobalIndex total = 0;
  for (int r = 0; r < n_remote; ++r) {
    first.push_back(static_cast<int>(total));
    counts.push_back(static_cast<int>(theirs[3 * r + 2]));
    total += counts.back();
  }
  std::vector<GlobalIndex> ids(total);
  MPI_Allgatherv(mesh.point_id.data(), mesh.points.n_owned(), MPI_INT64_T, ids.data(), counts.data(),
                 first.data(), MPI_INT64_T, peers);
  std::vector<std::vector<GlobalIndex>> by_rank;
  for (int r = 0; r < n_remote; ++r)
    by_rank.emplace_back(ids.begin() + first[r], ids.begin() + first[r] + counts[r]);
  return by_rank;
}

/// Exchanges ids: send[r] goes to rank r of the other side.
std::vector<std::vector<GlobalIndex>> exchange_ids(MPI_Comm peers,
                                                   const std::vector<std::vector<GlobalIndex>>& send) {
  const int n = remote_size(peers);
  std::vector<int> send_counts(n), send_first(n), counts(n), first(n);
  std::vector<GlobalIndex> out;
  for (int r = 0; r < n; ++r) {
    send_first[r] = static_cast<int>(out.size());
    send_counts[r] = static_cast<int>(send[r].size());
    out.insert(out.end(), send[r].begin(), send[r].end());
  }
  MPI_Alltoall(send_counts.data(), 1, MPI_INT, counts.data(), 1, MPI_INT, peers);
  for (int r = 1; r < n; ++r) first[r] = first[r - 1] + counts[r - 1];
  std::vector<GlobalIndex> in(first[n - 1] + counts[n - 1]);
  MPI_Alltoallv(out.data(), send_counts.data(), send_first.data(), MPI_INT64_T, in.data(), counts.data(),
                first.data(), MPI_INT64_T, peers);
  std::vector<std::vector<GlobalIndex>> received;
  for (int r = 0; r < n; ++r) received.emplace_back(in.begin() + first[r], in.begin() + first[r] + counts[r]);
  return received;
}

/// Returns true on both sides if `value` is true on any rank of the source.
bool any_of_source(MPI_Comm peers, MPI_Comm own, bool is_source, bool value) {
  const int mine = is_source && value ? 1 : 0;
  int theirs = 0;
  MPI_Allreduce(&mine, &theirs, 1, MPI_INT, MPI_MAX, peers);
  return is_source ? parallel::any(own, value) : theirs != 0;
}

[[noreturn]] void throw_other_points(const std::string& detail) {
  throw Error(
      "The meshes of the fluid and the mesh mover differ{}. Both participants must read the same mesh file.",
      detail);
}

class PeerSource final : public MeshMotionSource {
 public:
  PeerSource(MPI_Comm peers, const mesh::Mesh& mesh, std::span<const Vec3> places)
      : peers_(peers), dim_(mesh.dim), n_points_(mesh.points.n_local()) {
    meet(peers, mover_name);
    const auto owned = exchange_owned_ids(peers, mesh);
    std::vector<std::pair<GlobalIndex, int>> owner_of;
    for (std::size_t r = 0; r < owned.size(); ++r)
      for (const GlobalIndex id : owned[r]) owner_of.emplace_back(id, static_cast<int>(r));
    std::sort(owner_of.begin(), owner_of.end());

    std::vector<std::vector<GlobalIndex>> wanted(owned.size());
    std::vector<std::vector<Index>> points(owned.size());
    bool missing = false;
    for (Index p = 0; p < n_points_; ++p) {
      const auto found = std::lower_bound(owner_of.begin(), owner_of.end(), std::pair(mesh.point_id[p], 0));
      if (found == owner_of.end() || found->first != mesh.point_id[p]) {
        missing = true;
        continue;
      }
      wanted[found->second].push_back(mesh.point_id[p]);
      points[found->second].push_back(p);
    }
    exchange_ids(peers, wanted);
    if (any_of_source(peers, mesh.comm, true, missing))
      throw_other_points(": their points have different numbers");
    for (std::size_t r = 0; r < points.size(); ++r)
      if (!points[r].empty()) from_.push_back({static_cast<int>(r), std::move(points[r])});
    compare_points(mesh, places);
  }

  std::vector<double> receive() override {
    std::vector<double> values(std::size_t(n_points_) * dim_);
    velocity_.clear();
    bool failed = false;
    for (const PeerPoints& peer : from_) {
      const std::vector<char> bytes = receive_bytes(peers_, peer.rank, motion_tag, mover_name);
      const auto message = parallel::detail::from_bytes<double>(bytes);
      if (message.at(0) != double(Status::moved)) {
        failed = true;
        continue;
      }
      const std::size_t size = peer.points.size() * dim_;
      assert(message.size() == 1 + size || message.size() == 1 + 2 * size);
      take(peer, std::span(message).subspan(1, size), values);
      if (message.size() == 1 + size) continue;
      velocity_.resize(values.size());
      take(peer, std::span(message).subspan(1 + size, size), velocity_);
    }
    if (failed) throw SolveFailure("The mesh mover could not move the mesh.");
    return values;
  }

  const std::vector<double>& velocity() const override { return velocity_; }

 private:
  void take(const PeerPoints& peer, std::span<const double> from, std::vector<double>& values) const {
    for (std::size_t i = 0; i < peer.points.size(); ++i)
      for (int c = 0; c < dim_; ++c) values[std::size_t(peer.points[i]) * dim_ + c] = from[i * dim_ + c];
  }
  /// Checks positions, because equal ids at other positions would move the wrong points.
  void compare_points(const mesh::Mesh& mesh, std::span<const Vec3> places) {
    const std::vector<double> theirs = receive();
    Vec3 low = Vec3::Constant(INFINITY), high = -low;
    for (const Vec3& x : places) {
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
    }
    const double tolerance = n_points_ > 0 ? 1e-9 * (high - low).norm() : 0;
    bool other = false;
    for (Index p = 0; p < n_points_; ++p)
      for (int c = 0; c < dim_; ++c)
        other = other || std::abs(theirs[std::size_t(p) * dim_ + c] - places[p][c]) > tolerance;
    if (any_of_source(peers_, mesh.comm, true, other))
      throw_other_points(
          ": their points have different "
          "coordinates");
  }

  MPI_Comm peers_;
  int dim_;
  Index n_points_;
  std::vector<PeerPoints> from_;
  std::vector<double> velocity_;
};

}  // namespace

struct MeshMotionSink::Outgoing {
  int rank;
  std::vector<Index> points;
  std::vector<double> message{};
  MPI_Request request = MPI_REQUEST_NULL;
  /// Starts a message after the previous one was sent. Sends do not wait, because the fluid receives them
  /// when the coupler starts its solve.
  void start(Status status) {
    wait_politely(request, fluid_name);
    message.assign(1, double(status));
  }
  void post(MPI_Comm peers) {
    MPI_Isend(message.data(), static_cast<int>(message.size() * sizeof(double)), MPI_BYTE, rank, motion_tag,
              peers, &request);
  }
};

MeshMotionSink::MeshMotionSink(MPI_Comm peers, const mesh::Mesh& mesh, std::span<const Vec3> places)
    : peers_(peers), dim_(mesh.dim) {
  meet(peers, fluid_name);
  exchange_owned_ids(peers, mesh);
  const auto wanted = exchange_ids(peers, std::vector<std::vector<GlobalIndex>>(remote_size(peers)));
  if (any_of_source(peers, mesh.comm, false, false))
    throw_other_points(": their points have different numbers");

  std::vector<std::pair<GlobalIndex, Index>> owned;
  for (Index p = 0; p < mesh.points.n_owned(); ++p) owned.emplace_back(mesh.point_id[p], p);
  std::sort(owned.begin(), owned.end());
  for (std::size_t r = 0; r < wanted.size(); ++r) {
    if (wanted[r].empty()) continue;
    Outgoing& to = to_.emplace_back(static_cast<int>(r));
    for (const GlobalIndex id : wanted[r])
      to.points.push_back(std::lower_bound(owned.begin(), owned.end(), std::pair(id, Index(0)))->second);
  }
  std::vector<double> points;
  for (const Vec3& x : places) points.insert(points.end(), x.begin(), x.begin() + dim_);
  send(points, {});
  if (any_of_source(peers, mesh.comm, false, false))
    throw_other_points(": their points have different coordinates");
}

MeshMotionSink::~MeshMotionSink() {
  // If the job ends early, MPI may still read a message that the fluid never received, so it is leaked.
  for (Outgoing& to : to_) {
    int done = 1;
    if (to.request != MPI_REQUEST_NULL) MPI_Test(&to.request, &done, MPI_STATUS_IGNORE);
    if (done) continue;
    new std::vector<double>(std::move(to.message));
    MPI_Request_free(&to.request);
  }
}

void MeshMotionSink::send(std::span<const double> displacement, std::span<const double> velocity) {
  for (Outgoing& to : to_) {
    to.start(Status::moved);
    for (const std::span<const double> values : {displacement, velocity})
      for (std::size_t i = 0; i < to.points.size() && !values.empty(); ++i)
        for (int c = 0; c < dim_; ++c) to.message.push_back(values[std::size_t(to.points[i]) * dim_ + c]);
    to.post(peers_);
  }
}

void MeshMotionSink::send_failure() {
  for (Outgoing& to : to_) {
    to.start(Status::failed);
    to.post(peers_);
  }
}

std::unique_ptr<MeshMotionSource> make_mesh_motion_source(MPI_Comm peers, const mesh::Mesh& mesh,
                                                          std::span<const Vec3> points) {
  return std::make_unique<PeerSource>(peers, mesh, points);
}

}  // namespace couplet::coupling
