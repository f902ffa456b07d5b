// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace couplet::mesh {

/// Appends a digest of the file and of its `name` to a .msh 4.1, as a section that every reader passes over.
void seal_cache(const std::filesystem::path& file, const std::string& name);

/// Whether a cached mesh is as it was sealed under its name. One that is not (damaged, or of somebody else) is named in the
/// log, and is to be made anew.
bool is_sound_cache(const std::filesystem::path& file);

}  // namespace couplet::mesh
