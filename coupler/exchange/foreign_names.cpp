// SPDX-License-Identifier: Apache-2.0
#include "coupler/exchange/foreign_names.hpp"

#include <algorithm>

#include "common/base/error.hpp"
#include "common/base/text.hpp"

namespace couplet::coupler {

using Datum = coupling::Interface::Datum;

std::vector<Datum>::iterator ForeignNames::find(const std::string& name) const {
  return std::ranges::find(data, name, &Datum::name);
}

void ForeignNames::rename(Datum& datum, const std::string& name) const {
  if (auto node = surface_of.extract(datum.name); !node.empty()) {
    node.key() = name;
    surface_of.insert(std::move(node));
  }
  datum.name = name;
}

void ForeignNames::put_beside(const std::string& datum, const std::string& name) const {
  if (const auto surface = surface_of.find(datum); surface != surface_of.end())
    surface_of[name] = surface->second;
}

void ForeignNames::refuse(const char* key, const std::string& wanted) const {
  std::vector<std::string> all;
  for (const Datum& d : data)
    all.push_back(fmt::format("'{}' [{}] at {}", d.name, d.unit,
                              d.place == coupling::Interface::Place::vertices ? "vertices" : "faces"));
  throw Error("coupling.{}.{}: '{}' {} no {}. It {}: {}.", role, key, who, does, wanted, does,
              all.empty() ? "nothing" : base::join(all));
}

}  // namespace couplet::coupler
