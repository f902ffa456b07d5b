// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/config/section.hpp"

namespace couplet::config {

/// Parsed YAML file that keeps text, positions and duplicate keys. Throws Error with file:line:column for
/// invalid YAML, duplicate keys (with both positions) or an unreadable file.
class Document {
 public:
  static Document read(const std::filesystem::path& file);
  static Document parse(const std::string& text, const std::string& name = "<text>");
  ~Document();
  Document(Document&&) noexcept;
  /// Overrides one value: "participants.solid.material.density=1000" (--set). Without a value, or with ~, the
  /// key is removed. Throws Error for an invalid path.
  void set(const std::string& assignment);
  const std::string& name() const;
  /// Hash of the text with overrides, compared at the roll call of a coupled job.
  std::size_t hash() const;
  struct Content;
  const Content& content() const { return *content_; }

 private:
  Document();
  std::unique_ptr<Content> content_;
};

/// Reads the mapping at `path` (dotted, "" is the whole file, e.g. "participants.solid") into the members
/// that `declare` binds. Returns all errors as "file:line:column: key.path: text" in file order; empty means
/// valid. `check_expression` returns the problem of an expression or table, or ""; it belongs to a higher
/// layer. `doubts` receives implausible values in the same form.
using CheckExpression = std::function<std::string(const ExpressionText&)>;
std::vector<std::string> load(const Document& document, const std::string& path,
                              const Section::Declare& declare, const CheckExpression& check_expression = {},
                              std::vector<std::string>* doubts = nullptr);
/// Like load(), but throws one Error with all messages, one per line.
void load_or_throw(const Document& document, const std::string& path, const Section::Declare& declare);

/// Keys of the mapping at `path` in file order. Empty if it is absent.
std::vector<std::string> keys_of(const Document& document, const std::string& path);
/// Scalar at `path` as text, if it exists.
std::optional<std::string> text_of(const Document& document, const std::string& path);
/// Scalars of the list at `path` as texts. Empty if there is no such list.
std::vector<std::string> texts_of(const Document& document, const std::string& path);

/// Start of a message: "case.yaml:12:5: participants.solid.program". If the key does not exist, the location
/// is that of the nearest mapping above.
std::string where(const Document& document, const std::string& path);

/// Markdown reference with a table per section (key, type, unit, default, range, meaning). This and the
/// schema add sample entries to maps, lists and optional members, so use a new object.
std::string markdown(const std::string& title, const Section::Declare& declare);
/// JSON schema (draft 2020-12) of the section, for editors.
std::string json_schema(const std::string& title, const Section::Declare& declare);
/// Effective values as YAML with units in comments (--print-config, effective.yaml).
std::string effective(const Section::Declare& declare);

}  // namespace couplet::config
