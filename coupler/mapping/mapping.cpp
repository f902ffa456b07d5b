// SPDX-License-Identifier: Apache-2.0
#include "coupler/mapping/links.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"
#include "coupler/exchange/transfer.hpp"
#include "coupler/mapping/face_weights.hpp"
#include "coupler/mapping/sparse_map.hpp"

namespace couplet::coupler {
namespace {

using Place = coupling::Interface::Place;

GlobalIndex count(MPI_Comm comm, const PointSet& set) {
  return parallel::sum(comm, GlobalIndex(set.points.size()));
}

/// Points of `set` farther than `tolerance` from all points of `other`; the first five with position.
/// place.
std::string without_twin(MPI_Comm comm, const PointSet& set, const std::vector<Neighbour>& to_other,
                         const PointSet& other, double tolerance) {
  struct UnmatchedPoint {
    Vec3 point;
    double distance;
  };
  std::vector<UnmatchedPoint> unmatched;
  GlobalIndex all = 0;
  for (std::size_t i = 0; i < set.points.size(); ++i) {
    if (to_other[i].distance <= tolerance) continue;
    if (++all <= 5) unmatched.push_back({set.points[i], to_other[i].distance});
  }
  all = parallel::sum(comm, all);
  if (all == 0) return "";
  unmatched = parallel::all_gather(comm, unmatched);
  std::string list;
  for (std::size_t i = 0; i < std::min<std::size_t>(5, unmatched.size()); ++i)
    list += fmt::format("\n  ({:.9g}, {:.9g}, {:.9g}): the nearest is {:.3g} m away", unmatched[i].point.x(),
                        unmatched[i].point.y(), unmatched[i].point.z(), unmatched[i].distance);
  if (all > 5) list += fmt::format("\n  and {} more", all - 5);
  const GlobalIndex n = count(comm, set), m = count(comm, other);
  return fmt::format("{} of {} {} match none of the {} {} within {:.3g} m:{}", all, n, set.what, m,
                     other.what, tolerance, list);
}

void require_twins(MPI_Comm comm, const PointSet& from, const PointSet& to,
                   const std::vector<Neighbour>& forth, const std::vector<Neighbour>& back,
                   const MappingParameters& parameters) {
  const double widest = std::max(PointBox(comm, from.points).extent(), PointBox(comm, to.points).extent());
  const double tolerance = parameters.tolerance.value_or(1e-6 * widest);
  const std::string advice =
      "\nGive both meshes the same points on the interface, or set `coupling.mapping.type: projection`.";
  if (const std::string text = without_twin(comm, to, forth, from, tolerance); !text.empty())
    throw Error("{}{}", text, advice);
  if (const std::string text = without_twin(comm, from, back, to, tolerance); !text.empty())
    throw Error("{}{}", text, advice);
  if (most_followers(comm, forth, from.starts) < 2 && count(comm, from) == count(comm, to)) return;
  throw Error(
      "Ambiguous matching: several {} lie within the tolerance of {:.3g} m of each other, or match the same one of the {}. Set "
      "a smaller `coupling.mapping.tolerance`.",
      to.what, tolerance, from.what);
}

/// Distributes each source to the targets whose nearest source it is, by their size; a source without any
/// goes to its own nearest target. A finer target then receives smooth loads, and a coarser one all of them.
std::vector<Transfer::Entry> shares(MPI_Comm comm, const PointSet& from, const PointSet& to,
                                    const std::vector<Neighbour>& forth, const std::vector<Neighbour>& back) {
  std::vector<std::vector<Transfer::Entry>> by_source(std::size_t(parallel::comm_size(comm)));
  for (std::size_t i = 0; i < to.points.size(); ++i)
    by_source[std::size_t(coupling::owner_of(from.starts, forth[i].position))].push_back(
        {to.positions[i], forth[i].position, to.sizes.empty() ? 1. : to.sizes[i]});
  std::vector<Transfer::Entry> entries;
  for (const auto& part : parallel::all_to_all(comm, by_source))
    entries.insert(entries.end(), part.begin(), part.end());
  const GlobalIndex first = from.starts[std::size_t(parallel::comm_rank(comm))],
                    end = from.starts[std::size_t(parallel::comm_rank(comm)) + 1];
  std::vector<double> total(std::size_t(end - first), 0.);
  for (const auto& e : entries) total[std::size_t(e.source - first)] += e.weight;
  for (auto& e : entries) e.weight /= total[std::size_t(e.source - first)];
  for (std::size_t i = 0; i < from.points.size(); ++i)
    if (total[std::size_t(from.positions[i] - first)] == 0)
      entries.push_back({back[i].position, from.positions[i], 1});
  return entries;
}

/// Maps displacements and similar data by projection onto the other surface's faces.
std::vector<Transfer::Entry> projected(MPI_Comm comm, const PointSet& from, const PointSet& to) {
  std::vector<Transfer::Entry> entries;
  const Surroundings source(comm, *from.surface);
  if (parallel::comm_size(comm) == 1) {
    add_projection(*from.surface, source.vertices().positions, to.points, to.positions, entries);
    return entries;
  }
  std::vector<GlobalIndex> faces =
      source.faces_around(nearby(comm, to.points, {}, projection_vertices, source.vertices()).positions);
  const PointSet near = nearby(comm, to.points, {}, projection_faces, source.faces());
  faces.insert(faces.end(), near.positions.begin(), near.positions.end());
  std::ranges::sort(faces);
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  const SurfacePart part = source.with(faces);
  if (!to.points.empty()) add_projection(part.surface, part.vertices, to.points, to.positions, entries);
  return entries;
}

/// Projection, chosen by where the values lie; amounts go by the transpose of the map of a field the other way.
/// Local interpolants where a surface does not list its corners, and at faces. No rank sees more of the other
/// surface than what lies about its own part.
std::vector<Transfer::Entry> second_order(MPI_Comm comm, Mapping::Kind kind, const PointSet& from,
                                          const PointSet& to) {
  const bool amount = kind == Mapping::Kind::conservative;
  const int dim = from.surface != nullptr ? from.surface->dim : 3;
  const PointSet &wanted = amount ? from : to, &among = amount ? to : from;
  std::optional<Surroundings> known;
  if (!from.own_surface && !to.own_surface && among.surface) known.emplace(comm, *among.surface);
  const bool corners = known && known->has_corners();
  std::vector<Transfer::Entry> entries;
  if (amount && corners && wanted.place == Place::faces && wanted.surface &&
      Surroundings(comm, *wanted.surface).has_corners()) {
    entries = faces_to_faces(comm, *among.surface, *wanted.surface);
    if (among.place == Place::vertices)
      entries = product(comm, known->faces().starts, entries, vertices_to_faces(comm, *among.surface));
  } else if (among.place == Place::vertices && corners) {
    entries = projected(comm, among, wanted);
  } else {
    const std::size_t k = corners ? (dim == 2 ? 3 : 5) : (dim == 2 ? 5 : 10);
    add_interpolation(comm, among, wanted.points, wanted.positions, k, entries);
  }
  return amount ? transposed(std::move(entries)) : entries;
}

/// Without the columns of places that are not in the set, and, but for amounts, without such rows.
std::vector<Transfer::Entry> between(MPI_Comm comm, Mapping::Kind kind, const PointSet& from,
                                     const PointSet& to, std::vector<Transfer::Entry> entries) {
  const auto kept = [](const PointSet& set) {
    std::vector<Transfer::Entry> same;
    for (const GlobalIndex p : set.positions) same.push_back({p, p, 1});
    return same;
  };
  if (kind == Mapping::Kind::consistent && count(comm, to) < to.starts.back())
    entries = product(comm, to.starts, kept(to), entries);
  if (count(comm, from) < from.starts.back()) entries = product(comm, from.starts, entries, kept(from));
  return entries;
}

/// Compares what each place gives with what is taken of it. The map is linear, so this holds for all values.
void require_sums(MPI_Comm comm, const PointSet& from, const PointSet& to,
                  const std::vector<Transfer::Entry>& entries) {
  const auto rank = std::size_t(parallel::comm_rank(comm));
  const GlobalIndex first = from.starts[rank];
  std::vector<double> taken(std::size_t(from.starts[rank + 1] - first), 0.), size = taken;
  const auto add = [&](const Transfer::Entry& e) {
    taken[std::size_t(e.source - first)] += e.weight,
        size[std::size_t(e.source - first)] += std::abs(e.weight);
  };
  std::vector<Transfer::Entry> others;
  for (const auto& e : entries)
    if (e.source >= first && e.source < from.starts[rank + 1])
      add(e);
    else
      others.push_back(e);
  for (const auto& e : to_owners(comm, std::move(others), [&](const Transfer::Entry& e) {
         return coupling::owner_of(from.starts, e.source);
       }))
    add(e);
  double worst = 0;
  for (const GlobalIndex p : from.positions) {
    const auto i = std::size_t(p - first);
    worst = std::max(worst, std::abs(taken[i] - 1) / std::max(1., size[i]));
  }
  worst = parallel::max(comm, worst);
  if (!(worst < 1e-12))
    throw Error(
        "The total given by the {} would differ by {:.2g} % from the total taken by the {}. Use `coupling.mapping.type: "
        "nearest`.",
        from.what, 100 * worst, to.what);
}

void require_places(const PointSet& from, const PointSet& to, GlobalIndex n_from, GlobalIndex n_to) {
  if (n_from == 0 || n_to == 0)
    throw Error(
        "There are {} {} and {} {}, but an interface needs at least one on each side. Check which patches have `type: interface` or `conjugate: true`.",
        n_from, from.what, n_to, to.what);
}

}  // namespace

Mapping::Mapping(MPI_Comm comm, Kind kind, const PointSet& from, const PointSet& to,
                 const MappingParameters& parameters) {
  require_places(from, to, count(comm, from), count(comm, to));
  const bool matched = parameters.type == MappingParameters::Type::matched;
  const std::vector<Neighbour> forth = nearest(comm, to.points, from);
  std::vector<Neighbour> back;
  const bool by_nearest = matched || parameters.type == MappingParameters::Type::nearest;
  if (matched || (by_nearest && kind == Kind::conservative)) back = nearest(comm, from.points, to);
  if (matched) require_twins(comm, from, to, forth, back, parameters);
  std::vector<Transfer::Entry> entries;
  if (!by_nearest)
    entries = second_order(comm, kind, from, to);
  else if (kind == Kind::conservative)
    entries = shares(comm, from, to, forth, back);
  else
    for (std::size_t i = 0; i < to.points.size(); ++i)
      entries.push_back({to.positions[i], forth[i].position, 1});
  set(comm, kind, from, to, std::move(entries), forth,
      kind == Kind::conservative ? back : std::vector<Neighbour>{});
}

Mapping::Mapping(MPI_Comm comm, const PointSet& from, const PointSet& to, Kind kind,
                 std::vector<Transfer::Entry> entries) {
  require_places(from, to, count(comm, from), count(comm, to));
  set(comm, kind, from, to, std::move(entries), nearest(comm, to.points, from), {});
}

void Mapping::set(MPI_Comm comm, Kind kind, const PointSet& from, const PointSet& to,
                  std::vector<Transfer::Entry> entries, const std::vector<Neighbour>& forth,
                  const std::vector<Neighbour>& back) {
  n_from_ = std::size_t(count(comm, from)), n_to_ = std::size_t(count(comm, to));
  double total = 0;
  for (const Neighbour& n : forth) max_distance_ = std::max(max_distance_, n.distance), total += n.distance;
  if (n_from_ > n_to_)
    for (const Neighbour& n : back) max_distance_ = std::max(max_distance_, n.distance);
  max_distance_ = parallel::max(comm, max_distance_);
  mean_distance_ = parallel::sum(comm, total) / double(n_to_);
  entries = between(comm, kind, from, to, std::move(entries));
  if (kind == Kind::conservative) require_sums(comm, from, to, entries);
  transfer_ = Transfer(comm, to.starts, from.starts, std::move(entries));
  summary_ = fmt::format("{} {} to {} {}: max distance {:.3g} m, mean {:.3g} m", n_from_, from.what, n_to_,
                         to.what, max_distance_, mean_distance_);
}

}  // namespace couplet::coupler
