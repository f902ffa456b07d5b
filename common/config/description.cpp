// SPDX-License-Identifier: Apache-2.0

#include <fmt/format.h>

#include <yaml-cpp/yaml.h>

#include "common/base/text.hpp"
#include "common/config/document.hpp"
#include "common/config/load.hpp"
#include "common/config/values.hpp"

namespace couplet::config {

std::vector<Item> describe(const Section::Declare& declare, Describe extent) {
  using Kind = Declaration::Kind;
  std::vector<Item> items;
  const bool all = extent == Describe::everything;
  const Visitor describer = [&](const Declaration& d) {
    if (d.kind == Kind::check || d.kind == Kind::doubt) return;
    Item item;
    item.kind = d.kind;
    item.facts = d.facts;
    item.slot = d.slot;
    item.what = d.what;
    item.is_present = !d.present.empty();
    const auto below = [&](const std::string& name, std::size_t i) {
      return describe([&](Section& s) { d.declare(s, name, i); }, extent);
    };
    const Word* word = std::get_if<Word>(&d.slot);
    if (word) item.words = word->words;
    if (d.kind == Kind::key || d.kind == Kind::variant) {
      item.type = describe_type(d.slot);
      item.value = format_value(d.slot, d.facts.unit);
    } else if (all || d.kind == Kind::section || (d.kind == Kind::optional && item.is_present)) {
      item.items = below(fmt::format("<{}>", d.what), 0);
    } else if (d.kind != Kind::optional) {
      for (std::size_t i = 0; i < d.present.size(); ++i)
        item.present.emplace_back(d.present[i], below(d.present[i], i));
    }
    for (const auto& [name, keys] : d.cases)
      if (all || name == word->current) item.cases.emplace_back(name, describe(keys, extent));
    // The case gives a number or a mapping; this is the one that it gives.
    if (!all && !items.empty() && items.back().facts.name == item.facts.name) {
      if (item.is_present) items.back() = std::move(item);
      return;
    }
    items.push_back(std::move(item));
  };
  Section section(describer);
  declare(section);
  return items;
}

namespace {

/// Escapes bars, which would end a table cell.
std::string cell(const std::string& text) { return base::join(base::split(text, '|'), "\\|"); }

std::string code(const std::string& text) { return text.empty() ? text : fmt::format("`{}`", text); }

/// Text "usual: 0.01 to 1e5 kg/m^3", or why there is no such range.
std::string usual_text(const Key::Facts& facts) {
  if (facts.plausible) return "usual: " + describe_plausible(facts);
  return facts.any_magnitude.empty() ? "" : "any magnitude: " + facts.any_magnitude;
}

std::string row(const Item& item) {
  const Key::Facts& facts = item.facts;
  std::string type = item.type, fallback, unit = code(facts.unit), range = describe_range(facts),
              doc = facts.doc;
  switch (item.kind) {
    case Declaration::Kind::key:
    case Declaration::Kind::variant:
      if (!item.words.empty()) range = fmt::format("`{}`", base::join(item.words, "`, `"));
      if (const std::string usual = usual_text(facts); !usual.empty())
        range += (range.empty() ? "" : "; ") + usual;
      if (facts.size && !type.starts_with("list of 2 or 3"))  // depends on the dimension
        type += fmt::format(" ({})", *facts.size);
      fallback = facts.required ? "**required**" : item.value.empty() ? "not set" : code(item.value);
      break;
    case Declaration::Kind::section:
      type = "mapping";
      break;
    case Declaration::Kind::optional:
      type = "mapping", fallback = "not used";
      break;
    case Declaration::Kind::map:
      type = fmt::format("mapping by {}", item.what);
      break;
    case Declaration::Kind::list:
      type = "list of mappings";
      break;
    default:
      break;
  }
  return fmt::format("| {} | {} | {} | {} | {} | {} |\n", code(facts.name), type, unit, cell(fallback),
                     cell(range), cell(doc));
}

void write_section(std::string& out, const std::string& path, const std::vector<Item>& items, int level);

void write_below(std::string& out, const std::string& path, const std::vector<Item>& items, int level) {
  for (const Item& item : items) {
    const std::string here = join_path(path, item.facts.name);
    if (item.kind == Declaration::Kind::section || item.kind == Declaration::Kind::optional)
      write_section(out, here, item.items, level);
    if (item.kind == Declaration::Kind::map)
      write_section(out, fmt::format("{}.<{}>", here, item.what), item.items, level);
    if (item.kind == Declaration::Kind::list)
      write_section(out, fmt::format("{}[]", here), item.items, level);
    if (item.kind == Declaration::Kind::variant)
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

namespace {

std::string key_text(const std::string& name) {
  YAML::Emitter emitter;
  emitter << name;
  return emitter.c_str();
}

/// Writes YAML. The first line of a list entry starts with "- ", everything else is indented.
void write(std::string& out, const std::vector<Item>& items, std::size_t indent) {
  const std::string blanks(indent, ' ');
  for (const Item& item : items) {
    const std::string name = key_text(item.facts.name);
    switch (item.kind) {
      case Declaration::Kind::key:
      case Declaration::Kind::variant:
        if (item.value.empty())
          out += fmt::format("{}# {}: not set\n", blanks, name);
        else
          out += fmt::format("{}{}: {}{}\n", blanks, name, item.value,
                             item.facts.unit.empty() ? "" : "  # " + item.facts.unit);
        for (const auto& [word, keys] : item.cases) write(out, keys, indent);
        break;
      case Declaration::Kind::section:
        out += fmt::format("{}{}:\n", blanks, name);
        write(out, item.items, indent + 2);
        break;
      case Declaration::Kind::optional:
        if (item.is_present) {
          out += fmt::format("{}{}:\n", blanks, name);
          write(out, item.items, indent + 2);
        } else {
          out += fmt::format("{}# {}: not there\n", blanks, name);
        }
        break;
      case Declaration::Kind::map:
        out += fmt::format("{}{}:{}\n", blanks, name, item.present.empty() ? " {}" : "");
        for (const auto& [entry, keys] : item.present) {
          out += fmt::format("{}  {}:\n", blanks, key_text(entry));
          write(out, keys, indent + 4);
        }
        break;
      case Declaration::Kind::list:
        out += fmt::format("{}{}:{}\n", blanks, name, item.present.empty() ? " []" : "");
        for (const auto& [entry, keys] : item.present) {
          out += fmt::format("{}  -\n", blanks);
          write(out, keys, indent + 4);
        }
        break;
      default:
        break;
    }
  }
}

}  // namespace

std::string effective(const Section::Declare& declare) {
  std::string out;
  write(out, describe(declare, Describe::present), 0);
  return out;
}

}  // namespace couplet::config
