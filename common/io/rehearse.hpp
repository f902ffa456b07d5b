// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace couplet::io {

/// What a library does to a file that somebody else may have made or damaged is tried in a forked process first, with
/// limits of memory (512 MB beyond what is in use, and four times the file) and processor time (2 s, and 1 s for each
/// 25 MB), which cannot write. The fork has the same memory, so what it survives does no harm here either. Throws Error with the message
/// of what `read` threw there, or, if the process crashed or met a limit, naming the file. Runs no part of `read` here.
/// Where no process can be forked this is logged and nothing is tried. On this rank alone; `read` must not use MPI.
void rehearse(const std::filesystem::path& file, const std::string& what, const std::function<void()>& read);

}  // namespace couplet::io
