// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

namespace couplet::base {

/// Returns `file` if it does not exist or is a regular file. Throws Error for a symbolic link, which would
/// overwrite another file, and for anything that is not a file.
const std::filesystem::path& own_file(const std::filesystem::path& file);

/// Replaces a text file of a run. The text is written beside it and then renamed, so that the file is never
/// partial. Throws Error if any write, flush, close or rename fails. `durable` waits until it is on disk.
/// Written later if files are held.
void write_file(const std::filesystem::path& file, std::string_view text, bool durable = false);
/// As above, for a long text in parts until `next` returns an empty one. It must own what it returns.
void write_file(const std::filesystem::path& file, const std::function<std::string_view()>& next,
                bool durable = false);

/// Makes write_file() and when_started() wait for release_files(), so that a start that fails leaves the
/// results of an earlier run as they are.
void hold_files();
/// Does all that waits, in order, once the start has succeeded. Does nothing if nothing is held.
void release_files();
/// Calls `write` at once, or from release_files() while files are held.
void when_started(std::function<void()> write);

/// Waits until the content of a file or folder is on disk. Throws Error on failure.
void flush_to_disk(const std::filesystem::path& path);

}  // namespace couplet::base
