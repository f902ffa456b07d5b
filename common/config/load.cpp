// SPDX-License-Identifier: Apache-2.0
#include "common/config/load.hpp"

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/config/document.hpp"
#include "common/config/reader.hpp"

namespace couplet::config {
namespace {

/// Node at a dotted path and the location of its key. If a part is missing, found is false, and the location
/// is that of the last existing mapping with path `reached`.
struct Located {
  Entry entry;
  std::string reached, missing;
  std::vector<std::string> present;
};

Located locate(const Document::Content& content, const std::string& path) {
  Located result;
  result.entry.found = true;
  result.entry.place.line = result.entry.place.column = 1;
  // Assigning one YAML::Node to another changes the tree, so reset() is required.
  result.entry.node.reset(content.root);
  if (path.empty()) return result;
  for (const std::string& part : base::split(path, '.')) {
    const Entry next = find(result.entry.node, part);
    result.entry.found = next.found;
    if (!next.found) {
      result.missing = part;
      result.present = key_names(result.entry.node);
      return result;
    }
    result.entry.place = next.place;
    result.entry.node.reset(next.node);
    result.reached = join_path(result.reached, part);
  }
  return result;
}

}  // namespace

std::vector<std::string> load(const Document& document, const std::string& path,
                              const Section::Declare& declare, const CheckExpression& check_expression,
                              std::vector<std::string>* doubts) {
  const Document::Content& content = document.content();
  if (content.root.IsNull()) return {fmt::format("{}:1:1: this file is empty.", content.name)};
  if (!content.root.IsMap())
    return {fmt::format("{}:1:1: expected a mapping (keys with values), found {}.", content.name,
                        content.root.IsSequence() ? "a list" : fmt::format("'{}'", content.root.Scalar()))};
  const Located located = locate(content, path);
  if (!located.entry.found) {
    const auto meant = base::closest(located.missing, located.present);
    const std::string text = meant ? fmt::format("this section is missing. Did you write '{}'?", *meant)
                                   : std::string("this section is missing.");
    return format_all(content.name,
                      {{located.entry.place, join_path(located.reached, located.missing), text}});
  }
  Reader reader(content, check_expression);
  reader.read_mapping(located.entry.node, located.entry.place, path, declare);
  if (doubts != nullptr) *doubts = format_all(content.name, reader.doubts());
  return format_all(content.name, reader.messages());
}

void load_or_throw(const Document& document, const std::string& path, const Section::Declare& declare) {
  const std::vector<std::string> messages = load(document, path, declare);
  if (!messages.empty()) throw Error(base::join(messages, "\n"));
}

std::vector<std::string> keys_of(const Document& document, const std::string& path) {
  const Located located = locate(document.content(), path);
  return located.entry.found ? key_names(located.entry.node) : std::vector<std::string>{};
}

std::optional<std::string> text_of(const Document& document, const std::string& path) {
  const Located located = locate(document.content(), path);
  if (!located.entry.found || !located.entry.node.IsScalar()) return std::nullopt;
  return located.entry.node.Scalar();
}

std::vector<std::string> texts_of(const Document& document, const std::string& path) {
  std::vector<std::string> texts;
  if (!document.content().root.IsMap()) return texts;
  const Located located = locate(document.content(), path);
  if (located.entry.found && located.entry.node.IsSequence())
    for (const YAML::Node& node : located.entry.node)
      if (node.IsScalar()) texts.push_back(node.Scalar());
  return texts;
}

std::string where(const Document& document, const std::string& path) {
  const Document::Content& content = document.content();
  Place place = locate(content, path).entry.place;
  for (const auto& [changed, option] : content.overrides)
    if (is_below(path, changed)) place.override_text = option;
  std::string text = format(content.name, {place, path, ""});
  text.erase(text.size() - 2);
  return text;
}

}  // namespace couplet::config
