// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/distributed/periodic_faces.hpp"

#include <algorithm>
#include <limits>
#include <tuple>

#include "common/base/error.hpp"
#include "common/mesh/load.hpp"
#include "common/mesh/topology.hpp"

namespace couplet::mesh {
namespace {

/// How far the middle of a face may be from its partner's, as a share of its size.
constexpr double periodic_tolerance = 1e-4;

struct MetSide {
  Vec3 centre;
  double size;  // largest distance of a point from the centre
  GlobalIndex element, cell;
  int home;  // the rank that has the element
  std::int8_t face, side;
  /// Place along a direction in which meshes have no order.
  double key() const { return 0.5377 * centre[0] + 0.3315 * centre[1] + 0.7751 * centre[2]; }
};
struct Answer {
  GlobalIndex element, other;
};

/// The faces of both patches that this rank has, with their places. Collective.
class PeriodicSides {
 public:
  PeriodicSides(MPI_Comm comm, const MeshBlock& block, const std::array<std::string, 2>& names)
      : comm_(comm), block_(block) {
    for (int s = 0; s < 2; ++s) {
      const auto found = std::ranges::find(block.patches, names[s]);
      if (found == block.patches.end()) throw Error("The periodic patch '{}' does not exist.", names[s]);
      patch_[s] = static_cast<int>(found - block.patches.begin());
    }
  }

  std::vector<MetSide> collect(const std::vector<BoundedCell>& bounded, GlobalIndex first_element) const {
    std::vector<MetSide> sides;
    std::vector<GlobalIndex> used;
    for (const BoundedCell& b : bounded) {
      const auto e = static_cast<Index>(b.element - first_element);
      for (std::int8_t s = 0; s < 2; ++s) {
        if (block_.element_patch[e] != patch_[s]) continue;
        sides.push_back({Vec3::Zero(), 0, b.element, b.cell, parallel::comm_rank(comm_), b.face, s});
        used.insert(used.end(), block_.element(e).begin(), block_.element(e).end());
      }
    }
    const PointNumbers numbers(used);
    const std::vector<Vec3> x =
        fetch(comm_, block_.point_shares, std::span<const Vec3>(block_.points), numbers.numbers());
    for (MetSide& side : sides) {
      const auto points = block_.element(static_cast<Index>(side.element - first_element));
      for (const GlobalIndex p : points) side.centre += x[numbers.place(p)] / double(points.size());
      for (const GlobalIndex p : points)
        side.size = std::max(side.size, (x[numbers.place(p)] - side.centre).norm());
    }
    return sides;
  }

