// SPDX-License-Identifier: Apache-2.0
#include "common/config/section.hpp"

#include <exception>
#include <stdexcept>

#include "common/base/text.hpp"
#include "common/base/units.hpp"
#include "common/config/visitor.hpp"

namespace couplet::config {
namespace {

// A wrong declaration is a bug in the program: it shows at once, in every build, whatever the YAML says.
std::string_view kebab(std::string_view name) {
  if (!base::is_kebab_case(name))
    throw std::logic_error("config key '" + std::string(name) + "' is not kebab-case");
  return name;
}

Key slot_key(Visitor& visitor, std::string_view name, const Slot& slot) {
  return Key(visitor, name, [slot](Visitor& v, const Key::Facts& facts) { v.key(facts, slot); });
}

}  // namespace

Key::Key(Visitor& visitor, std::string_view name, Target target)
    : visitor_(visitor), target_(std::move(target)) {
  facts_.name = kebab(name);
}

Key::~Key() noexcept(false) {
  if (std::uncaught_exceptions() == 0) target_(visitor_, facts_);
}

Key& Key::unit(std::string_view si_unit) {
  base::parse_unit(si_unit);
  facts_.unit = si_unit;
  return *this;
}
Key& Key::required() {
  facts_.required = true;
  return *this;
}
Key& Key::range(double lowest, double highest) {
  facts_.lowest = lowest;
  facts_.highest = highest;
  return *this;
}
Key& Key::positive() {
  facts_.lowest = 0;
  facts_.open_lowest = true;
  return *this;
}
Key& Key::not_negative() {
  facts_.lowest = 0;
  return *this;
}
Key& Key::size(std::size_t n) {
  facts_.size = n;
  return *this;
}
Key& Key::plausible(double lowest, double highest) {
  facts_.plausible.emplace(lowest, highest);
  return *this;
}
Key& Key::any_magnitude(std::string_view reason) {
  facts_.any_magnitude = reason;
  return *this;
}
Key& Key::doc(std::string_view text) {
  facts_.doc = text;
  return *this;
}

Key Section::value_of(std::string_view name, const Slot& slot) { return slot_key(visitor_, name, slot); }

Key Section::choice_by_name(std::string_view name, const std::vector<std::string>& words,
                            const std::string& current, std::function<void(const std::string&)> set) {
  return slot_key(visitor_, name, Word{words, current, std::move(set)});
}

void Section::section(std::string_view name, const Declare& declare, std::string_view doc) {
  visitor_.section(kebab(name), doc, declare);
}
void Section::optional_by_name(std::string_view name, bool present, std::string_view doc,
                               const Declare& declare) {
  visitor_.optional(kebab(name), present, doc, declare);
}
void Section::map_by_name(std::string_view name, const std::vector<std::string>& present,
                          std::string_view what, std::string_view doc,
                          const std::function<void(const std::string&, Section&)>& declare) {
  visitor_.map(kebab(name), present, what, doc, declare);
}
void Section::list_by_name(std::string_view name, std::size_t present, std::string_view doc,
                           const std::function<void(std::size_t, Section&)>& declare) {
  visitor_.list(kebab(name), present, doc, declare);
}
void Section::variant_by_name(std::string_view name,
                              const std::vector<std::pair<std::string, Declare>>& cases,
                              const std::string& current, bool required, std::string_view doc,
                              std::function<void(const std::string&)> set) {
  Key::Facts facts;
  facts.name = kebab(name);
  facts.doc = doc;
  facts.required = required || current.empty();
  visitor_.variant(facts, cases, current, set);
}
void Section::doubt(const std::function<std::string()>& rule, std::string_view key) {
  visitor_.doubt(rule, key);
}
void Section::check(const std::function<std::string()>& rule, std::string_view key) {
  visitor_.check(rule, key);
}

}  // namespace couplet::config
