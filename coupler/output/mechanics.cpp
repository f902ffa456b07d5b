// SPDX-License-Identifier: Apache-2.0
#include "coupler/output/mechanics.hpp"

#include <algorithm>

namespace couplet::coupler {

Mechanics::Mechanics(MPI_Comm comm, const std::vector<Side>& sides, const Links& links,
                     std::vector<std::string> labels)
    : labels_(std::move(labels)) {
  const auto has = [](const std::vector<coupling::Interface::Datum>& list) {
    return std::ranges::find(list, std::string("displacement"), &coupling::Interface::Datum::name) !=
           list.end();
  };
  for (std::size_t s = 0; s < sides.size(); ++s) {
    std::vector<coupling::Interface::Datum> loads;
    bool gives = false;
    for (const auto& link : links.all()) {
      coupling::Interface::Datum d = link.datum;
      if (d.unit != "N" || d.place != coupling::Interface::Place::faces ||
          (link.giver != s && link.taker != s))
        continue;
      gives = link.giver == s;
      if (!gives) d.place = link.to;
      if (std::ranges::find(loads, d.name, &coupling::Interface::Datum::name) == loads.end())
        loads.push_back(d);
    }
    const coupling::Interface& interface = sides[s].interface;
    if (loads.empty() || !(has(interface.takes) || has(interface.gives))) continue;
    members_.push_back({s, gives, Balancing(comm, sides[s]), loads});
    walls_.emplace_back(interface.vertices.size() * std::size_t(interface.dim), 0.);
    dim_ = interface.dim;
    const bool by_vertex = std::ranges::all_of(
        loads, [](const auto& d) { return d.place == coupling::Interface::Place::vertices; });
    knows_work_ = knows_work_ && (by_vertex || members_.back().balancing.knows_work());
  }
}

std::vector<std::string> Mechanics::labels() const {
  std::vector<std::string> list;
  for (const Member& m : members_) list.push_back(labels_[m.side]);
  return list;
}

std::vector<SideBalance> Mechanics::accepted(const std::vector<coupling::Exchange>& given,
                                             const std::vector<coupling::Exchange>& taken) {
  std::vector<SideBalance> list;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    const Member& m = members_[i];
    const coupling::Exchange& motion = given[m.side].contains("displacement") ? given[m.side] : taken[m.side];
    const auto found = motion.find("displacement");
    const std::vector<double>& now = found == motion.end() ? walls_[i] : found->second;
    std::vector<double> increment(now.size());
    for (std::size_t k = 0; k < now.size(); ++k) increment[k] = now[k] - walls_[i][k];
    list.push_back(
        {labels_[m.side], m.gives, m.balancing(m.gives ? given[m.side] : taken[m.side], m.loads, increment)});
    if (found != motion.end()) walls_[i] = found->second;
  }
  return list;
}

}  // namespace couplet::coupler
