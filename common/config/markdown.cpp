// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "common/base/text.hpp"
#include "common/config/description.hpp"
#include "common/config/document.hpp"
#include "common/config/load.hpp"
#include "common/config/magnitude.hpp"
#include "common/config/values.hpp"

namespace couplet::config {
namespace {

/// A bar would end the table's cell.
std::string cell(const std::string& text) { return base::join(base::split(text, '|'), "\\|"); }

std::string code(const std::string& text) { return text.empty() ? text : fmt::format("`{}`", text); }

/// "usual: 0.01 to 1e5 kg/m^3"; or why there is no such range.
std::string usual_text(const Key::Facts& facts) {
  if (facts.plausible) return "usual: " + describe_plausible(facts);
  return facts.any_magnitude.empty() ? "" : "any magnitude: " + facts.any_magnitude;
}

std::string row(const Item& item) {
  const Key::Facts& facts = item.facts;
  std::string type = item.type, fallback, unit = code(facts.unit), range = describe_range(facts),
              doc = facts.doc;
  switch (item.kind) {
    case Item::Kind::key:
    case Item::Kind::variant:
      if (!item.words.empty()) range = fmt::format("`{}`", base::join(item.words, "`, `"));
      if (const std::string usual = usual_text(facts); !usual.empty())
        range += (range.empty() ? "" : "; ") + usual;
      if (facts.size && !type.starts_with("list of 2 or 3"))  // there a matter of the scene
        type += fmt::format(" ({})", *facts.size);
      fallback = facts.required ? "**required**" : item.value.empty() ? "not set" : code(item.value);
      break;
    case Item::Kind::section:
      type = "mapping";
      break;
    case Item::Kind::optional:
      type = "mapping", fallback = "absent: not used";
      break;
    case Item::Kind::map:
      type = fmt::format("mapping by {}", item.what);
      break;
    case Item::Kind::list:
      type = "list of mappings";
      break;
  }
  return fmt::format("| {} | {} | {} | {} | {} | {} |\n", code(facts.name), type, unit, cell(fallback),
                     cell(range), cell(doc));
}

void write_section(std::string& out, const std::string& path, const std::vector<Item>& items, int level);

void write_below(std::string& out, const std::string& path, const std::vector<Item>& items, int level) {
  for (const Item& item : items) {
    const std::string here = join_path(path, item.facts.name);
    if (item.kind == Item::Kind::section || item.kind == Item::Kind::optional)
      write_section(out, here, item.items, level);
    if (item.kind == Item::Kind::map)
      write_section(out, fmt::format("{}.<{}>", here, item.what), item.items, level);
    if (item.kind == Item::Kind::list) write_section(out, fmt::format("{}[]", here), item.items, level);
    if (item.kind == Item::Kind::variant)
      for (const auto& [word, keys] : item.cases)
        if (!keys.empty())
          write_section(out,
                        fmt::format("{}` with `{}: {}", path.empty() ? std::string("this") : path,
                                    item.facts.name, word),
                        keys, level);
  }
}

void write_section(std::string& out, const std::string& path, const std::vector<Item>& items, int level) {
  if (!path.empty())
    out += fmt::format("\n{} `{}`\n", std::string(static_cast<std::size_t>(level), '#'), path);
  out += "\n| key | type | unit | default | allowed | meaning |\n|---|---|---|---|---|---|\n";
  for (const Item& item : items) out += row(item);
  write_below(out, path, items, level);
}

}  // namespace

std::string markdown(const std::string& title, const Section::Declare& declare) {
  std::string out = fmt::format("# {}\n", title);
  write_section(out, "", describe(declare, Describe::everything), 2);
  return out;
}

}  // namespace couplet::config
