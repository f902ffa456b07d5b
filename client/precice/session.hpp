// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "configuration.hpp"
#include "couplet.h"
#include "mesh.hpp"
#include "precice/precice.hpp"
#include "waveform.hpp"

namespace couplet::dropin {

/// Ends the whole job with a sentence.
[[noreturn]] void end_the_job(const std::string& text);
/// The client of this participant, which takes part in the start of the job on the first call. A process has one.
couplet_client* joined(const std::string& participant, const MPI_Comm* processes);

/// What comes over one wire, at the start of the time window, at its end, and in between where the giver takes sub-steps;
/// the whole surface's values.
struct Sample {
  std::vector<double> start, end;
  std::vector<const double*> within;  ///< the client's
  std::vector<double> shares;         ///< of the window, of start, within and end
  std::optional<Waveform> waveform;   ///< through the shares
};

/// A value in time: the sum of weights times values.
using Blend = std::vector<std::pair<double, const double*>>;

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
  /// Values of what is read on a mesh; null: nobody gives it.
  const Sample* sample(const Configuration::Data& d) const;
  /// The value at a time within the window, from its start [s]; ends are taken as they came.
  Blend at_time(const Sample& s, double reached) const;
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
  /// What a datum's whole surface has of what was written.
  std::vector<double> surface_of(std::size_t datum, const std::vector<double>& values) const;
  /// Keeps what was written at a sub-step of the window.
  void keep_sub_step();
  void take_within(const Configuration::Wire& wire, Sample& s, bool constant);

  std::vector<Sample> samples_;  // by wire
  std::vector<std::pair<double, std::vector<std::vector<double>>>>
      sub_steps_;  // share of the window; as `written`
};

}  // namespace couplet::dropin
