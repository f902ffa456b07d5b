// SPDX-License-Identifier: Apache-2.0
// Definition of couplet_client, private to the client library.
#pragma once

#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "wire.hpp"

struct couplet_client {
  std::string participant;
  MPI_Comm comm = MPI_COMM_NULL;
  std::unique_ptr<couplet::wire::Link> coupler;
  int rank = 0;
  couplet::wire::Surface surface;
  std::vector<couplet::wire::Datum> takes, gives;
  std::vector<std::int64_t> vertex_cut, face_cut;
  std::vector<couplet::wire::Peer> peers;
  // State of the current command.
  couplet::wire::Command command;
  bool pending = false;
  std::map<std::string, std::vector<double>> input, output, spare;  // spare: arrays of outputs that were sent
  std::int64_t status = 0;
  std::string text, checkpoint, introduction;
  double time = 0, dt = 0;  // of the last step that began
  double advised = std::numeric_limits<double>::infinity();
  std::int64_t iterations = 0;
  double error = NAN, energy = NAN, started = 0;
  bool described = false;
  bool started_mpi = false;
};

namespace couplet::wire {

/// Ends the whole job with a message.
[[noreturn]] void end_the_job(const std::string& text);
std::size_t entries(const couplet_client& c, const Datum& d);
/// Finds a datum by its name or that of a value within the step ("datum@share"). nullptr if there is none.
const Datum* find(const std::vector<Datum>& list, const std::string& name);
/// Stores a value for the next reply.
void take_over(couplet_client& c, const std::string& name, const double* values, std::size_t count);
/// Name of the value of a datum at a share in (0, 1) of the step.
std::string within_name(const std::string& datum, double share);

}  // namespace couplet::wire
