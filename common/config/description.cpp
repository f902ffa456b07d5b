// SPDX-License-Identifier: Apache-2.0
#include "common/config/description.hpp"

#include <fmt/format.h>

#include "common/base/text.hpp"
#include "common/config/document.hpp"
#include "common/config/load.hpp"
#include "common/config/magnitude.hpp"
#include "common/config/values.hpp"

namespace couplet::config {

namespace {

class Describer final : public Visitor {
 public:
  explicit Describer(Describe extent) : extent_(extent) {}
  std::vector<Item> items;

  void key(const Facts& facts, const Slot& slot) override {
    Item item;
    item.facts = facts;
    item.type = describe_type(slot);
    item.value = format_value(slot, facts.unit);
    item.slot = slot;
    if (const Word* word = std::get_if<Word>(&slot)) item.words = word->words;
    items.push_back(std::move(item));
  }
  void section(std::string_view name, std::string_view doc, const Declare& declare) override {
    Item item = make(Item::Kind::section, name, doc);
    item.items = below(declare);
    items.push_back(std::move(item));
  }
  void optional(std::string_view name, bool present, std::string_view doc, const Declare& declare) override {
    Item item = make(Item::Kind::optional, name, doc);
    item.is_present = present;
    if (present || extent_ == Describe::everything) item.items = below(declare);
    items.push_back(std::move(item));
  }
  void map(std::string_view name, const std::vector<std::string>& present, std::string_view what,
           std::string_view doc, const std::function<void(const std::string&, Section&)>& declare) override {
    Item item = make(Item::Kind::map, name, doc);
    item.what = what;
    if (extent_ == Describe::everything)
      item.items = below([&](Section& s) { declare(fmt::format("<{}>", what), s); });
    else
      for (const std::string& entry : present)
        item.present.emplace_back(entry, below([&](Section& s) { declare(entry, s); }));
    items.push_back(std::move(item));
  }
  void list(std::string_view name, std::size_t present, std::string_view doc,
            const std::function<void(std::size_t, Section&)>& declare) override {
    Item item = make(Item::Kind::list, name, doc);
    if (extent_ == Describe::everything)
      item.items = below([&](Section& s) { declare(0, s); });
    else
      for (std::size_t i = 0; i < present; ++i)
        item.present.emplace_back("", below([&](Section& s) { declare(i, s); }));
    items.push_back(std::move(item));
  }
  void variant(const Facts& facts, const Cases& cases, const std::string& current,
               const std::function<void(const std::string&)>&) override {
    Item item;
    item.kind = Item::Kind::variant;
    item.facts = facts;
    item.type = "word";
    item.value = current;
    for (const auto& [word, declare] : cases) {
      item.words.push_back(word);
      if (word == current || extent_ == Describe::everything) item.cases.emplace_back(word, below(declare));
    }
    items.push_back(std::move(item));
  }
  void check(const std::function<std::string()>&, std::string_view) override {}

 private:
  static Item make(Item::Kind kind, std::string_view name, std::string_view doc) {
    Item item;
    item.kind = kind;
    item.facts.name = name;
    item.facts.doc = doc;
    return item;
  }
  std::vector<Item> below(const Declare& declare) const { return describe(declare, extent_); }

  Describe extent_;
};

}  // namespace

std::vector<Item> describe(const Section::Declare& declare, Describe extent) {
  Describer describer(extent);
  Section section(describer);
  declare(section);
  return std::move(describer.items);
}

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
