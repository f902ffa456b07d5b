// SPDX-License-Identifier: Apache-2.0
#include "common/base/own_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include "common/base/error.hpp"

namespace couplet::base {

const std::filesystem::path& own_file(const std::filesystem::path& file) {
  std::error_code ignored;
  const auto status = std::filesystem::symlink_status(file, ignored);
  if (!std::filesystem::exists(status) || std::filesystem::is_regular_file(status)) return file;
  throw Error(
      "'{}' is {}; a run does not write there. Move it, or set another `simulation.output.folder`.",
      file.string(),
      std::filesystem::is_symlink(status) ? "a symbolic link, which would lead to another file" : "no file");
}

void flush_to_disk(const std::filesystem::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY);
  if (file < 0) return;
  ::fsync(file);
  ::close(file);
}

}  // namespace couplet::base
