// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/config/section.hpp"

namespace couplet::config {

/// A parsed YAML file: text, positions and duplicate keys known. Throws Error with file:line:column on broken
/// YAML, duplicate keys (with both places) or an unreadable file.
class Document {
 public:
  static Document read(const std::filesystem::path& file);
  static Document parse(const std::string& text, const std::string& name = "<text>");
  ~Document();
  Document(Document&&) noexcept;
  /// Overrides one value: "participants.solid.material.density=1000" (command line --set); without a value,
  /// or with ~, the key is removed. Throws Error on a bad path.
  void set(const std::string& assignment);
  const std::string& name() const;
  /// Same for equal text after overrides; compared at the roll call of a coupled job.
  std::size_t hash() const;
  struct Content;
  const Content& content() const { return *content_; }

 private:
  Document();
  std::unique_ptr<Content> content_;
};

/// Reads the mapping at `path` (dotted, "" is the whole file, e.g. "participants.solid") into whatever
/// `declare` binds. Every message is "file:line:column: key.path: text". Returns all of them, in file order;
/// empty means valid.
/// `check_expression` says what is wrong with the text of an expression or a table (nothing: ""); it stands above this
/// folder. `doubts` gets, in the same form, what is possible but implausible.
using CheckExpression = std::function<std::string(const ExpressionText&)>;
std::vector<std::string> load(const Document& document, const std::string& path,
                              const Section::Declare& declare, const CheckExpression& check_expression = {},
                              std::vector<std::string>* doubts = nullptr);
/// The same; throws one Error with all messages, one a line.
void load_or_throw(const Document& document, const std::string& path, const Section::Declare& declare);

/// Names of the keys of the mapping at `path`, in file order (empty if absent).
std::vector<std::string> keys_of(const Document& document, const std::string& path);
/// The scalar at `path` as text, if it is there.
std::optional<std::string> text_of(const Document& document, const std::string& path);
/// The scalars of the list at `path` as texts; empty if there is no such list.
std::vector<std::string> texts_of(const Document& document, const std::string& path);

/// "case.yaml:12:5: participants.solid.program", the start of a message of one's own; with the place of the
/// nearest mapping above if there is no such key.
std::string where(const Document& document, const std::string& path);

/// Markdown reference: a table a section (key, type, unit, default, range, meaning). It and the schema put
/// sample entries into the maps, lists and optional members: give them a fresh object.
std::string markdown(const std::string& title, const Section::Declare& declare);
/// JSON schema (draft 2020-12) of the section, for editors.
std::string json_schema(const std::string& title, const Section::Declare& declare);
/// All values in force, as YAML with units in comments (--print-config, effective.yaml).
std::string effective(const Section::Declare& declare);

}  // namespace couplet::config
