// SPDX-License-Identifier: Apache-2.0
#include "coupler/mapping/links.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/coupling/step_plan.hpp"
#include "common/parallel/collective.hpp"
#include "coupler/mapping/sparse_map.hpp"

namespace couplet::coupler {
namespace {

using Datum = coupling::Interface::Datum;
using Place = coupling::Interface::Place;

struct DatumSource {
  std::size_t giver;
  const Datum* datum;
};

/// True for data that a participant stores with the coupler between passes, as a part of the unknown.
bool is_own(const Datum& datum) { return datum.name.starts_with("own-"); }

/// Participants other than `taker` that give `wanted`; for own data the taker itself.
std::vector<DatumSource> sources_of(const Datum& wanted, std::size_t taker, const std::vector<Side>& sides) {
  std::vector<DatumSource> found;
  std::vector<std::string> all;
  for (std::size_t g = 0; g < sides.size(); ++g) {
    if ((g == taker) != is_own(wanted)) continue;
    for (const Datum& datum : sides[g].interface.gives)
      all.push_back("'" + datum.name + "' by '" + sides[g].name + "'");
    if (const Datum* datum = find_datum(sides[g].interface.gives, wanted.name)) found.push_back({g, datum});
  }
  if (found.empty())
    throw Error("'{}' takes '{}', but no participant gives it. Data available: {}.", sides[taker].name,
                wanted.name, all.empty() ? "none" : base::join(all));
  return found;
}

void check_same(const Datum& wanted, const Side& taker, const Datum& given, const Side& giver) {
  if (wanted.unit != given.unit)
    throw Error("'{}' takes '{}' in {}, but '{}' gives it in {}.", taker.name, wanted.name, wanted.unit,
                giver.name, given.unit);
  const int n = wanted.size(taker.interface.dim), m = given.size(giver.interface.dim);
  if (n != m)
    throw Error("'{}' takes '{}' with {} components, but '{}' gives it with {}.", taker.name, wanted.name, n,
                giver.name, m);
}

PointSet part_of(const PointSet& set, const std::vector<std::size_t>& choice, std::size_t chosen) {
  PointSet part{set.what, {}, {}, set.surface, {}, {}, set.starts, set.place, set.own_surface};
  for (std::size_t i = 0; i < set.points.size(); ++i) {
    if (choice[i] != chosen) continue;
    part.points.push_back(set.points[i]);
    part.positions.push_back(set.positions[i]);
    part.ids.push_back(set.ids[i]);
    if (!set.sizes.empty()) part.sizes.push_back(set.sizes[i]);
  }
  return part;
}

/// Nearest of `others` for each place of `set`. If two are equally near, `problem` describes it.
/// that is `problem`'s text.
std::vector<std::size_t> nearest_of(MPI_Comm comm, const PointSet& set, const std::vector<PointSet>& others,
                                    const std::string& problem) {
  if (others.size() == 1) return std::vector<std::size_t>(set.points.size(), 0);
  std::vector<std::size_t> choice(set.points.size(), 0);
  std::vector<double> least(set.points.size(), std::numeric_limits<double>::infinity()), second = least;
  for (std::size_t k = 0; k < others.size(); ++k) {
    const std::vector<Neighbour> found = nearest(comm, set.points, others[k]);
    for (std::size_t i = 0; i < found.size(); ++i) {
      const double d = found[i].distance;
      if (d < least[i])
        second[i] = least[i], least[i] = d, choice[i] = k;
      else
        second[i] = std::min(second[i], d);
    }
  }
  bool unclear = false;
  for (std::size_t i = 0; i < set.points.size(); ++i) unclear = unclear || !(second[i] > 1.5 * least[i]);
  // A single corner shared by two bodies is accepted, but not if all places are.
  const GlobalIndex doubtful = parallel::sum(comm, GlobalIndex(unclear));
  if (doubtful > 0) throw Error("{}", problem);
  return choice;
}

std::vector<std::size_t> takers_of(const Datum& datum, const std::vector<Side>& sides) {
  std::vector<std::size_t> list;
  for (std::size_t t = 0; t < sides.size(); ++t)
    if (find_datum(sides[t].interface.takes, datum.name)) list.push_back(t);
  return list;
}

/// Places of giver `g` whose nearest taker is `t`, because an amount goes to one taker.
PointSet share_of(MPI_Comm comm, const PointSet& places, const Datum& given, std::size_t g, std::size_t t,
                  const std::vector<std::size_t>& takers, const std::vector<Side>& sides) {
  std::vector<PointSet> theirs;
  std::size_t here = 0;
  for (const std::size_t other : takers) {
    if (other == t) here = theirs.size();
    theirs.push_back(sides[other].places_taken(*find_datum(sides[other].interface.takes, given.name)));
  }
  const auto taker_of = nearest_of(
      comm, places, theirs,
      fmt::format("'{}' and '{}' both take '{}' of '{}' at the same location: it would count twice.",
                  sides[takers[0]].name, sides[takers[1]].name, given.name, sides[g].name));
  return part_of(places, taker_of, here);
}

double sum_of(MPI_Comm comm, const std::vector<double>& values, int components, int component) {
  double total = 0;
  for (std::size_t i = std::size_t(component); i < values.size(); i += std::size_t(components))
    total += values[i];
  return parallel::sum(comm, total);
}

/// True if two data can use one map: both loads, motions, other amounts, or none of these.
bool of_one_kind(const Datum& a, const Datum& b) {
  const auto kind = [](const Datum& d) {
    return d.unit == "m" || d.unit == "m/s" ? 'm' : d.unit == "N" ? 'N' : coupling::is_amount(d) ? 'a' : ' ';
  };
  return kind(a) == kind(b) && a.components == b.components;
}

/// True if a side moves in response to its input: it takes a force and gives a displacement.
bool is_structure(const coupling::Interface& i) {
  return std::ranges::any_of(i.takes,
                             [&](const Datum& d) { return d.unit == "N" && d.size(i.dim) == i.dim; }) &&
         std::ranges::any_of(i.gives,
                             [&](const Datum& d) { return d.unit == "m" && d.size(i.dim) == i.dim; });
}

/// Maps for motion and load of one wall, one per structure and surface that it moves.
class WallMaps {
 public:
  WallMaps(MPI_Comm comm, const std::vector<Side>& sides, MappingParameters::Type type)
      : comm_(comm), sides_(sides), type_(type) {}

