// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/gmsh/mesh_cache.hpp"

#include <fstream>
#include <sstream>
#include <string>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/log/log.hpp"

namespace couplet::mesh {
namespace {

constexpr std::string_view head = "$Comments\ncouplet ";

std::string text_if_any(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::string seal_of(std::string_view text, const std::string& name) {
  const std::size_t digest = base::stable_hash(fmt::format("{}\n{:016x}", name, base::stable_hash(text)));
  return fmt::format("{}{:016x}\n$EndComments\n", head, digest);
}

}  // namespace

void seal_cache(const std::filesystem::path& file, const std::string& name) {
  const std::string seal = seal_of(text_if_any(file), name);
  std::ofstream out(file, std::ios::binary | std::ios::app);
  out << seal;
  out.close();
  if (!out) throw Error("Cannot write the mesh '{}'. Check the disk space.", file.string());
}

bool is_sound_cache(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) return false;
  const std::string text = text_if_any(file);
  const std::size_t at = text.rfind(head);
  if (at != std::string::npos && std::string_view(text).substr(at) ==
                                     seal_of(std::string_view(text).substr(0, at), file.filename().string()))
    return true;
  log::warn("The cached mesh '{}' is damaged, or not written by Couplet; it is regenerated.", file.string());
  return false;
}

}  // namespace couplet::mesh
