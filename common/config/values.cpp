// SPDX-License-Identifier: Apache-2.0
#include "common/config/values.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/base/units.hpp"
#include "common/config/section.hpp"

namespace couplet::config {
namespace {

using Facts = Key::Facts;

void check_range(double value, const Facts& facts) {
  if (!facts.contain(value))
    throw Error("{:.10g}{} is out of range; expected a value {}.", value,
                facts.unit.empty() ? "" : " " + facts.unit, describe_range(facts));
}

struct Axis {
  const char *name, *unit, *expression;
};
constexpr std::array<Axis, 7> axes{{{"x", "m", "x"},
                                    {"y", "m", "y"},
                                    {"z", "m", "z"},
                                    {"r", "m", "sqrt(x^2 + y^2)"},
                                    {"t", "s", "t"},
                                    {"T", "K", "T"},
                                    {"q", "m^3/s", "q"}}};
const std::vector<std::string> keys{"of", "at", "values", "file", "column", "outside", "repeat"};

const Axis& axis_of(const std::string& name) {
  std::vector<std::string> names;
  for (const Axis& axis : axes) {
    if (name == axis.name) return axis;
    names.emplace_back(axis.name);
  }
  throw Error("'of' of a table must be one of: {}; found '{}'.", base::join(names), name);
}

std::string word(const YAML::Node& node, const char* key) {
  const YAML::Node value = node[key];
  if (!value || !value.IsScalar()) throw Error("a table needs '{}' with a single word.", key);
  return value.Scalar();
}

std::vector<double> numbers(const YAML::Node& node, const char* key, const Key::Facts& facts) {
  const YAML::Node list = node[key];
  if (!list || !list.IsSequence()) throw Error("a table needs 'at' and 'values' as lists, or a 'file'.");
  std::vector<double> result;
  for (std::size_t i = 0; i < list.size(); ++i) {
    try {
      if (!list[i].IsScalar()) throw Error("expected a number.");
      result.push_back(base::parse_quantity(list[i].Scalar(), facts.unit));
      check_range(result.back(), facts);
    } catch (const Error& e) {
      throw Error("{}, entry {} of the list: {}", key, i + 1, e.what());
    }
  }
  return result;
}

/// Rule for values beyond the ends, in the form of an expression.
std::string outside_of(const YAML::Node& node, const Axis& axis) {
  if (node["repeat"]) {
    if (node["outside"]) throw Error("a table that repeats has no values outside; remove 'outside'.");
    const double period = base::parse_quantity(word(node, "repeat"), axis.unit);
    if (!(period > 0)) throw Error("'repeat' of a table is its period, which must be above 0.");
    return fmt::format("repeat {}", period);
  }
  if (!node["outside"]) return "clamp";
  const std::string outside = word(node, "outside");
  if (outside != "clamp" && outside != "error")
    throw Error("'outside' of a table must be one of: clamp, error; found '{}'.", outside);
  return outside;
}

/// Converts a table given as a mapping to the text of an expression in SI:
///   {of: t, at: [0, 2 s], values: [0, 3 bar], outside: error}   table(t, error, 0, 0, 2, 300000)
///   {of: z, file: profile.csv, column: speed}                   table(z, clamp, "/case/profile.csv", "speed")
///   {of: t, at: [0, 1 s], values: [0, 3 bar], repeat: 2 s}      table(t, repeat 2, 0, 0, 1, 300000)
/// Throws Error with a sentence without location.
std::string table_text(const YAML::Node& node, const Key::Facts& facts, const std::filesystem::path& folder) {
  for (const auto& item : node)
    if (std::find(keys.begin(), keys.end(), item.first.Scalar()) == keys.end())
      throw Error("a table has no key '{}'. {}", item.first.Scalar(),
                  base::did_you_mean(item.first.Scalar(), keys, "keys"));
  const Axis& axis = axis_of(word(node, "of"));
  std::string text = fmt::format("table({}, {}", axis.expression, outside_of(node, axis));
  if (node["file"]) {
    if (node["at"] || node["values"])
      throw Error("a table takes either 'file' or 'at' and 'values', not both.");
    text += fmt::format(", \"{}\"", (folder / word(node, "file")).string());
    if (node["column"]) text += fmt::format(", \"{}\"", word(node, "column"));
    return text + ")";
  }
  if (node["column"]) throw Error("'column' requires 'file'.");
  const std::vector<double> at = numbers(node, "at", {.unit = axis.unit}),
                            values = numbers(node, "values", facts);
  if (at.size() != values.size())
    throw Error("a table needs one value per point; {} points and {} values are given.", at.size(),
                values.size());
  for (std::size_t i = 0; i < at.size(); ++i) text += fmt::format(", {}, {}", at[i], values[i]);
  return text + ")";
}

/// Makes relative file names of tables in an expression, table(t, "..."), absolute.
std::string with_absolute_files(const std::string& text, const std::filesystem::path& folder) {
  if (text.find("table") == std::string::npos) return text;
  std::string result;
  std::size_t from = 0;
  // Two adjacent quoted words are a file and its column.
  for (std::size_t open = text.find('"'); open != std::string::npos; open = text.find('"', from)) {
    const std::size_t close = text.find('"', open + 1);
    if (close == std::string::npos) break;
    const std::string quoted = text.substr(open + 1, close - open - 1);
    const std::size_t before = text.find_last_not_of(" ,", open == 0 ? 0 : open - 1);
    const bool is_column = before != std::string::npos && text[before] == '"';
    result += text.substr(from, open - from);
    result += '"' + (is_column ? quoted : (folder / quoted).string()) + '"';
    from = close + 1;
  }
  return result + text.substr(from);
}

std::string example(const Facts& facts) {
  if (base::needs_unit(facts.unit)) return fmt::format("a number with its unit, such as {}", facts.unit);
  return facts.unit.empty() ? "a number" : fmt::format("a number in {} or with its unit", facts.unit);
}

const std::string& scalar(const YAML::Node& node, const std::string& expected) {
  if (node.IsMap()) throw Error("expected {}, found a mapping.", expected);
  if (node.IsSequence()) throw Error("expected {}, found a list.", expected);
  if (!node.IsScalar() || node.Scalar().empty()) throw Error("this key has no value; expected {}.", expected);
  return node.Scalar();
}

double read_number(const YAML::Node& node, const Facts& facts) {
  const double value = base::parse_quantity(scalar(node, example(facts)), facts.unit);
  check_range(value, facts);
  return value;
}

int read_integer(const YAML::Node& node, const Facts& facts) {
  const std::string& text = scalar(node, "a whole number");
  const double value = base::parse_quantity(text, facts.unit);
  if (value != std::nearbyint(value)) throw Error("'{}' is not a whole number.", text);
  if (std::abs(value) > std::numeric_limits<int>::max())
    throw Error("'{}' is out of range for this integer key.", text);
  check_range(value, facts);
  return static_cast<int>(value);
}

bool read_bool(const YAML::Node& node) {
  const std::string& text = scalar(node, "true or false");
  bool value = false;
  if (!YAML::convert<bool>::decode(node, value))
    throw Error("'{}' is not valid; expected true or false.", text);
  return value;
}

/// Distinguishes a unit from an expression such as "2*sin(t)", which starts with a number, too.
bool is_unit(const std::string& text) {
  if (text.starts_with('/')) return false;
  try {
    base::parse_unit(text);
    return true;
  } catch (const Error&) {
    return false;
  }
}

/// Converts a number with a unit to the key's unit. Anything else is an expression in that unit.
ExpressionText read_expression(const YAML::Node& node, const Facts& facts,
                               const std::filesystem::path& folder) {
  if (node.IsMap()) return {table_text(node, facts, folder), facts};
  const std::string& text = scalar(
      node, facts.unit.empty() ? "a number or an expression in x, y, z, t"
                               : fmt::format("a number in {0}, with its unit, or an expression in x, y, z, "
                                             "t that yields {0}",
                                             facts.unit));
  const auto quantity = base::split_quantity(text);
  const bool is_expression =
      !quantity || (!quantity->unit.empty() && !is_unit(quantity->unit) &&
                    quantity->unit.find_first_of("+-*/^()<>=?:,&|!") != std::string::npos);
  if (is_expression) return {with_absolute_files(text, folder), facts};
  const double value = base::parse_quantity(text, facts.unit);
  check_range(value, facts);
  return {fmt::format("{}", value), facts};
}

template <class Read>
auto read_list(const YAML::Node& node, const Facts& facts, const std::string& expected, const Read& read) {
  if (!node.IsSequence())
    throw Error("expected {}, found {}.", expected,
                node.IsMap()      ? "a mapping"
                : node.IsScalar() ? fmt::format("'{}'", node.Scalar())
                                  : "nothing");
  if (facts.size && node.size() != *facts.size)
    throw Error("expected a list of {} entries, found {}.", *facts.size, node.size());
  std::vector<decltype(read(node))> result;
  for (std::size_t i = 0; i < node.size(); ++i) {
    try {
      result.push_back(read(node[i]));
    } catch (const Error& error) {
      throw Error("entry {} of the list: {}", i + 1, error.what());
    }
  }
  return result;
}

std::string list_of(const Facts& facts, const std::string& things) {
  std::string text =
      facts.size ? fmt::format("a list of {} {}", *facts.size, things) : fmt::format("a list of {}", things);
  return facts.unit.empty() ? text : fmt::format("{} in {} or with their units", text, facts.unit);
}

std::string read_text(const YAML::Node& node) {
  const std::string& text = scalar(node, "a text");
  if (text.find_first_of("\n\t") != text.npos)
    throw Error(
        "expected a single line of text without tabs. It may become part of a file name or a script.");
  return text;
}

/// Reads a list of names without repetition, because a wall listed twice would count twice.
std::vector<std::string> read_texts(const YAML::Node& node, const Facts& facts) {
  std::vector<std::string> texts = read_list(node, facts, list_of(facts, "texts"), read_text);
  for (auto entry = texts.begin(); entry != texts.end(); ++entry)
    if (std::find(texts.begin(), entry, *entry) != entry)
      throw Error("'{}' is listed twice; remove one of the two.", *entry);
  return texts;
}

Vec3 read_vector(const YAML::Node& node, const Facts& facts) {
  const auto values = read_list(node, facts, list_of(facts, "2 or 3 numbers"),
                                [&](const YAML::Node& entry) { return read_number(entry, facts); });
  if (values.size() != 2 && values.size() != 3)
    throw Error("expected {}, found {} of them.", list_of(facts, "2 or 3 numbers"), values.size());
  return {values[0], values[1], values.size() == 3 ? values[2] : 0.0};
}

std::map<std::string, double> read_named_numbers(const YAML::Node& node, const Facts& facts) {
  if (!node.IsMap())
    throw Error("expected a mapping of names to numbers, such as {{n: 8}}, found {}.",
                node.IsSequence() ? "a list"
                : node.IsScalar() ? fmt::format("'{}'", node.Scalar())
                                  : "nothing");
  std::map<std::string, double> result;
  for (const auto& entry : node) {
    const std::string& name = entry.first.Scalar();
    try {
      result[name] = read_number(entry.second, facts);
    } catch (const Error& error) {
      throw Error("'{}': {}", name, error.what());
    }
  }
  return result;
}

std::string read_word(const YAML::Node& node, const Word& word) {
  const std::string& text = scalar(node, fmt::format("one of: {}", base::join(word.words)));
  for (const std::string& w : word.words)
    if (w == text) return text;
  const auto meant = base::closest(text, word.words);
  throw Error("'{}' is not one of: {}.{}", text, base::join(word.words),
              meant ? fmt::format(" Did you mean '{}'?", *meant) : "");
}

std::string quoted(const std::string& text) {
  YAML::Emitter emitter;
  emitter << text;
  return emitter.c_str();
}

}  // namespace

void read_value(const YAML::Node& node, const Facts& facts, const Slot& slot,
                const std::filesystem::path& folder) {
  std::visit(Overloaded{
                 [&](double* v) { *v = read_number(node, facts); },
                 [&](int* v) { *v = read_integer(node, facts); },
                 [&](bool* v) { *v = read_bool(node); },
                 [&](std::string* v) { *v = read_text(node); },
                 [&](ExpressionText* v) { *v = read_expression(node, facts, folder); },
                 [&](Vec3* v) { *v = read_vector(node, facts); },
                 [&](std::vector<double>* v) {
                   *v = read_list(node, facts, list_of(facts, "numbers"),
                                  [&](const YAML::Node& n) { return read_number(n, facts); });
                 },
                 [&](std::vector<std::string>* v) { *v = read_texts(node, facts); },
                 [&](std::vector<ExpressionText>* v) {
                   *v = read_list(node, facts, list_of(facts, "numbers or expressions"),
                                  [&](const YAML::Node& n) { return read_expression(n, facts, folder); });
                 },
                 [&](std::optional<double>* v) { *v = read_number(node, facts); },
                 [&](std::optional<std::string>* v) { *v = read_text(node); },
                 [&](std::optional<ExpressionText>* v) { *v = read_expression(node, facts, folder); },
                 [&](std::map<std::string, double>* v) { *v = read_named_numbers(node, facts); },
                 [&](const Word& v) { v.set(read_word(node, v)); },
             },
             slot);
}

std::string unknown_key(std::string_view name, const std::vector<std::string>& known) {
  if (name == "quantities")
    return "unknown key. Quantities of this program (a force, a value at a probe, an extremum) belong to the section 'study: "
           "{quantities: ...}' of the case; 'couplet study CASE --quantities' estimates their errors from differences between "
           "coarser runs (docs/studies.md).";
  return "unknown key. " + base::did_you_mean(name, known, "keys");
}

std::string describe_range(const Facts& facts) {
  const bool has_lowest = std::isfinite(facts.lowest), has_highest = std::isfinite(facts.highest);
  const std::string highest = base::format_quantity(facts.highest, facts.unit);
  const std::string lowest = base::format_quantity(facts.lowest, facts.unit);
  if (has_lowest && has_highest)
    return facts.open_lowest ? fmt::format("above {} and at most {}", lowest, highest)
                             : fmt::format("from {} to {}", lowest, highest);
  if (has_lowest) return fmt::format("{} {}", facts.open_lowest ? "above" : "at least", lowest);
  if (has_highest) return fmt::format("at most {}", highest);
  return "";
}

std::string describe_type(const Slot& slot) {
  return std::visit(Overloaded{
                        [](const double*) { return "number"; },
                        [](const int*) { return "whole number"; },
                        [](const bool*) { return "true or false"; },
                        [](const std::string*) { return "text"; },
                        [](const ExpressionText*) { return "number or expression"; },
                        [](const Vec3*) { return "list of 2 or 3 numbers"; },
                        [](const std::vector<double>*) { return "list of numbers"; },
                        [](const std::vector<std::string>*) { return "list of texts"; },
                        [](const std::vector<ExpressionText>*) { return "list of numbers or expressions"; },
                        [](const std::optional<double>*) { return "number"; },
                        [](const std::optional<std::string>*) { return "text"; },
                        [](const std::optional<ExpressionText>*) { return "number or expression"; },
                        [](const std::map<std::string, double>*) { return "mapping of numbers"; },
                        [](const Word&) { return "word"; },
                    },
                    slot);
}

std::string format_value(const Slot& slot, std::string_view unit) {
  const std::string behind = base::needs_unit(unit) ? fmt::format(" {}", unit) : "";
  const auto number = [&](double v) { return fmt::format("{}{}", v, behind); };
  const auto list = [](const auto& values, const auto& print) {
    std::vector<std::string> texts;
    for (const auto& v : values) texts.push_back(print(v));
    return fmt::format("[{}]", base::join(texts));
  };
  const auto expression = [&](const ExpressionText& v) {
    const auto quantity = base::split_quantity(v.text);
    return quoted(quantity && quantity->unit.empty() ? v.text + behind : v.text);
  };
  return std::visit(
      Overloaded{
          [&](const double* v) { return number(*v); },
          [&](const int* v) { return fmt::format("{}", *v); },
          [&](const bool* v) { return std::string(*v ? "true" : "false"); },
          [&](const std::string* v) { return v->empty() ? std::string() : quoted(*v); },
          [&](const ExpressionText* v) { return expression(*v); },
          [&](const Vec3* v) { return fmt::format("[{}, {}, {}]", v->x(), v->y(), v->z()); },
          [&](const std::vector<double>* v) { return list(*v, number); },
          [&](const std::vector<std::string>* v) { return list(*v, quoted); },
          [&](const std::vector<ExpressionText>* v) { return list(*v, expression); },
          [&](const std::optional<double>* v) { return *v ? number(**v) : std::string(); },
          [&](const std::optional<std::string>* v) { return *v ? quoted(**v) : std::string(); },
          [&](const std::optional<ExpressionText>* v) { return *v ? expression(**v) : std::string(); },
          [&](const std::map<std::string, double>* v) {
            std::vector<std::string> texts;
            for (const auto& [name, value] : *v)
              texts.push_back(fmt::format("{}: {}", quoted(name), number(value)));
            return texts.empty() ? std::string() : fmt::format("{{{}}}", base::join(texts));
          },
          [&](const Word& v) { return v.current; },
      },
      slot);
}

std::string check_wave_speed(double modulus, double density) {
  constexpr double slowest = 0.2, fastest = 20e3;  // [m/s]; a gel of 100 Pa has 0.3, steel without GPa 0.16
  if (!(modulus > 0) || !(density > 0)) return "";
  const double speed = std::sqrt(modulus / density);
  if (speed >= slowest && speed <= fastest) return "";
  return fmt::format(
      "waves would travel at {:.3g} m/s (usual: 0.2 to 20000 m/s): implausible; check the units of the modulus ({:g} Pa) and of the "
      "density ({:g} kg/m^3).",
      speed, modulus, density);
}

std::string check_kinematic_viscosity(double viscosity, double density) {
  constexpr double least = 5e-8;  // [m^2/s]
  if (!(viscosity > 0) || !(density > 0) || viscosity / density >= least) return "";
  return fmt::format(
      "viscosity/density is {:.3g} m^2/s (usual: at least {:g} m^2/s): implausible; 'viscosity' is the dynamic viscosity, in "
      "Pa s; if the kinematic viscosity was meant, the dynamic one would be {:g} Pa s.",
      viscosity / density, least, viscosity * density);
}

namespace {

/// Values of table(t, [clamp|error|repeat P,] 0, 0, 2, 300000), which follow their positions. None for a table in a
/// file or of a function.
std::vector<double> values_of_table(const std::string& text) {
  std::vector<double> values;
  if (!text.starts_with("table(") || text.find_first_of("()", 6) != text.size() - 1) return values;
  const std::vector<std::string> parts = base::split(text.substr(6, text.size() - 7), ',');
  const std::size_t first = parts.size() > 1 && !base::split_quantity(parts[1]) ? 3 : 2;
  for (std::size_t i = first; i < parts.size(); i += 2) {
    const auto number = base::split_quantity(parts[i]);
    if (!number || !number->unit.empty() || !base::split_quantity(parts[i - 1])) return {};
    values.push_back(number->number);
  }
  return values;
}

std::vector<double> values_of(const ExpressionText& text) {
  const auto number = base::split_quantity(text.text);
  if (number && number->unit.empty()) return {number->number};
  return values_of_table(text.text);
}

std::vector<double> values_of(const Slot& slot) {
  const auto single = [](double v) { return std::vector<double>{v}; };
  return std::visit(
      Overloaded{[&](double* v) { return single(*v); }, [&](int* v) { return single(*v); },
                 [&](std::optional<double>* v) { return *v ? single(**v) : std::vector<double>{}; },
                 [&](Vec3* v) { return single(v->cwiseAbs().maxCoeff()); },
                 [](std::vector<double>* v) { return *v; }, [](ExpressionText* v) { return values_of(*v); },
                 [](std::optional<ExpressionText>* v) { return *v ? values_of(**v) : std::vector<double>{}; },
                 [](std::vector<ExpressionText>* v) {
                   // In a vector, values that are small compared to its largest component count as zero.
                   double largest = 0;
                   for (const ExpressionText& component : *v)
                     for (const double value : values_of(component))
                       largest = std::max(largest, std::abs(value));
                   return std::vector<double>{largest};
                 },
                 [](std::map<std::string, double>* v) {
                   std::vector<double> values;
                   for (const auto& [name, value] : *v) values.push_back(value);
                   return values;
                 },
                 [](auto) { return std::vector<double>{}; }},
      slot);
}

}  // namespace

std::string describe_plausible(const Key::Facts& facts) {
  if (!facts.plausible) return "";
  return fmt::format("{:g} to {:g} {}", facts.plausible->first, facts.plausible->second, facts.unit);
}

std::string check_magnitude(const Key::Facts& facts, const Slot& slot) {
  if (!facts.plausible) return "";
  for (const double value : values_of(slot)) {
    const double magnitude = std::abs(value);
    if (magnitude == 0 || (magnitude >= facts.plausible->first && magnitude <= facts.plausible->second))
      continue;
    return fmt::format("{:.6g} {} (usual: {}): implausible; check the number and its unit.", value,
                       facts.unit, describe_plausible(facts));
  }
  return "";
}

}  // namespace couplet::config
