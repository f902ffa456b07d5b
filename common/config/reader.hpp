// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/config/document.hpp"
#include "common/config/load.hpp"
#include "common/config/section.hpp"

namespace couplet::config {

/// Fills the members from a mapping and collects all errors.
class Reader final {
 public:
  explicit Reader(const Document::Content& content, CheckExpression check_expression = {})
      : content_(content), check_expression_(std::move(check_expression)) {}

  /// Reads a mapping. If `node` is undefined, defaults apply, and required keys are missing at `place`.
  void read_mapping(const YAML::Node& node, const Place& place, const std::string& path,
                    const Section::Declare& declare);
  const std::vector<Message>& messages() const { return messages_; }
  /// Possible but implausible values.
  const std::vector<Message>& doubts() const { return doubts_; }

 private:
  /// Mapping that is being read.
  struct Frame {
    YAML::Node node;
    Place place;
    std::string path;
    std::vector<std::string> known;
    std::vector<std::pair<std::string, std::string>> elsewhere;  ///< key and the variant case it belongs to
    std::size_t messages_before = 0;
    std::optional<int> dimension;  ///< value of the key `dimension`
    bool wrong_key = false;        ///< a key of this mapping could not be read
  };
  /// Processes one declaration, as visitor of the sections.
  void on(const Declaration& declaration);
  void key(const KeyFacts& facts, const Slot& slot);
  /// Reads the contents of a section, optional, map or list.
  void below(const Declaration& declaration);
  void variant(const Declaration& declaration);
  Entry take(std::string_view name);
  Message message(const Place& place, const std::string& path, const std::string& text) const;
  void report(const Place& place, const std::string& path, const std::string& text);
  void report_key(const Place& place, const std::string& path, const std::string& text);
  void report_unknown_keys();
  /// Text " Its keys: a, b." for a value that should be a mapping.
  std::string keys_of(const Place& place, const std::string& path, const Section::Declare& declare);
  /// Applies a rule across keys, unless a key that it may depend on is invalid.
  void apply_rule(const Declaration& declaration);
  /// Removes the message about a missing key, because a misspelled required key is one mistake.
  void forget_missing(const std::string& path);

  /// Problem of the expressions of a key. A list of them is a vector with the `dimension` of a surrounding
  /// mapping.
  std::string problem_of(const KeyFacts& facts, const Slot& slot) const;

  const Document::Content& content_;
  CheckExpression check_expression_;
  const Visitor visitor_ = [this](const Declaration& declaration) { on(declaration); };
  std::vector<Frame> frames_;
  std::vector<Message> messages_, doubts_;
};

}  // namespace couplet::config
