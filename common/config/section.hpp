// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "common/base/types.hpp"

namespace couplet::config {

class Section;

/// Properties of a key, and name and documentation of other declarations.
struct KeyFacts {
  std::string name{}, unit{}, doc{};
  bool required = false;
  double lowest = -std::numeric_limits<double>::infinity();
  double highest = std::numeric_limits<double>::infinity();
  bool open_lowest = false;
  std::optional<std::size_t> size{};
  std::optional<std::pair<double, double>> plausible{};  ///< of magnitudes
  std::string any_magnitude{};                           ///< reason
  bool contain(double value) const {
    return (open_lowest ? value > lowest : value >= lowest) && value <= highest;
  }
};

/// Text "above 0 Pa", "from 0 to 0.5", "at most 3". Empty without limits.
std::string describe_range(const KeyFacts& facts);

/// Number, expression in x, y, z, t (muParser syntax) or table as text. See fv/expression.hpp for evaluation,
/// fv/table.hpp for tables.
struct ExpressionText {
  std::string text = "0";
  KeyFacts key{};  ///< unit and range of the values
};

/// Word of a fixed list, as seen by a visitor.
struct Word {
  std::vector<std::string> words;
  std::string current;  ///< empty if the member holds none of them
  std::function<void(const std::string&)> set;
};
/// Member that a key fills, as seen by the visitors.
using Slot = std::variant<double*, int*, bool*, std::string*, ExpressionText*, Vec3*, std::vector<double>*,
                          std::vector<std::string>*, std::vector<ExpressionText>*, std::optional<double>*,
                          std::optional<std::string>*, std::optional<ExpressionText>*,
                          std::map<std::string, double>*, Word>;

/// Declaration that a Section passes to its visitor.
struct Declaration {
  enum class Kind { key, section, optional, map, list, variant, check, doubt } kind;
  KeyFacts facts{};  ///< of a rule: name of the key that its message refers to
  /// Member that a key fills, or the words of a variant.
  Slot slot = static_cast<double*>(nullptr);
  std::string what{};                  ///< of a map: kind of its names
  std::vector<std::string> present{};  ///< current entries of a map, list (without names) or optional
  /// Declares the contents of entry `name` of a map or `i` of a list.
  std::function<void(Section&, const std::string& name, std::size_t i)> declare{};
  std::vector<std::pair<std::string, std::function<void(Section&)>>> cases{};  ///< of a variant
  std::function<std::string()> rule{};
};

/// Processes declarations: reads and validates a YAML node, writes the Markdown reference or JSON schema, or
/// prints the effective values. See load.hpp.
using Visitor = std::function<void(const Declaration&)>;

/// Range and documentation of one key, chained to its declaration: s.value("youngs-modulus",
/// p.youngs_modulus).unit("Pa").positive().required().doc("Young's modulus"); The default of an optional key
/// is the current value of its target. The declaration takes effect when the Key is destroyed, at the end of
/// the statement.
class Key {
 public:
  /// Accepts "5.6 MPa", "0.1 s" and plain numbers in this SI unit, but no plain numbers in K or rad
  /// (base::needs_unit). "K difference" is the unit of a temperature difference.
  Key& unit(std::string_view si_unit);
  /// The same with usual magnitudes. A value outside gives a warning; 0 is accepted wherever the key allows it.
  Key& unit(std::string_view si_unit, double lowest, double highest);
  Key& required();
  Key& range(double lowest, double highest);  ///< inclusive
  Key& positive();                            ///< > 0
  Key& not_negative();                        ///< >= 0
  Key& size(std::size_t n);                   ///< of a list of numbers
  /// States why a key with a unit has no usual magnitudes.
  Key& any_magnitude(std::string_view reason);
  Key& doc(std::string_view text);

  using Facts = KeyFacts;
  Key(const Visitor& visitor, std::string_view name, const Slot& slot);
  ~Key() noexcept(false);
  Key(const Key&) = delete;

 private:
  const Visitor& visitor_;
  Declaration declaration_;
};

/// Mapping of the YAML file. Parameters are declared once, bound to the members they fill:
///
///   void declare(config::Section& s, SolidParameters& p) {
///     s.value("density", p.density).unit("kg/m^3").positive().required().doc("density");
///     s.choice("analysis", p.analysis, {{"static", Analysis::steady}, {"dynamic", Analysis::dynamic}}).doc("...");
///     s.section("output", [&](config::Section& o) { declare(o, p.output); }, "output settings");
///     s.map("boundaries", p.boundaries, [](config::Section& b, Boundary& v) { declare(b, v); }, "patch", "...");
///     s.check([&] { return p.a < p.b ? "" : "'a' must be below 'b'"; }, "a");
///   }
///
/// Names are kebab-case (asserted). Unknown and duplicate keys and wrong types, units and ranges are
/// collected with file:line:column and reported together.
class Section {
 public:
  /// Keeps a reference to `visitor`.
  explicit Section(const Visitor& visitor) : visitor_(visitor) {}
  Section(const Section&) = delete;

