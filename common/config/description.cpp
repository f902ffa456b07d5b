// SPDX-License-Identifier: Apache-2.0
#include "common/config/description.hpp"

#include <fmt/format.h>

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

}  // namespace couplet::config
