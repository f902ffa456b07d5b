// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace couplet::base {

/// `file` if a program may write it: there is nothing yet, or a regular file of an earlier run. Throws Error for
/// a symbolic link, which would be written through into somebody else's file, and for anything that is no file.
const std::filesystem::path& own_file(const std::filesystem::path& file);

/// Waits until the file's (or folder's) content is on the disk.
void flush_to_disk(const std::filesystem::path& path);

}  // namespace couplet::base
