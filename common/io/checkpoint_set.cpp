// SPDX-License-Identifier: Apache-2.0
#include "common/io/checkpoint_set.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <fstream>
#include <sstream>
#include <tuple>

#include "common/base/error.hpp"
#include "common/base/own_file.hpp"
#include "common/base/text.hpp"
#include "common/log/log.hpp"

namespace couplet::io {
namespace {

namespace fs = std::filesystem;

constexpr const char *list_name = "set.txt", *pending_name = "set.part",
                     *first_line = "couplet checkpoint set 1";

std::string read_text(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// Returns true if a run writes files of this name into a set.
bool is_ours(const fs::path& file) {
  const std::string name = file.filename().string();
  if (fs::is_symlink(file) || !fs::is_regular_file(file)) return false;
  return name == list_name || name == pending_name || name == "keys.txt" || name.ends_with(".h5") ||
         name.ends_with(".h5.part");
}

/// Returns true for a folder (not a link) with a complete or partial set. Sets older than `set.txt` contain
/// only HDF5 files.
bool holds_a_set(const fs::path& folder) {
  if (fs::is_symlink(folder) || !fs::is_directory(folder)) return false;
  for (const char* name : {list_name, pending_name})
    if (const fs::path file = folder / name; is_ours(file)) return read_text(file).starts_with(first_line);
  const fs::directory_iterator entries(folder), end;
  return std::all_of(entries, end, [](const fs::directory_entry& e) { return is_ours(e.path()); });
}

/// Files listed below the folder. Others are ignored, since a damaged list must not lead out of it.
std::vector<fs::path> listed(const fs::path& folder) {
  std::vector<fs::path> files;
  try {
    if (const auto set = read_checkpoint_set(folder))
      for (const CheckpointSet::File& file : set->files) {
        const fs::path name = fs::path(file.name).lexically_normal();
        if (name.is_relative() && !name.empty() && *name.begin() != "..") files.push_back(folder / name);
      }
  } catch (const Error&) {  // damaged: only our own files are removed
  }
  return files;
}

void remove_empty_folders(const fs::path& folder) {
  std::vector<fs::path> below;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_directory() && !entry.is_symlink()) below.push_back(entry.path());
  std::error_code not_empty;
  for (auto it = below.rbegin(); it != below.rend(); ++it) fs::remove(*it, not_empty);
}

/// Removes the list first, so that a partially removed set is not valid.
void clear(const fs::path& folder) {
  std::vector<fs::path> ours = listed(folder);
  fs::remove(folder / list_name);
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (is_ours(entry.path()) && entry.path().filename() != pending_name) ours.push_back(entry.path());
  for (const fs::path& file : ours) fs::remove(file);
  if (is_ours(folder / pending_name)) fs::remove(folder / pending_name);
  remove_empty_folders(folder);
}

std::string with_digest(const std::string& text) {
  return text + fmt::format("digest {:016x}\n", base::stable_hash(text));
}

template <class T>
bool parse(std::string_view word, T& value, int base) {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value, base);
  return error == std::errc() && end == word.data() + word.size();
}

/// Parses the text of finish_checkpoint_set. Returns nothing for any other text.
std::optional<CheckpointSet> parse_list(const std::string& text) {
  const std::size_t at = text.rfind("digest ");
  if (at == std::string::npos || !text.starts_with(first_line) || with_digest(text.substr(0, at)) != text)
    return {};
  CheckpointSet set;
  std::istringstream lines(text.substr(0, at));
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    std::vector<std::string> words = base::split(line, ' ');
    const auto is = [&](const char* key, std::size_t n) { return words[0] == key && words.size() == n; };
    bool good = true;
    if (is("run", 2)) {
      set.stamp.run = words[1];
    } else if (is("step", 2)) {
      good = parse(words[1], set.stamp.step, 10);
    } else if (is("time", 2)) {
      const auto [end, error] =
          std::from_chars(words[1].data(), words[1].data() + words[1].size(), set.stamp.time);
      good = error == std::errc();
    } else if (words.size() >= 4 && words[0] == "file") {  // the name is last because it may contain blanks
      CheckpointSet::File file;
      good = parse(words[1], file.size, 10) && parse(words[2], file.digest, 16);
      file.name = base::join({words.begin() + 3, words.end()}, " ");
      set.files.push_back(file);
    } else if (words[0] == "continues") {
      set.continues.assign(words.begin() + 1, words.end());
    } else {
      good = false;
    }
    if (!good) return {};
  }
  return set;
}

}  // namespace

std::string CheckpointStamp::text() const {
  return fmt::format("run {}\nstep {}\ntime {}\n", run, step, time);
}

std::uint64_t digest_of_file(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw Error("The file '{}' cannot be read.", file.string());
  // FNV-1a over 64-bit words. Each step is bijective, so a change of a single word changes the digest.
  std::uint64_t hash = 14695981039346656037ull;
  std::vector<char> block(1 << 20);
  while (stream) {
    stream.read(block.data(), static_cast<std::streamsize>(block.size()));
    const auto n = static_cast<std::size_t>(stream.gcount());
    for (std::size_t i = 0; i < n; i += sizeof(std::uint64_t)) {
      std::uint64_t word = 0;
      std::memcpy(&word, &block[i], std::min(sizeof word, n - i));
      hash = (hash ^ word) * 1099511628211ull;
      hash ^= hash >> 29;
    }
  }
  if (stream.bad()) throw Error("The file '{}' cannot be read.", file.string());
  return hash;
}

