// SPDX-License-Identifier: Apache-2.0
#include "common/base/own_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

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

namespace {

void expect(bool good, const std::filesystem::path& file) {
  if (!good)
    throw Error("Cannot write '{}' ({}). {}", file.string(), std::strerror(errno),
                errno == ENOENT ? "Was its folder removed during the run?" : "Is the disk full?");
}

/// Waits for the disk. Some file systems cannot flush (EINVAL), which is no failure to write.
void flush(int file, const std::filesystem::path& name) {
  expect(::fsync(file) == 0 || errno == EINVAL || errno == ENOTSUP, name);
}

bool holding = false;
std::vector<std::function<void()>> held;

}  // namespace

void hold_files() { holding = true; }

void release_files() {
  holding = false;
  for (const auto& write : std::exchange(held, {})) write();
}

void when_started(std::function<void()> write) {
  if (!holding) return write();
  held.push_back(std::move(write));
}

void write_file(const std::filesystem::path& file, std::string_view text, bool durable) {
  own_file(file);
  if (holding) return when_started([=, whole = std::string(text)] { write_file(file, whole, durable); });
  write_file(
      file, [&] { return std::exchange(text, {}); }, durable);
}

void write_file(const std::filesystem::path& file, const std::function<std::string_view()>& next,
                bool durable) {
  const std::filesystem::path part = own_file(file).string() + "~";
  if (holding) return when_started([=] { write_file(file, next, durable); });
  const int out = ::open(own_file(part).c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  expect(out >= 0, file);
  for (std::string_view text = next(); !text.empty(); text = next())
    while (!text.empty()) {
      const ssize_t n = ::write(out, text.data(), text.size());
      expect(n > 0 || (n < 0 && errno == EINTR), file);
      text.remove_prefix(std::size_t(std::max<ssize_t>(n, 0)));
    }
  if (durable) flush(out, file);
  expect(::close(out) == 0, file);
  expect(std::rename(part.c_str(), file.c_str()) == 0, file);
}

void flush_to_disk(const std::filesystem::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  expect(file >= 0, path);
  flush(file, path);
  expect(::close(file) == 0, path);
}

}  // namespace couplet::base
