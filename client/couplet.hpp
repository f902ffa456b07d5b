// SPDX-License-Identifier: Apache-2.0
// C++ interface to couplet.h with vectors.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "couplet.h"

namespace couplet {

class Client {
 public:
  Client(const std::string& participant, const std::string& program)
      : client_(couplet_join(participant.c_str(), program.c_str())) {}
  ~Client() { couplet_leave(client_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  MPI_Comm comm() const { return couplet_comm(client_); }
  void vertices(int dimension, const std::vector<double>& xyz) {
    n_vertices_ = xyz.size() / 3;
    dimension_ = dimension;
    couplet_vertices(client_, dimension, int(n_vertices_), xyz.data());
  }
  void faces(const std::vector<double>& centres, const std::vector<double>& areas,
             const std::vector<std::int64_t>& first = {}, const std::vector<std::int64_t>& vertices = {}) {
    n_faces_ = centres.size() / 3;
    couplet_faces(client_, int(n_faces_), centres.data(), areas.data(),
                  first.empty() ? nullptr : first.data(), vertices.data());
  }
  void takes(const std::string& datum, const std::string& unit, couplet_place place, int components = 0) {
    couplet_takes(client_, datum.c_str(), unit.c_str(), place, components);
    sizes_.push_back({datum, size(place, components)});
  }
  void gives(const std::string& datum, const std::string& unit, couplet_place place, int components = 0) {
    couplet_gives(client_, datum.c_str(), unit.c_str(), place, components);
    sizes_.push_back({datum, size(place, components)});
  }
  couplet_event next() { return couplet_next(client_); }
  double time() const { return couplet_time(client_); }
  double dt() const { return couplet_dt(client_); }
  int output() const { return couplet_output(client_); }
  std::string checkpoint() const { return couplet_checkpoint(client_); }
  /// Returns zeros if no participant has given the datum yet.
  std::vector<double> read(const std::string& datum) const {
    const std::size_t n = size_of(datum);
    const double* values = couplet_read(client_, datum.c_str());
    return values ? std::vector<double>(values, values + n) : std::vector<double>(n);
  }
  void write(const std::string& datum, const std::vector<double>& values) {
    if (values.size() != size_of(datum))
      throw std::invalid_argument("'" + datum + "' has " + std::to_string(size_of(datum)) + " values, not " +
                                  std::to_string(values.size()));
    couplet_write(client_, datum.c_str(), values.data());
  }
  void fail(const std::string& why, bool halving_helps = true) {
    couplet_fail(client_, why.c_str(), halving_helps);
  }
  void advise(double dt) { couplet_advise(client_, dt); }

 private:
  std::size_t size(couplet_place place, int components) const {
    return (place == COUPLET_VERTICES ? n_vertices_ : n_faces_) *
           std::size_t(components > 0 ? components : dimension_);
  }
  std::size_t size_of(const std::string& datum) const {
    for (const auto& [name, n] : sizes_)
      if (name == datum) return n;
    throw std::invalid_argument("'" + datum + "' was not announced");
  }
  couplet_client* client_;
  int dimension_ = 3;
  std::size_t n_vertices_ = 0, n_faces_ = 0;
  std::vector<std::pair<std::string, std::size_t>> sizes_;
};

}  // namespace couplet
