// SPDX-License-Identifier: Apache-2.0
#include "coupler/links.hpp"

#include <algorithm>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "coupler/map_projection.hpp"

namespace couplet {
namespace {

using Datum = Interface::Datum;
using Place = Interface::Place;

bool is_amount(const Datum& datum) { return datum.unit == "N" || datum.unit == "W"; }

PointSet places(const Side& side, Place place) {
  const Interface& i = side.interface;
  PointSet set{(place == Place::vertices ? "vertices of '" : "faces of '") + side.name + "'",
               place == Place::vertices ? i.vertices : i.face_centres,
               {},
               place == Place::vertices || !i.face_areas.empty() ? &i : nullptr};
  if (place == Place::faces)
    for (const Vec3& area : i.face_areas) set.sizes.push_back(area.norm());
  return set;
}

struct Source {
  std::size_t giver;
  const Datum* datum;
};

/// The one participant other than `taker` that gives `wanted`.
Source source_of(const Datum& wanted, std::size_t taker, const std::vector<Side>& sides) {
  std::vector<Source> found;
  std::vector<std::string> all;
  for (std::size_t g = 0; g < sides.size(); ++g) {
    if (g == taker) continue;
    for (const Datum& datum : sides[g].interface.gives) {
      all.push_back("'" + datum.name + "' by '" + sides[g].name + "'");
      if (datum.name == wanted.name) found.push_back({g, &datum});
    }
  }
  const std::string& name = sides[taker].name;
  if (found.empty())
    throw Error("'{}' takes '{}', which nobody gives. Given are: {}.", name, wanted.name,
                all.empty() ? "no data at all" : join(all));
  if (found.size() > 1)
    throw Error("'{}' takes '{}', which both '{}' and '{}' give: only one of them may.", name, wanted.name,
                sides[found[0].giver].name, sides[found[1].giver].name);
  return found.front();
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

double sum(const std::vector<double>& values, int components, int component) {
  double total = 0;
  for (std::size_t i = std::size_t(component); i < values.size(); i += std::size_t(components))
    total += values[i];
  return total;
}

}  // namespace

Links::Links(const std::vector<Side>& sides, const MappingParameters& mapping) {
  for (const Side& side : sides) {
    names_.push_back(side.name);
    check_corners(side.interface, side.name);
  }
  for (std::size_t t = 0; t < sides.size(); ++t)
    for (const Datum& wanted : sides[t].interface.takes) {
      const auto [g, given] = source_of(wanted, t, sides);
      check_same(wanted, sides[t], *given, sides[g]);
      const auto kind = is_amount(*given) ? Mapping::Kind::conservative : Mapping::Kind::consistent;
      links_.push_back(
          {g, t, *given, given->size(sides[g].interface.dim),
           Mapping(kind, places(sides[g], given->place), places(sides[t], wanted.place), mapping)});
      notes_.push_back(given->name + ": " + links_.back().mapping.summary());
    }
}

std::vector<double> Links::carried(const Link& link, const std::vector<Exchange>& given) const {
  const auto found = given[link.giver].find(link.datum.name);
  if (found == given[link.giver].end()) return {};
  if (found->second.size() != link.mapping.n_from() * std::size_t(link.components))
    throw Error("'{}' gave {} values of '{}' where its {} places of {} components had been announced.",
                names_[link.giver], found->second.size(), link.datum.name, link.mapping.n_from(),
                link.components);
  return link.mapping.apply(found->second, link.components);
}

Exchange Links::input(std::size_t taker, const std::vector<Exchange>& given) const {
  Exchange data;
  for (const Link& link : links_) {
    if (link.taker != taker) continue;
    std::vector<double> values = carried(link, given);
    if (!values.empty()) data[link.datum.name] = std::move(values);
  }
  return data;
}

std::vector<std::string> Links::given_by(std::size_t giver) const {
  std::vector<std::string> names;
  for (const Link& link : links_)
    if (link.giver == giver && std::ranges::find(names, link.datum.name) == names.end())
      names.push_back(link.datum.name);
  return names;
}

std::vector<Links::Amount> Links::amounts(const std::vector<Exchange>& given) const {
  std::vector<Amount> result;
  for (const Link& link : links_) {
    if (!is_amount(link.datum)) continue;
    const std::vector<double> taken = carried(link, given);
    if (taken.empty()) continue;
    for (int c = 0; c < link.components; ++c) {
      const std::string what = link.datum.name +
                               (link.components > 1 ? std::string(" ") + "xyz"[c % 3] : std::string()) +
                               " [" + link.datum.unit + "]";
      result.push_back({names_[link.giver] + " gives " + what,
                        sum(given[link.giver].at(link.datum.name), link.components, c)});
      result.push_back({names_[link.taker] + " takes " + what, sum(taken, link.components, c)});
    }
  }
  return result;
}

}  // namespace couplet
