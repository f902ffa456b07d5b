// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/base/types.hpp"

namespace couplet::io {

/// Identifies the accepted state of a checkpoint. Every file of a set contains the same stamp.
struct CheckpointStamp {
  std::string run;       ///< id of the run that wrote it
  GlobalIndex step = 0;  ///< steps accepted
  double time = 0;       ///< [s]
  std::string text() const;
};

/// Folder with the files of all programs of a run at one accepted time, including those that guest programs
/// write in their own formats. `set.txt` lists them with sizes and digests. It is written last, so a folder
/// that contains it is complete. Until then `set.part` holds the stamp for the files of each program.
struct CheckpointSet {
  CheckpointStamp stamp;
  struct File {
    std::string name;
    std::uintmax_t size = 0;
    std::uint64_t digest = 0;
  };
  std::vector<File> files;  ///< names relative to the folder
  /// Ids of the earlier runs that this run resumes and whose sets it takes over.
  std::vector<std::string> continues;
};

/// Digest of all bytes of a file, which changes with any 64-bit word. Throws Error if the file cannot be
/// read.
std::uint64_t digest_of_file(const std::filesystem::path& file);

/// Reads `set.txt`. Returns nothing if there is none. Throws Error if it is damaged.
std::optional<CheckpointSet> read_checkpoint_set(const std::filesystem::path& folder);
/// Stamp of the set that is being written into this folder. Empty if there is none.
std::string stamp_being_written(const std::filesystem::path& folder);
/// Reason why a file of a set is invalid: not listed, or another size or digest. Empty if it is valid or the
/// folder holds no set. Throws Error if `set.txt` is damaged.
std::string problem_in_set(const std::filesystem::path& file);

/// Prepares `parent`/step-<step> for a new set and returns its path. Removes an earlier set of ours there. If
/// anything else has that name, it is kept and the run's id is appended to the new name. Throws Error if the
/// folder cannot be created.
std::filesystem::path begin_checkpoint_set(const std::filesystem::path& parent, const CheckpointStamp& stamp);
/// Lists all files of the complete set in `set.txt`. Throws Error on failure.
void finish_checkpoint_set(const std::filesystem::path& folder, const CheckpointStamp& stamp,
                           const std::vector<std::string>& continues = {});

/// Complete set found below a folder.
struct FoundSet {
  std::filesystem::path folder;
  CheckpointStamp stamp;
};
/// Complete sets in the folders step-* of `parent`, sorted by time, then step. Unreadable sets are omitted.
std::vector<FoundSet> checkpoint_sets(const std::filesystem::path& parent);
/// Warns if an output is missing that continues from a checkpoint in its own output folder: what the run wrote
/// before is lost. Call it on one rank. Nothing is missing in another folder.
void warn_if_lost(const std::filesystem::path& output, double restart_time);
/// Removes the files of this set, including those of guest programs, and the folder if it is then empty.
void remove_checkpoint_set(const std::filesystem::path& folder);
/// Removes incomplete sets of interrupted runs from `parent` and returns their folders.
std::vector<std::filesystem::path> clear_incomplete_sets(const std::filesystem::path& parent);

}  // namespace couplet::io