 private:
  MPI_Comm comm_;
  const MeshBlock& block_;
  std::array<int, 2> patch_{};
};

/// From the middle of the first patch's faces to that of the second's. Collective.
Vec3 translation_of(MPI_Comm comm, const std::vector<MetSide>& sides,
                    const std::array<std::string, 2>& names) {
  std::array<Vec3, 2> sum{Vec3::Zero(), Vec3::Zero()};
  std::array<GlobalIndex, 2> count{};
  for (const MetSide& s : sides) sum[s.side] += s.centre, ++count[s.side];
  for (int s = 0; s < 2; ++s) {
    count[s] = parallel::sum(comm, count[s]);
    for (int a = 0; a < 3; ++a) sum[s][a] = parallel::sum(comm, sum[s][a]);
  }
  if (count[0] != count[1] || count[0] == 0)
    throw Error(
        "The periodic patches '{}' and '{}' have {} and {} faces. Mesh both identically (gmsh: Periodic "
        "Curve or Periodic Surface).",
        names[0], names[1], count[0], count[1]);
  return sum[1] / double(count[1]) - sum[0] / double(count[0]);
}

/// Even shares of a direction, from the least to the largest key of the second patch.
struct Strip {
  double low, high;
  int ranks;
  int rank_of(double key) const {
    const double share = high > low ? (key - low) / (high - low) : 0;
    return std::clamp(static_cast<int>(share * ranks), 0, ranks - 1);
  }
};

/// Sends the sides to where they meet: of the first patch, moved onto the second, to all ranks within reach. Collective.
std::vector<MetSide> send_to_meet(MPI_Comm comm, const std::vector<MetSide>& sides, const Vec3& translation) {
  Strip strip{std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest(),
              parallel::comm_size(comm)};
  for (const MetSide& s : sides)
    if (s.side == 1) strip.low = std::min(strip.low, s.key()), strip.high = std::max(strip.high, s.key());
  strip.low = parallel::min(comm, strip.low), strip.high = parallel::max(comm, strip.high);
  struct Sent {
    MetSide side;
    int to;
  };
  std::vector<Sent> sent;
  for (MetSide s : sides) {
    if (s.side == 0) s.centre += translation;
    const double reach = s.side == 0 ? periodic_tolerance * s.size : 0;
    for (int r = strip.rank_of(s.key() - reach); r <= strip.rank_of(s.key() + reach); ++r)
      sent.push_back({s, r});
  }
  const auto come =
      parallel::exchange(comm, parallel::sort_by_rank(comm, sent, [](const Sent& s) { return s.to; }));
  std::vector<MetSide> here;
  for (const Sent& s : come.items) here.push_back(s.side);
  return here;
}

/// Of the sides that have come here: who belongs to whom, told to the homes of both. Collective.
std::vector<Answer> meet(MPI_Comm comm, std::vector<MetSide> here) {
  struct Told {
    Answer answer;
    int to;
  };
  std::ranges::sort(here, {}, [](const MetSide& s) { return std::tuple(s.side, s.key(), s.element); });
  const auto second = std::ranges::find(here, 1, &MetSide::side);
  std::vector<char> taken(here.size(), 0);
  std::vector<Told> told;
  for (auto a = here.begin(); a != second; ++a) {
    const double reach = periodic_tolerance * a->size;
    auto b = std::lower_bound(second, here.end(), a->key() - reach,
                              [](const MetSide& s, double key) { return s.key() < key; });
    for (; b != here.end() && b->key() <= a->key() + reach; ++b) {
      if (taken[b - here.begin()] != 0 || (b->centre - a->centre).norm() > reach) continue;
      taken[b - here.begin()] = 1;
      told.push_back({{a->element, b->cell}, a->home});
      told.push_back({{b->element, a->cell}, b->home});
      break;
    }
  }
  const auto come =
      parallel::exchange(comm, parallel::sort_by_rank(comm, told, [](const Told& t) { return t.to; }));
  std::vector<Answer> answers;
  for (const Told& t : come.items) answers.push_back(t.answer);
  std::ranges::sort(answers, {}, &Answer::element);
  return answers;
}

}  // namespace

PeriodicFaces find_periodic_faces(MPI_Comm comm, const MeshBlock& block,
                                  const std::vector<BoundedCell>& bounded, GlobalIndex first_element) {
  PeriodicFaces found;
  for (std::size_t pair = 0; pair < block.periodic.size(); ++pair) {
    const auto& names = block.periodic[pair];
    const std::vector<MetSide> sides = PeriodicSides(comm, block, names).collect(bounded, first_element);
    const Vec3 translation = translation_of(comm, sides, names);
    const std::vector<Answer> answers = meet(comm, send_to_meet(comm, sides, translation));
    on_all(comm, [&] {
      for (const MetSide& s : sides) {
        const auto answer = std::ranges::lower_bound(answers, s.element, {}, &Answer::element);
        if (answer != answers.end() && answer->element == s.element) {
          found.joined.push_back({s.element, s.cell, answer->other, s.face, s.side, static_cast<int>(pair)});
        } else if (s.side == 0) {
          throw Error(
              "The face at {} of the periodic patch '{}' has no match on '{}' at {}. The patches must be "
              "translated copies of each other.",
              place(s.centre, block.dim), names[0], names[1], place(s.centre + translation, block.dim));
        }
      }
    });
    found.translation.push_back(translation);
  }
  std::ranges::sort(found.joined, {}, &JoinedFace::element);
  return found;
}

}  // namespace couplet::mesh
