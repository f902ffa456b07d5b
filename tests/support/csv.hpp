// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "common/base/error.hpp"

namespace couplet::support {

/// Numbers of a CSV file below its header. Lines that begin with # are comments. Throws Error if it cannot be read.
struct Csv {
  std::string header;
  std::vector<std::vector<double>> rows;

  explicit Csv(const std::filesystem::path& file) {
    std::ifstream in(file);
    if (!in) throw Error("{} cannot be read", file.string());
    for (std::string line, word; std::getline(in, line);) {
      if (line.empty() || line[0] == '#') continue;
      if (header.empty()) {
        header = line;
        continue;
      }
      rows.emplace_back();
      for (std::istringstream words(line); std::getline(words, word, ',');)
        rows.back().push_back(std::stod(word));
    }
  }
  std::map<std::string, std::vector<double>> columns() const {
    std::map<std::string, std::vector<double>> columns;
    std::istringstream names(header);
    std::string name;
    for (std::size_t i = 0; std::getline(names, name, ','); ++i)
      for (const std::vector<double>& row : rows) columns[name].push_back(row.at(i));
    return columns;
  }
};

}  // namespace couplet::support
