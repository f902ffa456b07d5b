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

/// Whatever a Section does with the declarations: read and validate a YAML node, write the Markdown
/// reference, write the JSON schema, print the effective values. See load.hpp.
class Visitor;

/// Range and documentation of one key, chained onto its declaration:
///   s.value("youngs-modulus", p.youngs_modulus).unit("Pa").positive().required().doc("Young's modulus");
/// A key that is not required keeps the value its target already has: that is its default.
/// The declaration takes effect when the Key goes out of scope, i.e. at the end of the statement.
class Key {
 public:
  /// Accepts "5.6 MPa", "0.1 s" and plain numbers in this SI unit, but none in K or rad (common/base/bare_numbers.hpp).
  /// "K difference" is that of a difference of temperatures.
  Key& unit(std::string_view si_unit);
  Key& required();
  Key& range(double lowest, double highest);  ///< inclusive
  Key& positive();                            ///< > 0
  Key& not_negative();                        ///< >= 0
  Key& size(std::size_t n);                   ///< of a list of numbers
  /// Magnitudes that are usual: a value outside is flagged, not refused; 0 is usual wherever the key takes it.
  Key& plausible(double lowest, double highest);
  /// Why a key with a unit has no such range.
  Key& any_magnitude(std::string_view reason);
  Key& doc(std::string_view text);

  struct Facts {
    std::string name, unit, doc;
    bool required = false;
    double lowest = -std::numeric_limits<double>::infinity();
    double highest = std::numeric_limits<double>::infinity();
    bool open_lowest = false;
    std::optional<std::size_t> size;
    std::optional<std::pair<double, double>> plausible;  ///< of magnitudes
    std::string any_magnitude;                           ///< the reason
  };
  using Target = std::function<void(Visitor&, const Facts&)>;
  Key(Visitor& visitor, std::string_view name, Target target);
  ~Key() noexcept(false);
  Key(const Key&) = delete;

 private:
  Visitor& visitor_;
  Facts facts_;
  Target target_;
};

/// A number, an expression in x, y, z, t (muParser syntax) or a table, kept as text; see fv/expression.hpp
/// for evaluation, fv/table.hpp for tables.
struct ExpressionText {
  std::string text = "0";
};

/// A word out of a fixed list, as a visitor sees the member that holds it.
struct Word {
  std::vector<std::string> words;
  std::string current;  ///< empty if the member holds none of them
  std::function<void(const std::string&)> set;
};
/// The member a key fills, seen by the visitors.
using Slot = std::variant<double*, int*, bool*, std::string*, ExpressionText*, Vec3*, std::vector<double>*,
                          std::vector<std::string>*, std::vector<ExpressionText>*, std::optional<double>*,
                          std::optional<std::string>*, std::optional<ExpressionText>*,
                          std::map<std::string, double>*, Word>;

/// One mapping of the YAML file. Parameters are declared once, bound to the members they fill:
///
///   void declare(config::Section& s, SolidParameters& p) {
///     s.value("density", p.density).unit("kg/m^3").positive().required().doc("density");
///     s.choice("analysis", p.analysis, {{"static", Analysis::steady}, {"dynamic", Analysis::dynamic}}).doc("...");
///     s.section("output", [&](config::Section& o) { declare(o, p.output); }, "what is written");
///     s.map("boundaries", p.boundaries, [](config::Section& b, Boundary& v) { declare(b, v); }, "patch", "...");
///     s.check([&] { return p.a < p.b ? "" : "'a' must be below 'b'"; }, "a");
///   }
///
/// Names are kebab-case (asserted). Unknown keys, duplicate keys, wrong types, units and ranges are all
/// collected with file:line:column and reported together.
class Section {
 public:
  explicit Section(Visitor& visitor) : visitor_(visitor) {}
  Section(const Section&) = delete;

  /// A key that fills `target`, a member of one of Slot's types: a number, a word, an expression, Vec3 (a list of 2 or 3
  /// numbers), a list; std::optional stays empty when the key is absent; std::map holds numbers under names of the user's
  /// choice, e.g. {nr: 16, nz: 8}.
  template <class T>
  requires std::constructible_from<Slot, T*> Key value(std::string_view name, T& target) {
    return value_of(name, &target);
  }

