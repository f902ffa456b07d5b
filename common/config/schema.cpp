// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "common/base/text.hpp"
#include "common/base/units.hpp"
#include "common/config/load.hpp"
#include "common/config/values.hpp"

namespace couplet::config {
namespace {

std::string quote(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    if (static_cast<unsigned char>(c) < 0x20)
      result += fmt::format("\\u{:04x}", static_cast<int>(c));
    else
      result += c;
  }
  return result + '"';
}

/// Builds a JSON object or array from members in JSON.
std::string enclose(char open, char close, const std::vector<std::string>& members) {
  if (members.empty()) return {open, close};
  std::string inner = base::join(members, ",\n");
  for (std::size_t at = 0; (at = inner.find('\n', at)) != std::string::npos; at += 3)
    inner.insert(at + 1, "  ");
  return fmt::format("{}\n  {}\n{}", open, inner, close);
}
std::string object(const std::vector<std::string>& members) { return enclose('{', '}', members); }
std::string array(const std::vector<std::string>& members) { return enclose('[', ']', members); }
std::string member(std::string_view name, std::string_view json) {
  return fmt::format("{}: {}", quote(name), json);
}

std::vector<std::string> quoted_all(const std::vector<std::string>& words) {
  std::vector<std::string> result;
  for (const std::string& word : words) result.push_back(quote(word));
  return result;
}

/// Schema of a bare number within its limits, or a text: the number with its unit or percent sign.
std::string number_schema(const Key::Facts& facts, bool integer) {
  std::vector<std::string> number{member("type", integer ? "\"integer\"" : "\"number\"")};
  if (std::isfinite(facts.lowest))
    number.push_back(
        member(facts.open_lowest ? "exclusiveMinimum" : "minimum", fmt::format("{}", facts.lowest)));
  if (std::isfinite(facts.highest)) number.push_back(member("maximum", fmt::format("{}", facts.highest)));
  if (integer && facts.unit.empty()) return object(number);
  const std::string value = "^[+-]?([0-9]+\\.?[0-9]*|\\.[0-9]+)([eE][+-]?[0-9]+)?";
  const std::string text =
      object({member("type", "\"string\""),
              member("pattern", quote(value + (facts.unit.empty() ? " *%?$" : " *[^0-9 ].*$")))});
  return base::needs_unit(facts.unit) ? text : object({member("anyOf", array({object(number), text}))});
}

/// Schema of a number, an expression, or a table as a mapping.
std::string expression_schema() {
  return object({member("type", array({"\"number\"", "\"string\"", "\"object\""}))});
}

std::string list_schema(const std::string& items, std::optional<std::size_t> least,
                        std::optional<std::size_t> most) {
  std::vector<std::string> members{member("type", "\"array\""), member("items", items)};
  if (least) members.push_back(member("minItems", fmt::format("{}", *least)));
  if (most) members.push_back(member("maxItems", fmt::format("{}", *most)));
  return object(members);
}

std::string text_schema() {
  return object({member("type", array({"\"string\"", "\"number\"", "\"boolean\""}))});
}

std::string value_schema(const Item& item) {
  const Key::Facts& facts = item.facts;
  const std::string number = number_schema(facts, false), text = text_schema(),
                    expression = expression_schema();
  return std::visit(
      Overloaded{
          [&](double*) { return number; },
          [&](int*) { return number_schema(facts, true); },
          [&](bool*) { return object({member("type", "\"boolean\"")}); },
          [&](std::string*) { return text; },
          [&](ExpressionText*) { return expression; },
          [&](Vec3*) { return list_schema(number, 2, 3); },
          [&](std::vector<double>*) { return list_schema(number, facts.size, facts.size); },
          [&](std::vector<std::string>*) { return list_schema(text, facts.size, facts.size); },
          [&](std::vector<ExpressionText>*) { return list_schema(expression, facts.size, facts.size); },
          [&](std::optional<double>*) { return number; },
          [&](std::optional<std::string>*) { return text; },
          [&](std::optional<ExpressionText>*) { return expression; },
          [&](std::map<std::string, double>*) {
            return object({member("type", "\"object\""), member("additionalProperties", number)});
          },
          [&](const Word& word) { return object({member("enum", array(quoted_all(word.words)))}); },
      },
      item.slot);
}

std::string mapping_schema(const std::vector<Item>& items);

std::string documented(const Item& item);

std::string item_schema(const Item& item) {
  switch (item.kind) {
    case Declaration::Kind::key:
      return value_schema(item);
    case Declaration::Kind::map:
      return object(
          {member("type", "\"object\""), member("additionalProperties", mapping_schema(item.items))});
    case Declaration::Kind::list:
      return list_schema(mapping_schema(item.items), {}, {});
    default:
      return mapping_schema(item.items);
  }
}

/// Annotations of a quantity for tools: its unit and usual magnitudes, or why there are none.
std::vector<std::string> contract(const Key::Facts& facts) {
  std::vector<std::string> notes;
  if (!facts.unit.empty()) notes.push_back(member("x-unit", quote(facts.unit)));
  if (facts.plausible)
    notes.push_back(member("x-usual", array({fmt::format("{}", facts.plausible->first),
                                             fmt::format("{}", facts.plausible->second)})));
  if (!facts.any_magnitude.empty()) notes.push_back(member("x-any-magnitude", quote(facts.any_magnitude)));
  return notes;
}

/// Schema of one item with its documentation for editors.
std::string documented(const Item& item) {
  std::string schema = item_schema(item);
  std::string doc = item.facts.doc;
  if (!item.facts.unit.empty()) doc += fmt::format("{}[{}]", doc.empty() ? "" : " ", item.facts.unit);
  if (const std::string range = describe_range(item.facts); !range.empty())
    doc += fmt::format(" ({})", range);
  std::string front = doc.empty() ? "" : fmt::format("\n  {},", member("description", quote(doc)));
  for (const std::string& note : contract(item.facts)) front += fmt::format("\n  {},", note);
  return schema.insert(1, front);
}

bool has_required(const std::vector<Item>& items) {
  for (const Item& item : items)
    if ((item.kind == Declaration::Kind::section && has_required(item.items)) || item.facts.required)
      return true;
  return false;
}

/// Alternatives of a mapping; every variant multiplies them by its cases. Each is closed, so that every
/// validator rejects keys of other cases.
struct Alternative {
  std::vector<std::string> properties, required;
};
std::vector<Alternative> alternatives(const std::vector<Item>& items) {
  std::vector<Alternative> all(1);
  for (std::size_t i = 0; i < items.size(); ++i) {
    const Item& item = items[i];
    if (item.kind != Declaration::Kind::variant) {
      const bool needed =
          item.facts.required || (item.kind == Declaration::Kind::section && has_required(item.items));
      std::string schema = documented(item);
      if (i + 1 < items.size() && items[i + 1].facts.name == item.facts.name)  // a number or a mapping
        schema = object({member("anyOf", array({schema, documented(items[++i])}))});
      for (Alternative& a : all) {
        a.properties.push_back(member(item.facts.name, schema));
        if (needed) a.required.push_back(item.facts.name);
      }
      continue;
    }
    std::vector<Alternative> multiplied;
    for (const Alternative& a : all)
      for (const auto& [word, keys] : item.cases)
        for (const Alternative& below : alternatives(keys)) {
          Alternative next = a;
          std::vector<std::string> members{member("const", quote(word))};
          if (!item.facts.doc.empty())
            members.insert(members.begin(), member("description", quote(item.facts.doc)));
          next.properties.push_back(member(item.facts.name, object(members)));
          if (item.facts.required || word != item.value) next.required.push_back(item.facts.name);
          next.properties.insert(next.properties.end(), below.properties.begin(), below.properties.end());
          next.required.insert(next.required.end(), below.required.begin(), below.required.end());
          multiplied.push_back(std::move(next));
        }
    all = std::move(multiplied);
  }
  return all;
}

std::string mapping_schema(const std::vector<Item>& items) {
  std::vector<std::string> schemas;
  for (const Alternative& a : alternatives(items)) {
    std::vector<std::string> members{member("type", "\"object\""), member("properties", object(a.properties)),
                                     member("additionalProperties", "false")};
    if (!a.required.empty()) members.push_back(member("required", array(quoted_all(a.required))));
    schemas.push_back(object(members));
  }
  return schemas.size() == 1 ? schemas.front() : object({member("oneOf", array(schemas))});
}

}  // namespace

std::string json_schema(const std::string& title, const Section::Declare& declare) {
  std::string schema = mapping_schema(describe(declare, Describe::everything));
  schema.insert(1, fmt::format("\n  {},\n  {},",
                               member("$schema", quote("https://json-schema.org/draft/2020-12/schema")),
                               member("title", quote(title))));
  return schema + "\n";
}

}  // namespace couplet::config
