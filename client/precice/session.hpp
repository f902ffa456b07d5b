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

/// Ends the whole job with a message.
[[noreturn]] void end_the_job(const std::string& text);
/// The client of this participant, which takes part in the start of the job on the first call. A process has one.
couplet_client* joined(const std::string& participant, const MPI_Comm* processes);

/// Values of one wire over the whole surface, at the start and end of the time window and at the giver's
/// sub-steps.
struct Sample {
  std::vector<double> start, end;
  std::vector<const double*> within;  ///< owned by the client
  std::vector<double> shares;         ///< of the window, at start, within and end
  std::optional<Waveform> waveform;   ///< through all shares
};

/// Value in time as a sum of weights times values.
using Blend = std::vector<std::pair<double, const double*>>;

/// Participant between construction and end. Maps its time windows to events of the Couplet client.
class Session {
 public:
  /// `processes`: communicator of this participant; nullptr selects the one that the job gives it.
  Session(Configuration configuration, int rank, int size, const MPI_Comm* processes);
  ~Session();
  Session(const Session&) = delete;

  /// Describes the surface and waits for the first window.
  void begin();
  /// Advances by dt. At the end of a window sends the written data and waits for the next event.
  void go_on(double dt);
  void leave();

  Mesh* mesh(const std::string& name);
  double remaining() const { return ongoing ? window - at : 0; }
  std::size_t components(const Configuration::Data& d) const;
  /// Values of a read datum on a mesh. nullptr if no participant gives it.
  const Sample* sample(const Configuration::Data& d) const;
  /// Interpolates at a time since the start of the window [s]. Ends are returned unchanged.
  Blend at_time(const Sample& s, double reached) const;
  std::size_t first_vertex(const std::string& mesh) const;

  Configuration configuration;
  couplet_client* job = nullptr;             ///< from initialize() on
  std::vector<Mesh> meshes;                  ///< provided
  std::vector<std::vector<double>> written;  ///< by datum, on its mesh
  mutable std::string last_error;
  bool initialised = false, finalised = false, ongoing = false, window_complete = false;
  int profiling_sections = 0;
  bool initial_data_due = false, writing_due = false, reading_due = false;
  double window = 0, at = 0;  ///< length of the window and the time reached in it [s]

 private:
  void join();
  void describe();
  /// Handles other events of the job. Returns false if it is over. Sets `accepted` if a new window begins.
  bool wait_for_window(bool& accepted);
  void take(bool new_window);
  void hand_over(bool initial);
  /// Expands written values of a datum to its whole surface.
  std::vector<double> surface_of(std::size_t datum, const std::vector<double>& values) const;
  /// Keeps the values written at a sub-step of the window.
  void keep_sub_step();
  void take_within(const Configuration::Wire& wire, Sample& s, bool constant);

  int rank_, size_;
  std::optional<MPI_Comm> processes_;
  std::vector<Sample> samples_;  // by wire
  // Share of the window; as `written`.
  std::vector<std::pair<double, std::vector<std::vector<double>>>> sub_steps_;
};

}  // namespace couplet::dropin
