// SPDX-License-Identifier: Apache-2.0
#include "common/config/table_text.hpp"

#include <fmt/format.h>

#include <array>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/base/units.hpp"

namespace couplet::config {
namespace {

struct Axis {
  const char *name, *unit, *expression;
};
constexpr std::array<Axis, 6> axes{{{"x", "m", "x"},
                                    {"y", "m", "y"},
                                    {"z", "m", "z"},
                                    {"r", "m", "sqrt(x^2 + y^2)"},
                                    {"t", "s", "t"},
                                    {"T", "K", "T"}}};
const std::vector<std::string> keys{"of", "at", "values", "file", "column", "outside"};

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

std::vector<double> numbers(const YAML::Node& node, const char* key, std::string_view unit) {
  const YAML::Node list = node[key];
  if (!list || !list.IsSequence()) throw Error("a table needs 'at' and 'values' as lists, or a 'file'.");
  std::vector<double> result;
  for (std::size_t i = 0; i < list.size(); ++i) {
    try {
      if (!list[i].IsScalar()) throw Error("expected a number.");
      result.push_back(base::parse_quantity(list[i].Scalar(), unit));
    } catch (const Error& e) {
      throw Error("{}, entry {} of the list: {}", key, i + 1, e.what());
    }
  }
  return result;
}

std::string outside_of(const YAML::Node& node) {
  if (!node["outside"]) return "clamp";
  const std::string outside = word(node, "outside");
  if (outside != "clamp" && outside != "error")
    throw Error("'outside' of a table must be one of: clamp, error; found '{}'.", outside);
  return outside;
}

}  // namespace

std::string table_text(const YAML::Node& node, const Key::Facts& facts, const std::filesystem::path& folder) {
  for (const auto& item : node)
    if (std::find(keys.begin(), keys.end(), item.first.Scalar()) == keys.end())
      throw Error("a table has no key '{}'. {}", item.first.Scalar(),
                  base::did_you_mean(item.first.Scalar(), keys, "keys"));
  const Axis& axis = axis_of(word(node, "of"));
  std::string text = fmt::format("table({}, {}", axis.expression, outside_of(node));
  if (node["file"]) {
    if (node["at"] || node["values"])
      throw Error(
          "a table takes either 'file' or 'at' and 'values', not "
          "both.");
    text += fmt::format(", \"{}\"", (folder / word(node, "file")).string());
    if (node["column"]) text += fmt::format(", \"{}\"", word(node, "column"));
    return text + ")";
  }
  if (node["column"]) throw Error("'column' requires 'file'.");
  const std::vector<double> at = numbers(node, "at", axis.unit), values = numbers(node, "values", facts.unit);
  if (at.size() != values.size())
    throw Error("a table needs one value per point; {} points and {} values are given.", at.size(),
                values.size());
  for (std::size_t i = 0; i < at.size(); ++i) text += fmt::format(", {}, {}", at[i], values[i]);
  return text + ")";
}

std::string with_absolute_files(const std::string& text, const std::filesystem::path& folder) {
  if (text.find("table") == std::string::npos) return text;
  std::string result;
  std::size_t from = 0;
  // Of two neighbouring quoted words the first is the file, the second its column.
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

}  // namespace couplet::config
