// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "configuration.hpp"
#include "couplet.h"
#include "mesh.hpp"
#include "precice/precice.hpp"

namespace couplet::dropin {

/// Ends the whole job with a sentence.
[[noreturn]] void end_the_job(const std::string& text);
/// The client of this participant, which takes part in the start of the job on the first call.
couplet_client* joined(const std::string& participant, const MPI_Comm* processes);

/// What comes over one wire, at the start of the time window and at its end; the whole surface's values.
struct Sample {
  std::vector<double> start, end;
};

/// A participant between its construction and its end: the windows of its job as the coupler's client sees them.
class Session {
 public:
  Session(Configuration configuration, int rank, int size, void* communicator);
  ~Session();
  Session(const Session&) = delete;

  /// Describes the surface and waits for the first window.
  void begin();
  /// Goes on by dt; at the end of a window hands over what was written and waits for what comes next.
  void go_on(double dt);
  void leave();

  Mesh* mesh(const std::string& name);
  double remaining() const { return ongoing ? window - at : 0; }
  std::size_t components(const Configuration::Data& d) const;
  /// Values of what is read on a mesh at a time within the window, from its start [s]; null: nobody gives it.
  const Sample* sample(const Configuration::Data& d) const;
  std::size_t first_vertex(const std::string& mesh) const;

  Configuration configuration;
  couplet_client* job = nullptr;
  std::vector<Mesh> meshes;                  ///< provided
  std::vector<std::vector<double>> written;  ///< by datum: on its mesh
  mutable std::string last_error;
  bool initialised = false, finalised = false, ongoing = false, window_complete = false;
  bool initial_data_due = false, writing_due = false, reading_due = false;
  double window = 0, at = 0;  ///< length of the window and the time reached in it [s]

 private:
  void describe();
  /// Answers all that is not the program's affair; false: the job is over. `accepted`: a new window has begun.
  bool wait_for_window(bool& accepted);
  void take(bool new_window);
  void hand_over(bool initial);

  std::vector<Sample> samples_;  // by wire
};

}  // namespace couplet::dropin
