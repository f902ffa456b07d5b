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

/// Fills the members from a mapping and collects everything that is wrong with it.
class Reader final {
 public:
  explicit Reader(const Document::Content& content, CheckExpression check_expression = {})
      : content_(content), check_expression_(std::move(check_expression)) {}

  /// `node` may be undefined: all defaults, required keys are missing at `place`.
  void read_mapping(const YAML::Node& node, const Place& place, const std::string& path,
                    const Section::Declare& declare);
  const std::vector<Message>& messages() const { return messages_; }
  /// What is possible but implausible.
  const std::vector<Message>& doubts() const { return doubts_; }

 private:
  /// The mapping that is being read.
  struct Frame {
    YAML::Node node;
    Place place;
    std::string path;
    std::vector<std::string> known;
    std::vector<std::pair<std::string, std::string>> elsewhere;  ///< key, the variant case it belongs to
    std::size_t messages_before = 0;
    std::optional<int> dimension;  ///< value of the key of this name
    bool wrong_key = false;        ///< one of the keys in this very mapping could not be read
  };
  /// Takes in one declaration; the visitor of the sections.
  void on(const Declaration& declaration);
  void key(const KeyFacts& facts, const Slot& slot);
  /// What stands below a section, optional, map or list.
  void below(const Declaration& declaration);
  void variant(const Declaration& declaration);
  Entry take(std::string_view name);
  Message message(const Place& place, const std::string& path, const std::string& text) const;
  void report(const Place& place, const std::string& path, const std::string& text);
  void report_key(const Place& place, const std::string& path, const std::string& text);
  void report_unknown_keys();
  /// " Its keys: a, b." of a mapping that is none.
  std::string keys_of(const Place& place, const std::string& path, const Section::Declare& declare);
  /// Runs a rule across keys, if nothing that it may look at is wrong.
  void apply_rule(const Declaration& declaration);
  /// A misspelt required key is one mistake, not two.
  void forget_missing(const std::string& path);

  /// What is wrong with the expressions of a key that was read; a list of them is a vector of the scene, whose
  /// `dimension` stands in one of the mappings around it.
  std::string problem_of(const KeyFacts& facts, const Slot& slot) const;

  const Document::Content& content_;
  CheckExpression check_expression_;
  const Visitor visitor_ = [this](const Declaration& declaration) { on(declaration); };
  std::vector<Frame> frames_;
  std::vector<Message> messages_, doubts_;
};

}  // namespace couplet::config
