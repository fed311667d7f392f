#pragma once

#include <memory>
#include <optional>
#include <string>

#include "firmware/unique_fd.h"
#include "hil/fault.h"

namespace armada {

/// Where a run in real time takes faults while it goes on: a named pipe in the run's folder, a line a fault,
/// as an inline table of a scenario, with times from now on. What is none is skipped: `armada fault` checks
/// first.
class LiveFaults {
 public:
  /// Faults of drives and buses, which armada-hil makes; and of processes, which `armada run` makes.
  static constexpr const char* kOfEmulation = "faults.hil";
  static constexpr const char* kOfProcesses = "faults.run";

  /// Makes the pipe. Null, and the reason in `error`, on failure.
  static std::unique_ptr<LiveFaults> Create(const std::string& directory, const char* name,
                                            std::string* error);
  LiveFaults(const LiveFaults&) = delete;
  LiveFaults& operator=(const LiveFaults&) = delete;
  ~LiveFaults();

  /// A fault that has come, its times those of the run, at which it is now `now_s`. Allocates when there is
  /// one.
  std::optional<FaultConfig> Take(double now_s);

 private:
  LiveFaults(std::string path, UniqueFd pipe) : path_(std::move(path)), pipe_(std::move(pipe)) {}

  std::string path_;
  UniqueFd pipe_;
  std::string text_;  ///< that has come, from the start of a line
};

/// Hands a fault to the run in `directory`, as an inline table with times from now on. False with `*error`
/// set when there is no run.
bool SendLiveFault(const std::string& table, const std::string& directory, const char* name,
                   std::string* error);

}  // namespace armada
