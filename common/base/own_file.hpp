// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace couplet::base {

/// Returns `file` if it does not exist or is a regular file. Throws Error for a symbolic link, which would
/// overwrite another file, and for anything that is not a file.
const std::filesystem::path& own_file(const std::filesystem::path& file);

/// Waits until the content of a file or folder is on disk.
void flush_to_disk(const std::filesystem::path& path);

}  // namespace couplet::base