  /// Declares a key that fills `target`, a member of one of Slot's types: number, word, expression, Vec3 (a
  /// list of 2 or 3 numbers) or list. std::optional stays empty if the key is absent. std::map holds numbers
  /// under names chosen by the user, e.g. {nr: 16, nz: 8}.
  template <class T>
  requires std::constructible_from<Slot, T*> Key value(std::string_view name, T& target) {
    return Key(visitor_, name, &target);
  }

  /// Declares a key whose value is a word of a fixed list.
  template <class E>
  Key choice(std::string_view name, E& target, const std::vector<std::pair<std::string, E>>& words) {
    Word slot;
    for (const auto& [word, value] : words) {
      slot.words.push_back(word);
      if (value == target) slot.current = word;
    }
    slot.set = [&target, words](const std::string& word) {
      for (const auto& [w, value] : words)
        if (w == word) target = value;
    };
    return Key(visitor_, name, slot);
  }

  using Declare = std::function<void(Section&)>;
  /// Declares a mapping below this one. If it is absent, defaults apply and its required keys are reported as
  /// missing.
  void section(std::string_view name, const Declare& declare, std::string_view doc);
  /// Declares an optional mapping, such as an effect.
  template <class T>
  void optional_section(std::string_view name, std::optional<T>& target,
                        const std::function<void(Section&, T&)>& declare, std::string_view doc) {
    Declaration d = named(Declaration::Kind::optional, name, doc);
    if (target) d.present.emplace_back();
    d.declare = [&target, declare](Section& s, const std::string&, std::size_t) {
      if (!target) target.emplace();
      declare(s, *target);
    };
    visitor_(d);
  }
  /// Declares a mapping with names chosen by the user, e.g. one entry per patch. `what` is the kind of name,
  /// for messages.
  template <class T>
  void map(std::string_view name, std::map<std::string, T>& target,
           const std::function<void(Section&, T&)>& declare, std::string_view what, std::string_view doc) {
    Declaration d = named(Declaration::Kind::map, name, doc);
    d.what = what;
    for (const auto& [key, value] : target) d.present.push_back(key);
    d.declare = [&target, declare](Section& s, const std::string& key, std::size_t) {
      declare(s, target[key]);
    };
    visitor_(d);
  }
  /// Declares a sequence of mappings.
  template <class T>
  void list(std::string_view name, std::vector<T>& target, const std::function<void(Section&, T&)>& declare,
            std::string_view doc) {
    Declaration d = named(Declaration::Kind::list, name, doc);
    d.present.resize(target.size());
    d.declare = [&target, declare](Section& s, const std::string&, std::size_t i) {
      if (target.size() <= i) target.resize(i + 1);
      declare(s, target[i]);
    };
    visitor_(d);
  }
  /// Declares a key `name` whose word selects further valid keys of this mapping, e.g. type: inlet | outlet |
  /// wall. If it is absent, `target` keeps its value, unless it is `required`.
  template <class E>
  void variant(std::string_view name, E& target,
               const std::vector<std::tuple<std::string, E, Declare>>& cases, std::string_view doc,
               bool required = false) {
    Declaration d = named(Declaration::Kind::variant, name, doc);
    Word slot;
    for (const auto& [word, value, declare] : cases) {
      d.cases.emplace_back(word, declare);
      slot.words.push_back(word);
      if (value == target) slot.current = word;
    }
    slot.set = [&target, cases](const std::string& word) {
      for (const auto& [w, value, declare] : cases)
        if (w == word) target = value;
    };
    d.facts.required = required || slot.current.empty();
    d.slot = slot;
    visitor_(d);
  }
  /// Declares a rule across keys that have been declared before. It is applied at once, unless this section has errors or a
  /// surrounding section has an invalid key. An empty text means success; `key` is the key that the message names.
  void check(const std::function<std::string()>& rule, std::string_view key);
  /// Declares a rule for implausible values, which gives a warning.
  void doubt(const std::function<std::string()>& rule, std::string_view key);

 private:
  static Declaration named(Declaration::Kind kind, std::string_view name, std::string_view doc);
  const Visitor& visitor_;
};

/// Helper for std::visit with one lambda per type.
template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

}  // namespace couplet::config