std::optional<CheckpointSet> read_checkpoint_set(const fs::path& folder) {
  const fs::path file = folder / list_name;
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return {};
  auto set = parse_list(read_text(file));
  if (!set)
    throw Error("'{}', the list of files of a checkpoint, is damaged. Use an earlier checkpoint.",
                file.string());
  return set;
}

std::string stamp_being_written(const fs::path& folder) {
  const fs::path file = folder / pending_name;
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return "";
  const std::string text = read_text(file);
  return text.starts_with(first_line) ? text.substr(std::min(text.size(), std::strlen(first_line) + 1)) : "";
}

std::string problem_in_set(const fs::path& file) {
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  const auto set = read_checkpoint_set(folder);
  if (!set) return "";
  const std::string name = file.filename().string();
  const auto entry = std::find_if(set->files.begin(), set->files.end(),
                                  [&](const CheckpointSet::File& f) { return f.name == name; });
  if (entry == set->files.end())
    return fmt::format(
        "'{}' does not belong to the checkpoint in its folder: it is not listed in {}. The run that wrote "
        "the set had no such participant.",
        file.string(), list_name);
  std::error_code failed;
  const auto size = fs::file_size(file, failed);
  if (failed) return fmt::format("The checkpoint file '{}' is missing or cannot be read.", file.string());
  if (size == entry->size && digest_of_file(file) == entry->digest) return "";
  return fmt::format(
      "'{}' is not the file written with this checkpoint (step {}, t = {:g} s of run {}): {}. It is "
      "damaged, or from another set. Use another checkpoint.",
      file.string(), set->stamp.step, set->stamp.time, set->stamp.run,
      size == entry->size ? std::string("its digest differs")
                          : fmt::format("it has {} bytes instead of {}", size, entry->size));
}

fs::path begin_checkpoint_set(const fs::path& parent, const CheckpointStamp& stamp) {
  fs::path folder = parent / fmt::format("step-{:08d}", stamp.step);
  if (fs::exists(fs::symlink_status(folder)) && !holds_a_set(folder)) folder += "-" + stamp.run;
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) throw Error("Cannot create the checkpoint folder {}: {}.", folder.string(), failed.message());
  try {
    clear(folder);
    if (!fs::is_empty(folder)) {  // files of others
      folder = parent / fmt::format("step-{:08d}-{}", stamp.step, stamp.run);
      fs::create_directories(folder);
      clear(folder);
    }
    base::write_file(folder / pending_name, fmt::format("{}\n{}", first_line, stamp.text()), true);
  } catch (const fs::filesystem_error& error) {
    throw Error("Cannot remove the earlier checkpoint in {}: {}.", folder.string(), error.code().message());
  }
  return folder;
}

// The folder was empty at the start, so all files in it belong to the set.
void finish_checkpoint_set(const fs::path& folder, const CheckpointStamp& stamp,
                           const std::vector<std::string>& continues) {
  std::string text = fmt::format("{}\n{}", first_line, stamp.text());
  if (!continues.empty()) text += "continues " + base::join(continues, " ") + "\n";
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file() && !entry.is_symlink() && entry.path().extension() != ".part" &&
        entry.path() != folder / list_name)
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files)
    text += fmt::format("file {} {:016x} {}\n", fs::file_size(file), digest_of_file(file),
                        file.lexically_relative(folder).string());
  base::write_file(folder / list_name, with_digest(text), true);
  fs::remove(folder / pending_name);
}

std::vector<FoundSet> checkpoint_sets(const fs::path& parent) {
  std::vector<FoundSet> found;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(parent, ignored)) {
    if (!entry.path().filename().string().starts_with("step-") || !fs::is_directory(entry.path(), ignored))
      continue;
    try {
      if (const auto set = read_checkpoint_set(entry.path())) found.push_back({entry.path(), set->stamp});
    } catch (const Error&) {
      continue;
    }
  }
  std::sort(found.begin(), found.end(), [](const FoundSet& a, const FoundSet& b) {
    return std::tie(a.stamp.time, a.stamp.step, a.folder) < std::tie(b.stamp.time, b.stamp.step, b.folder);
  });
  return found;
}

void warn_if_lost(const fs::path& output, double restart_time) {
  if (fs::exists(output)) return;
  for (const FoundSet& set : checkpoint_sets(output.parent_path().parent_path() / "checkpoints"))
    if (set.stamp.time == restart_time) {
      log::warn("'{}' did not exist at the restart: it begins at t = {:g} s, where the run continues.",
                output.string(), restart_time);
      return;
    }
}

void remove_checkpoint_set(const fs::path& folder) {
  if (!holds_a_set(folder)) return;
  clear(folder);
  std::error_code not_empty;
  fs::remove(folder, not_empty);
}

std::vector<fs::path> clear_incomplete_sets(const fs::path& parent) {
  std::vector<fs::path> cleared;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(parent, ignored))
    if (entry.path().filename().string().starts_with("step-") && holds_a_set(entry.path()) &&
        fs::exists(entry.path() / pending_name) && !fs::exists(entry.path() / list_name))
      cleared.push_back(entry.path());
  for (const fs::path& folder : cleared) remove_checkpoint_set(folder);
  return cleared;
}

}  // namespace couplet::io
