// SPDX-License-Identifier: Apache-2.0
#include "tests/support/chosen_files.hpp"

#include <fnmatch.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace couplet::testing {
namespace {

std::vector<std::string> split(const std::string& text, char mark) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, mark);) parts.push_back(part);
  return parts;
}

bool matches(const std::string& name, const std::vector<std::string>& patterns) {
  return std::any_of(patterns.begin(), patterns.end(),
                     [&](const std::string& p) { return fnmatch(p.c_str(), name.c_str(), 0) == 0; });
}

/// What a filter of GoogleTest says: patterns, after a minus those that are left out.
bool passes(const std::string& name, const std::string& filter) {
  const auto minus = filter.find('-');
  const auto wanted = split(filter.substr(0, minus), ':');
  if (minus != std::string::npos && matches(name, split(filter.substr(minus + 1), ':'))) return false;
  return wanted.empty() || matches(name, wanted);
}

/// The filter for the tests of the named sources; takes the names of sources that have tests out of the set.
std::string filter_for(std::set<std::string>& files, const std::string& given) {
  const auto& all = *::testing::UnitTest::GetInstance();
  const std::set<std::string> named = files;
  std::string filter, strangers;
  for (int s = 0; s < all.total_test_suite_count(); ++s) {
    const auto& suite = *all.GetTestSuite(s);
    std::string chosen;
    int count = 0;
    std::map<std::string, bool> of_named;
    for (int t = 0; t < suite.total_test_count(); ++t) {
      const auto& test = *suite.GetTestInfo(t);
      const std::string path = test.file(), file = path.substr(path.rfind('/') + 1);
      const std::string name = std::string(suite.name()) + "." + test.name();
      files.erase(file);
      const auto [other, first] = of_named.emplace(name, named.count(file) > 0);
      if (!first && other->second != (named.count(file) > 0)) strangers += " " + name;
      if (!named.count(file) || !passes(name, given)) continue;
      chosen += ":" + name;
      ++count;
    }
    if (count == suite.total_test_count()) chosen = std::string(":") + suite.name() + ".*";
    filter += chosen;
  }
  for (const std::string& name : split(strangers, ' '))
    if (!name.empty()) files.insert(name + " (a test of this name is in another source)");
  return filter.empty() ? "-*" : filter.substr(1);
}

}  // namespace

bool choose_files(int& argc, char** argv) {
  const std::string option = "--only=";
  const auto end = argv + argc;
  const auto at =
      std::find_if(argv, end, [&](const char* a) { return std::string(a).rfind(option, 0) == 0; });
  if (at == end) return true;
  const auto names = split(std::string(*at).substr(option.size()), ',');
  std::set<std::string> missing(names.begin(), names.end());
  std::copy(at + 1, end, at);
  argv[--argc] = nullptr;
  ::testing::GTEST_FLAG(filter) = filter_for(missing, ::testing::GTEST_FLAG(filter));
  if (::testing::GTEST_FLAG(filter) == "-*") missing.insert("(no test passes the filter)");
  for (const std::string& file : missing) fprintf(stderr, "--only: no test of its own: %s\n", file.c_str());
  return missing.empty();
}

}  // namespace couplet::testing
