// SPDX-License-Identifier: Apache-2.0
// The coupler's residuals.csv, step by step.
#pragma once
#include "tests/support/test.hpp"

namespace couplet::tests {

struct Residuals {
  struct Pass {
    double relative = 0, absolute = 0, relaxation = 0;
  };
  std::vector<std::vector<Pass>> steps;
  double mean_iterations() const {
    std::size_t sum = 0;
    for (const auto& step : steps) sum += step.size();
    return steps.empty() ? 0 : double(sum) / double(steps.size());
  }
};

inline Residuals read_residuals(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  Residuals result;
  while (std::getline(in, line)) {
    std::vector<double> row;
    std::istringstream words(line);
    for (std::string word; std::getline(words, word, ',');) row.push_back(std::stod(word));
    if (row[3] == 1) result.steps.emplace_back();
    result.steps.back().push_back({row[4], row[5], row[6]});
  }
  return result;
}

}  // namespace couplet::tests
