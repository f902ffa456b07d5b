// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/base/types.hpp"

namespace couplet::io {

/// Which accepted state a checkpoint holds: the same words stand in every file of the set.
struct CheckpointStamp {
  std::string run;       ///< id of the run that wrote it
  GlobalIndex step = 0;  ///< steps accepted
  double time = 0;       ///< [s]
  std::string text() const;
};

/// A folder with the files of all programs of a run at one accepted time, those that guest programs write in their own
/// formats, too. `set.txt` lists them with their sizes and digests and is written last: a folder that has it is complete. While the files are being written there
/// is `set.part` in its place, from which each program takes the stamp for its own file.
struct CheckpointSet {
  CheckpointStamp stamp;
  struct File {
    std::string name;
    std::uintmax_t size = 0;
    std::uint64_t digest = 0;
  };
  std::vector<File> files;  ///< names relative to the folder
  std::vector<std::string>
      continues;  ///< ids of the runs before, whose sets this run goes on from and takes over
};

/// Digest over all bytes of a file: any change of one 64-bit word changes it. Throws Error if the file cannot be
/// read.
std::uint64_t digest_of_file(const std::filesystem::path& file);

/// Reads `set.txt`; nothing if there is none. Throws Error if it is damaged.
std::optional<CheckpointSet> read_checkpoint_set(const std::filesystem::path& folder);
/// The stamp of the set that is being written into this folder; empty if there is none.
std::string stamp_being_written(const std::filesystem::path& folder);
/// What is wrong with one file of the set in its folder: not listed, another size, another digest; empty if nothing, or
/// if the folder holds no set. Throws Error if `set.txt` is damaged.
std::string problem_in_set(const std::filesystem::path& file);

/// Makes `parent`/step-<step> ready for a new set and gives its path. An earlier set there is taken away first; a
/// folder or a link that no run of ours made is left alone, and a name with the run's id behind it is taken. Throws
/// Error if the folder cannot be made.
std::filesystem::path begin_checkpoint_set(const std::filesystem::path& parent, const CheckpointStamp& stamp);
/// All files are there: lists them and puts `set.txt` in place. Throws Error on failure.
void finish_checkpoint_set(const std::filesystem::path& folder, const CheckpointStamp& stamp,
                           const std::vector<std::string>& continues = {});

/// A complete set found below a folder.
struct FoundSet {
  std::filesystem::path folder;
  CheckpointStamp stamp;
};
/// Complete sets in the folders step-* of `parent`, by time, then step. What cannot be read is left out.
std::vector<FoundSet> checkpoint_sets(const std::filesystem::path& parent);
/// Takes away the files of this set, those of guest programs, too, and the folder if nothing else is in it.
void remove_checkpoint_set(const std::filesystem::path& folder);
/// Takes away what runs that ended while they wrote have left in `parent`; gives the folders.
std::vector<std::filesystem::path> clear_incomplete_sets(const std::filesystem::path& parent);

}  // namespace couplet::io
