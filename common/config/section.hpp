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

/// Facts about one key, and the name and doc of every other declaration.
struct KeyFacts {
  std::string name, unit, doc;
  bool required = false;
  double lowest = -std::numeric_limits<double>::infinity();
  double highest = std::numeric_limits<double>::infinity();
  bool open_lowest = false;
  std::optional<std::size_t> size;
  std::optional<std::pair<double, double>> plausible;  ///< of magnitudes
  std::string any_magnitude;                           ///< the reason
};

/// One declaration, as a Section hands it to its visitor.
struct Declaration {
  enum class Kind { key, section, optional, map, list, variant, check, doubt } kind;
  KeyFacts facts{};  ///< of a rule: the name of the key that its message points to
  /// Member that a key fills; of a variant, its words.
  Slot slot = static_cast<double*>(nullptr);
  std::string what{};                  ///< of a map: the kind of name
  std::vector<std::string> present{};  ///< entries that a map, list (without names) or optional has now
  /// Declares what is below; `name` or `i`: which entry of a map or list.
  std::function<void(Section&, const std::string& name, std::size_t i)> declare{};
  std::vector<std::pair<std::string, std::function<void(Section&)>>> cases{};  ///< of a variant
  std::function<std::string()> rule{};
};

/// Whatever is done with the declarations: a YAML node is read and validated, the Markdown reference or the JSON schema written,
/// the effective values printed. See load.hpp.
using Visitor = std::function<void(const Declaration&)>;

/// Range and documentation of one key, chained onto its declaration:
///   s.value("youngs-modulus", p.youngs_modulus).unit("Pa").positive().required().doc("Young's modulus");
/// A key that is not required keeps the value its target already has: that is its default.
/// The declaration takes effect when the Key goes out of scope, i.e. at the end of the statement.
class Key {
 public:
  /// Accepts "5.6 MPa", "0.1 s" and plain numbers in this SI unit, but none in K or rad (base::needs_unit).
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

  using Facts = KeyFacts;
  Key(const Visitor& visitor, std::string_view name, const Slot& slot);
  ~Key() noexcept(false);
  Key(const Key&) = delete;

 private:
  const Visitor& visitor_;
  Declaration declaration_;
};

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
  /// By reference.
  explicit Section(const Visitor& visitor) : visitor_(visitor) {}
  Section(const Section&) = delete;

  /// A key that fills `target`, a member of one of Slot's types: a number, a word, an expression, Vec3 (a list of 2 or 3
  /// numbers), a list; std::optional stays empty when the key is absent; std::map holds numbers under names of the user's
  /// choice, e.g. {nr: 16, nz: 8}.
  template <class T>
  requires std::constructible_from<Slot, T*> Key value(std::string_view name, T& target) {
    return Key(visitor_, name, &target);
  }

  /// A word out of a fixed list.
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
  /// A mapping below this one; absent means all its defaults (its required keys are then reported as
  /// missing).
  void section(std::string_view name, const Declare& declare, std::string_view doc);
  /// An effect: present in the YAML or not there at all.
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
  /// A mapping with names of the user's choice, e.g. one entry a patch. `what` is the kind of name, for
  /// messages.
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
  /// A sequence of mappings.
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
  /// The key `name` (a word) of this mapping decides which further keys of it are valid, e.g. type: inlet |
  /// outlet | wall. Absent means what `target` holds already, unless it is `required`.
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
  /// Cross-rule: declare it after the keys it looks at. It runs at once, if this section was read without
  /// error so far and no key of the sections around it was wrong; an empty text is a pass; `key` is where the
  /// message points.
  void check(const std::function<std::string()>& rule, std::string_view key);
  /// The same for what is implausible: its sentence is a warning, the file stays valid.
  void doubt(const std::function<std::string()>& rule, std::string_view key);

 private:
  static Declaration named(Declaration::Kind kind, std::string_view name, std::string_view doc);
  const Visitor& visitor_;
};

/// std::visit with one lambda a type.
template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

}  // namespace couplet::config
