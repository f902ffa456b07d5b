// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "common/modes/modal_model.hpp"

namespace couplet::modes {

/// Writes a modal model to one HDF5 file (docs/formats.md, "Modes"), under a temporary name that is renamed
/// when it is complete. `key` tells what the modes were made of. On this rank alone. Throws Error.
void write_modes(const std::filesystem::path& file, const ModalModel& model, const std::string& key);

/// Reads one, whoever wrote it. Throws Error naming the file and what is wrong with it.
ModalModel read_modes(const std::filesystem::path& file);

/// The key of a file of modes; empty if there is no such file or it is none of modes.
std::string key_of_modes(const std::filesystem::path& file);

}  // namespace couplet::modes
