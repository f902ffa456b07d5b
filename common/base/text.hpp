// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace couplet::base {

std::string_view trim(std::string_view text);
std::vector<std::string> split(std::string_view text, char separator);
/// Joins words as "a, b, c".
std::string join(const std::vector<std::string>& words, std::string_view separator = ", ");

/// Number of insertions, deletions, replacements and swaps of neighbors that turn `a` into `b`.
std::size_t edit_distance(std::string_view a, std::string_view b);
/// Candidate that the user probably meant, if one is similar enough.
std::optional<std::string> closest(std::string_view word, const std::vector<std::string>& candidates);
/// Hint for an error: "Did you mean 'x'?", else "Valid <what>: a, b, c.", else "There are no <what> here."
std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates,
                         std::string_view what);

/// Checks for kebab case: lower-case words and digits joined by single hyphens.
bool is_kebab_case(std::string_view name);

/// Hash that is the same on every machine and in every build (64-bit FNV-1a).
std::size_t stable_hash(std::string_view text);

}  // namespace couplet::base
