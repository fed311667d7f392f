#pragma once

#include <signal.h>
#include <sys/types.h>

#include <array>
#include <chrono>
#include <optional>
#include <string>
#include <vector>

namespace armada {

/// A program to run beside others.
struct ProcessSpec {
  std::string name;                      ///< what messages call it, for example "arm 3"
  std::vector<std::string> argv;         ///< argv[0] is the path of the executable; PATH is not searched
  std::vector<std::string> environment;  ///< "NAME=value": added to this process's, or in place of its value
  std::string log_path;                  ///< takes standard output and error; emptied first, some room kept
  int kept_fd = -1;                      ///< a descriptor of ours that it has, too, under the same number
};

/// How a program ended.
struct ProcessExit {
  std::string name;
  std::string log_path;
  pid_t pid = 0;
  int wait_status = 0;  ///< as waitpid(2) gives it

  /// None of one that a signal has ended.
  std::optional<int> Code() const;
  /// True for an exit with code 0.
  bool Succeeded() const { return Code() == 0; }

  /// For people: who, the exit code or the signal, and the last lines of the log.
  std::string Describe() const;
};

/// Starts programs, watches them, and leaves none behind.
///
/// While an object lives, SIGINT, SIGTERM and SIGHUP do not end this process: they raise StopRequested(), so
/// that the owner can stop the programs in order. The former handlers come back with the destructor, which
/// stops what still runs. SIGHUP stays ignored where it was (nohup).
///
/// Every program leads a process group of its own: the terminal's Ctrl-C reaches only this process, and
/// stopping a program takes its descendants along. Should this process be killed with no chance to act, the
/// kernel kills the programs (PR_SET_PDEATHSIG). Two limits of that last resort: it does not reach a
/// program's own descendants, and an executable with file capabilities or set-uid escapes it.
///
/// At most one object at a time (the constructor throws std::logic_error), used by the main thread only.
class ProcessGroup {
 public:
  using Clock = std::chrono::steady_clock;
  using Duration = std::chrono::nanoseconds;

  ProcessGroup();
  ProcessGroup(const ProcessGroup&) = delete;
  ProcessGroup& operator=(const ProcessGroup&) = delete;
  ~ProcessGroup();

  /// Starts a program. False, with the reason in `error`, if it cannot be executed or its log cannot be
  /// written.
  bool Start(const ProcessSpec& spec, std::string* error);

  /// A program that has ended, each reported once. Waits up to `timeout` for one; a stop request ends the
  /// wait.
  std::optional<ProcessExit> Poll(Duration timeout = Duration::zero());

  /// The process of a program; nothing if there is none of that name.
  std::optional<pid_t> Find(const std::string& name) const;

  /// Sends a signal to a program and its descendants. False if there is none of that name.
  bool Signal(const std::string& name, int signal_number) const;

  /// Asks all programs to end (SIGTERM), kills after `grace` those that have not, and tells how each one
  /// ended. Without grace they are not asked.
  std::vector<ProcessExit> StopAll(Duration grace);

  /// True once SIGINT, SIGTERM or SIGHUP has arrived at the living object.
  static bool StopRequested();

 private:
  struct Child {
    std::string name;
    std::string log_path;
    pid_t pid;
  };

  std::optional<ProcessExit> ReapUntil(Clock::time_point deadline, bool heed_stop);
  std::optional<ProcessExit> ReapOne();
  void SignalAll(int signal_number) const;

  static constexpr std::array kSignals = {SIGINT, SIGTERM, SIGHUP, SIGCHLD};

  std::vector<Child> children_;
  std::array<struct sigaction, kSignals.size()> former_actions_{};
};

}  // namespace armada
