// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

namespace couplet::base {

/// Returns `file` if it does not exist or is a regular file. Throws Error for a symbolic link, which would
/// overwrite another file, and for anything that is not a file.
const std::filesystem::path& own_file(const std::filesystem::path& file);

/// Replaces a text file of a run. The text is written beside it and then renamed, so that the file is never
/// partial. Throws Error if any write, flush, close or rename fails. `durable` waits until it is on disk.
void write_file(const std::filesystem::path& file, std::string_view text, bool durable = false);

/// Waits until the content of a file or folder is on disk. Throws Error on failure.
void flush_to_disk(const std::filesystem::path& path);

}  // namespace couplet::base