  /// Map of a datum that is motion or load of a wall, if maps are of second order.
  std::shared_ptr<const Mapping> of(std::size_t giver, std::size_t taker, const Datum& given,
                                    const PointSet& from, const PointSet& to) {
    const bool load = given.unit == "N", motion = given.unit == "m" || given.unit == "m/s";
    const std::size_t structure = load ? taker : giver, surface = load ? giver : taker;
    const coupling::Interface& body = sides_[structure].interface;
    if (type_ == MappingParameters::Type::matched || type_ == MappingParameters::Type::nearest ||
        giver == taker || from.own_surface || to.own_surface || !(load || motion) ||
        given.size(body.dim) != body.dim || !is_structure(body) || sides_[structure].faces.back() == 0 ||
        sides_[surface].faces.back() == 0)
      return nullptr;
    const ConjugateMap& map =
        maps_.try_emplace({structure, surface}, comm_, sides_[structure], sides_[surface]).first->second;
    return std::make_shared<const Mapping>(
        comm_, from, to, load ? Mapping::Kind::conservative : Mapping::Kind::consistent,
        load ? map.load(from.place, to.place) : map.motion(from.place, to.place));
  }

 private:
  MPI_Comm comm_;
  const std::vector<Side>& sides_;
  MappingParameters::Type type_;
  std::map<std::pair<std::size_t, std::size_t>, ConjugateMap> maps_;
};

/// Problem if two participants give the same datum at one place.
std::string given_twice(const std::vector<std::string>& names, const std::string& taker, const Datum& wanted,
                        const std::vector<DatumSource>& sources) {
  if (sources.size() < 2) return "";
  return fmt::format(
      "'{}' takes '{}', which both '{}' and '{}' give at the same location: only one of them may.", taker,
      wanted.name, names[sources[0].giver], names[sources[1].giver]);
}

}  // namespace

Links::Links(MPI_Comm comm, const std::vector<Side>& sides, const MappingParameters& mapping) : comm_(comm) {
  for (const Side& side : sides) {
    names_.push_back(side.name);
    check_corners(side.interface, side.name, side.vertices.back());
    entries_.push_back({side.entries(Place::vertices), side.entries(Place::faces)});
  }
  WallMaps walls(comm, sides, mapping.type);
  for (std::size_t t = 0; t < sides.size(); ++t)
    for (const Datum& wanted : sides[t].interface.takes) {
      const std::vector<DatumSource> sources = sources_of(wanted, t, sides);
      const PointSet to = sides[t].places_taken(wanted);
      std::vector<PointSet> from;
      for (const auto& [g, given] : sources) {
        check_same(wanted, sides[t], *given, sides[g]);
        from.push_back(sides[g].places_given(*given));
      }
      const auto giver_of = nearest_of(comm, to, from, given_twice(names_, names_[t], wanted, sources));
      for (std::size_t s = 0; s < sources.size(); ++s) {
        const auto& [g, given] = sources[s];
        PointSet mine = from[s];
        const auto takers = is_own(wanted) ? std::vector<std::size_t>{t} : takers_of(*given, sides);
        if (coupling::is_amount(*given) && takers.size() > 1)
          mine = share_of(comm, mine, *given, g, t, takers, sides);
        const bool own = to.own_surface || mine.own_surface;
        const bool whole = sources.size() == 1 && !own && !(coupling::is_amount(*given) && takers.size() > 1);
        const auto same = std::ranges::find_if(links_, [&, g = g, given = given](const Link& l) {
          return whole && l.whole && l.giver == g && l.taker == t && l.datum.place == given->place &&
                 l.to == wanted.place && of_one_kind(l.datum, *given);
        });
        const int components = given->size(sides[g].interface.dim);
        if (same != links_.end()) {
          const auto known = same->mapping;  // the vector may move
          links_.push_back({g, t, *given, components, wanted.place, known, whole});
          continue;
        }
        const auto kind =
            coupling::is_amount(*given) ? Mapping::Kind::conservative : Mapping::Kind::consistent;
        const PointSet theirs = part_of(to, giver_of, s);
        auto map = own ? nullptr : walls.of(g, t, *given, mine, theirs);
        if (!map)
          map = std::make_shared<const Mapping>(comm, kind, mine, theirs,
                                                is_own(wanted) ? MappingParameters{} : mapping);
        links_.push_back({g, t, *given, components, wanted.place, std::move(map), whole});
        if (!is_own(wanted)) notes_.push_back(given->name + ": " + links_.back().mapping->summary());
      }
    }
  for (Link& link : links_)
    link.within = sides[link.taker].surfaces.within.contains(link.datum.name) &&
                  std::ranges::count_if(links_, [&](const Link& l) {
                    return l.taker == link.taker && l.datum.name == link.datum.name;
                  }) == 1;
  for (const Side& side : sides)
    for (const Datum& datum : side.interface.gives)
      if (takers_of(datum, sides).empty())
        notes_.push_back(fmt::format("note: no participant takes '{}' of '{}'", datum.name, side.name));
}

std::vector<double> Links::carried(const Link& link, const std::string& name,
                                   const std::vector<double>& values) const {
  const std::size_t places = entries_[link.giver][link.datum.place == Place::vertices ? 0 : 1];
  if (values.size() != places * std::size_t(link.components))
    throw Error("'{}' gave {} values of '{}', but announced {} locations of {} components.",
                names_[link.giver], values.size(), name, places, link.components);
  return link.mapping->apply(values, link.components);
}

coupling::Exchange Links::input(std::size_t taker, const std::vector<coupling::Exchange>& given) const {
  coupling::Exchange data;
  for (const Link& link : links_) {
    if (link.taker != taker) continue;
    const auto found = given[link.giver].find(link.datum.name);
    if (found == given[link.giver].end()) continue;
    std::vector<double> values = carried(link, found->first, found->second);
    // Places with another giver received nothing.
    std::vector<double>& all = data[link.datum.name];
    if (all.empty())
      all = std::move(values);
    else
      for (std::size_t i = 0; i < values.size(); ++i) all[i] += values[i];
    if (link.within)
      coupling::for_within(given[link.giver], link.datum.name,
                           [&](double, const std::string& name, const std::vector<double>& then) {
                             data[name] = carried(link, name, then);
                           });
  }
  return data;
}

std::vector<Links::Amount> Links::amounts(const std::vector<coupling::Exchange>& given) const {
  std::vector<Amount> result;
  for (const Link& link : links_) {
    const auto found = given[link.giver].find(link.datum.name);
    if (!coupling::is_amount(link.datum) || found == given[link.giver].end()) continue;
    const std::vector<double> taken = carried(link, found->first, found->second);
    for (int c = 0; c < link.components; ++c) {
      const std::string what = link.datum.name +
                               (link.components > 1 ? std::string(" ") + "xyz"[c % 3] : std::string()) +
                               " [" + link.datum.unit + "]";
      result.push_back({names_[link.giver] + " gives " + what,
                        sum_of(comm_, given[link.giver].at(link.datum.name), link.components, c)});
      result.push_back({names_[link.taker] + " takes " + what, sum_of(comm_, taken, link.components, c)});
    }
  }
  return result;
}

}  // namespace couplet::coupler