  /// A word out of a fixed list.
  template <class E>
  Key choice(std::string_view name, E& target, const std::vector<std::pair<std::string, E>>& words) {
    std::vector<std::string> names;
    std::string current;
    for (const auto& [word, value] : words) {
      names.push_back(word);
      if (value == target) current = word;
    }
    return choice_by_name(name, names, current, [&target, words](const std::string& word) {
      for (const auto& [w, value] : words)
        if (w == word) target = value;
    });
  }

  using Declare = std::function<void(Section&)>;
  /// A mapping below this one; absent means all its defaults (its required keys are then reported as
  /// missing).
  void section(std::string_view name, const Declare& declare, std::string_view doc);
  /// An effect: present in the YAML or not there at all.
  template <class T>
  void optional_section(std::string_view name, std::optional<T>& target,
                        const std::function<void(Section&, T&)>& declare, std::string_view doc) {
    optional_by_name(name, target.has_value(), doc, [&target, declare](Section& s) {
      if (!target) target.emplace();
      declare(s, *target);
    });
  }
  /// A mapping with names of the user's choice, e.g. one entry a patch. `what` is the kind of name, for
  /// messages.
  template <class T>
  void map(std::string_view name, std::map<std::string, T>& target,
           const std::function<void(Section&, T&)>& declare, std::string_view what, std::string_view doc) {
    std::vector<std::string> present;
    for (const auto& [key, value] : target) present.push_back(key);
    map_by_name(name, present, what, doc,
                [&target, declare](const std::string& key, Section& s) { declare(s, target[key]); });
  }
  /// A sequence of mappings.
  template <class T>
  void list(std::string_view name, std::vector<T>& target, const std::function<void(Section&, T&)>& declare,
            std::string_view doc) {
    list_by_name(name, target.size(), doc, [&target, declare](std::size_t i, Section& s) {
      if (target.size() <= i) target.resize(i + 1);
      declare(s, target[i]);
    });
  }
  /// The key `name` (a word) of this mapping decides which further keys of it are valid, e.g. type: inlet |
  /// outlet | wall. Absent means what `target` holds already, unless it is `required`.
  template <class E>
  void variant(std::string_view name, E& target,
               const std::vector<std::tuple<std::string, E, Declare>>& cases, std::string_view doc,
               bool required = false) {
    std::vector<std::pair<std::string, Declare>> by_name;
    std::string current;
    for (const auto& [word, value, declare] : cases) {
      by_name.emplace_back(word, declare);
      if (value == target) current = word;
    }
    variant_by_name(name, by_name, current, required, doc, [&target, cases](const std::string& word) {
      for (const auto& [w, value, declare] : cases)
        if (w == word) target = value;
    });
  }
  /// Cross-rule: declare it after the keys it looks at. It runs at once, if this section was read without
  /// error so far and no key of the sections around it was wrong; an empty text is a pass; `key` is where the
  /// message points.
  void check(const std::function<std::string()>& rule, std::string_view key);
  /// The same for what is implausible: its sentence is a warning, the file stays valid.
  void doubt(const std::function<std::string()>& rule, std::string_view key);

 private:
  Key value_of(std::string_view name, const Slot& slot);
  Key choice_by_name(std::string_view name, const std::vector<std::string>& words, const std::string& current,
                     std::function<void(const std::string&)> set);
  void optional_by_name(std::string_view name, bool present, std::string_view doc, const Declare& declare);
  void map_by_name(std::string_view name, const std::vector<std::string>& present, std::string_view what,
                   std::string_view doc, const std::function<void(const std::string&, Section&)>& declare);
  void list_by_name(std::string_view name, std::size_t present, std::string_view doc,
                    const std::function<void(std::size_t, Section&)>& declare);
  void variant_by_name(std::string_view name, const std::vector<std::pair<std::string, Declare>>& cases,
                       const std::string& current, bool required, std::string_view doc,
                       std::function<void(const std::string&)> set);
  Visitor& visitor_;
};

}  // namespace couplet::config
