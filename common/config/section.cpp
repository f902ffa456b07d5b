// SPDX-License-Identifier: Apache-2.0
#include "common/config/section.hpp"

#include <exception>
#include <stdexcept>

#include "common/base/text.hpp"
#include "common/base/units.hpp"

namespace couplet::config {

namespace {

// An invalid declaration is a bug in the program. It fails at once, in every build and for every YAML.
std::string_view kebab(std::string_view name) {
  if (!base::is_kebab_case(name))
    throw std::logic_error("config key '" + std::string(name) + "' is not kebab-case");
  return name;
}

}  // namespace

Key::Key(const Visitor& visitor, std::string_view name, const Slot& slot)
    : visitor_(visitor), declaration_{.kind = Declaration::Kind::key, .slot = slot} {
  declaration_.facts.name = kebab(name);
}

Key::~Key() noexcept(false) {
  if (std::uncaught_exceptions() == 0) visitor_(declaration_);
}

Key& Key::unit(std::string_view si_unit) {
  base::parse_unit(si_unit);
  declaration_.facts.unit = si_unit;
  if (si_unit == "K") declaration_.facts.lowest = 0;
  return *this;
}
Key& Key::required() {
  declaration_.facts.required = true;
  return *this;
}
Key& Key::range(double lowest, double highest) {
  declaration_.facts.lowest = lowest;
  declaration_.facts.highest = highest;
  return *this;
}
Key& Key::positive() {
  declaration_.facts.lowest = 0;
  declaration_.facts.open_lowest = true;
  return *this;
}
Key& Key::not_negative() {
  declaration_.facts.lowest = 0;
  return *this;
}
Key& Key::size(std::size_t n) {
  declaration_.facts.size = n;
  return *this;
}
Key& Key::unit(std::string_view si_unit, double lowest, double highest) {
  declaration_.facts.plausible.emplace(lowest, highest);
  return unit(si_unit);
}
Key& Key::any_magnitude(std::string_view reason) {
  declaration_.facts.any_magnitude = reason;
  return *this;
}
Key& Key::doc(std::string_view text) {
  declaration_.facts.doc = text;
  return *this;
}

Declaration Section::named(Declaration::Kind kind, std::string_view name, std::string_view doc) {
  Declaration declaration{.kind = kind};
  declaration.facts.name = kebab(name);
  declaration.facts.doc = doc;
  return declaration;
}

void Section::section(std::string_view name, const Declare& declare, std::string_view doc) {
  Declaration d = named(Declaration::Kind::section, name, doc);
  d.declare = [&declare](Section& s, const std::string&, std::size_t) { declare(s); };
  visitor_(d);
}

void Section::check(const std::function<std::string()>& rule, std::string_view key) {
  Declaration d{.kind = Declaration::Kind::check, .rule = rule};
  d.facts.name = key;
  visitor_(d);
}

void Section::doubt(const std::function<std::string()>& rule, std::string_view key) {
  Declaration d{.kind = Declaration::Kind::doubt, .rule = rule};
  d.facts.name = key;
  visitor_(d);
}

}  // namespace couplet::config
