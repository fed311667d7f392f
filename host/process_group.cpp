#include "host/process_group.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <deque>
#include <fstream>
#include <stdexcept>
#include <string_view>

#include "firmware/unique_fd.h"

namespace armada {
namespace {

constexpr size_t kLogTailLines = 10;
constexpr off_t kLastWordsBytes = off_t{16} * 1024;  // room that each log has from the start
constexpr std::chrono::seconds kDestructorGrace{2};

// What the signal handler touches: lock-free, and alive for the whole process.
std::atomic<bool> g_stop_requested{false};
std::atomic<int> g_wake_fd{-1};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

void OnSignal(int signal_number) {
  const int saved_errno = errno;
  if (signal_number != SIGCHLD) {
    g_stop_requested = true;
  }
  // A signal between the check of a condition and the poll() on this descriptor still ends that poll. The
  // write can only fail when the counter is full, and then the descriptor is readable anyway.
  const uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = write(g_wake_fd, &one, sizeof(one));
  errno = saved_errno;
}

std::string SystemError(const std::string& what, int error_number) {
  return what + ": " + strerror(error_number);
}

std::vector<std::string> MergedEnvironment(const std::vector<std::string>& additions) {
  std::vector<std::string> merged = additions;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string_view inherited = *entry;
    const std::string_view key = inherited.substr(0, inherited.find('=') + 1);
    const auto replaces = [key](const std::string& addition) { return addition.starts_with(key); };
    if (std::none_of(additions.begin(), additions.end(), replaces)) {
      merged.emplace_back(inherited);
    }
  }
  return merged;
}

/// Null-terminated pointers into `strings`, as execve wants them.
std::vector<char*> Pointers(std::vector<std::string>& strings) {
  std::vector<char*> pointers;
  pointers.reserve(strings.size() + 1);
  for (std::string& text : strings) {
    pointers.push_back(text.data());
  }
  pointers.push_back(nullptr);
  return pointers;
}

/// The child's side of Start. Other threads of the parent may have held any lock at the fork, so only
/// async-signal-safe calls are allowed. All signals are blocked on entry.
[[noreturn]] void Become(char* const* argv, char* const* environment, int null_fd, int log_fd, int kept_fd,
                         int error_fd, pid_t parent) {
  // The parent may have died before prctl took effect; then no signal comes and the child must see it itself.
  if (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || getppid() != parent) {
    _exit(127);
  }
  for (const int signal_number : {SIGINT, SIGTERM, SIGHUP, SIGCHLD, SIGPIPE}) {
    signal(signal_number, SIG_DFL);  // execve resets handlers, but keeps what the parent ignored
  }
  // An inherited socket would keep the parent's address in use. Best effort: it needs Linux 5.11.
  close_range(STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC);
  if (kept_fd >= 0) fcntl(kept_fd, F_SETFD, 0);
  sigset_t none;
  sigemptyset(&none);
  const bool ready = setpgid(0, 0) == 0 && dup2(null_fd, STDIN_FILENO) >= 0 &&
                     dup2(log_fd, STDOUT_FILENO) >= 0 && dup2(log_fd, STDERR_FILENO) >= 0 &&
                     sigprocmask(SIG_SETMASK, &none, nullptr) == 0;
  if (ready) {
    execve(argv[0], argv, environment);
  }
  const int reason = errno;
  [[maybe_unused]] const ssize_t written = write(error_fd, &reason, sizeof(reason));
  _exit(127);
}

}  // namespace

std::optional<int> ProcessExit::Code() const {
  return WIFEXITED(wait_status) ? std::optional(WEXITSTATUS(wait_status)) : std::nullopt;
}

std::string ProcessExit::Describe() const {
  std::string text = name + " (pid " + std::to_string(pid) + ") ";
  if (WIFSIGNALED(wait_status)) {
    const char* abbreviation = sigabbrev_np(WTERMSIG(wait_status));
    text += "was ended by signal " + std::to_string(WTERMSIG(wait_status));
    text += abbreviation != nullptr ? " (SIG" + std::string(abbreviation) + ")" : "";
  } else {
    text += "exited with code " + std::to_string(WEXITSTATUS(wait_status));
  }

  std::ifstream log(log_path);
  std::deque<std::string> tail;
  for (std::string line; std::getline(log, line);) {
    tail.push_back(line);
    if (tail.size() > kLogTailLines) {
      tail.pop_front();
    }
  }
  text += tail.empty() ? "; its log " + log_path + " is empty" : "; the end of " + log_path + ":";
  for (const std::string& line : tail) {
    text += "\n  " + line;
  }
  return text;
}

ProcessGroup::ProcessGroup() {
  if (g_wake_fd >= 0) {
    throw std::logic_error("ProcessGroup: another object already handles this process's signals");
  }
  const int wake_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (wake_fd < 0) {
    throw std::runtime_error(SystemError("ProcessGroup: eventfd", errno));
  }
  g_wake_fd = wake_fd;
  g_stop_requested = false;
  struct sigaction action {};
  action.sa_handler = OnSignal;
  for (size_t i = 0; i < kSignals.size(); ++i) {
    sigaction(kSignals[i], nullptr, &former_actions_[i]);
    if (kSignals[i] != SIGHUP || former_actions_[i].sa_handler != SIG_IGN) {
      // Only the end of a program may leave a write to a full terminal or pipe waiting.
      action.sa_flags = kSignals[i] == SIGCHLD ? SA_RESTART : 0;
      sigaction(kSignals[i], &action, nullptr);
    }
  }
}

ProcessGroup::~ProcessGroup() {
  StopAll(kDestructorGrace);
  for (size_t i = 0; i < kSignals.size(); ++i) {
    sigaction(kSignals[i], &former_actions_[i], nullptr);
  }
  close(g_wake_fd.exchange(-1));
}

bool ProcessGroup::Start(const ProcessSpec& spec, std::string* error) {
  // PR_SET_PDEATHSIG follows the thread that forks, not the process.
  if (gettid() != getpid()) {
    *error =
        "cannot start " + spec.name + ": only the main thread may, or the program would end with its thread";
    return false;
  }
  if (spec.argv.empty()) {
    *error = "cannot start " + spec.name + ": no executable given";
    return false;
  }
  const UniqueFd null_fd(open("/dev/null", O_RDONLY | O_CLOEXEC));
  const UniqueFd log_fd(
      open(spec.log_path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC, 0644));
  if (!log_fd.valid()) {
    *error = SystemError("cannot start " + spec.name + ": its log " + spec.log_path, errno);
    return false;
  }
  // On a disk that gets full a program can still say so. Not every file system can keep room.
  if (fallocate(log_fd.get(), FALLOC_FL_KEEP_SIZE, 0, kLastWordsBytes) != 0 && errno == ENOSPC) {
    *error = SystemError("cannot start " + spec.name + ": its log " + spec.log_path, errno);
    return false;
  }
  int pipe_fds[2];  // closed by a successful execve, otherwise carries its errno
  if (!null_fd.valid() || pipe2(pipe_fds, O_CLOEXEC) != 0) {
    *error = SystemError("cannot start " + spec.name, errno);
    return false;
  }
  const UniqueFd error_source(pipe_fds[0]);
  UniqueFd error_sink(pipe_fds[1]);

  // Everything that allocates happens before the fork.
  std::vector<std::string> arguments = spec.argv;
  std::vector<std::string> variables = MergedEnvironment(spec.environment);
  const std::vector<char*> argv = Pointers(arguments);
  const std::vector<char*> environment = Pointers(variables);
  const pid_t self = getpid();

  // Blocked across the fork: this process's handler must not run in the child.
  sigset_t all;
  sigset_t former;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, &former);
  const pid_t pid = fork();
  if (pid == 0) {
    Become(argv.data(), environment.data(), null_fd.get(), log_fd.get(), spec.kept_fd, error_sink.get(),
           self);
  }
  const int fork_errno = errno;
  pthread_sigmask(SIG_SETMASK, &former, nullptr);
  if (pid < 0) {
    *error = SystemError("cannot start " + spec.name, fork_errno);
    return false;
  }

  error_sink = UniqueFd();
  int reason = 0;
  ssize_t received = 0;
  do {
    received = read(error_source.get(), &reason, sizeof(reason));
  } while (received < 0 && errno == EINTR);
  if (received != 0) {
    waitpid(pid, nullptr, 0);
    *error = SystemError("cannot start " + spec.name + ": " + spec.argv[0], reason);
    return false;
  }
  children_.push_back({spec.name, spec.log_path, pid});
  return true;
}

std::optional<ProcessExit> ProcessGroup::Poll(Duration timeout) {
  return ReapUntil(Clock::now() + timeout, /*heed_stop=*/true);
}

std::optional<pid_t> ProcessGroup::Find(const std::string& name) const {
  const auto child =
      std::find_if(children_.begin(), children_.end(), [&](const Child& c) { return c.name == name; });
  return child == children_.end() ? std::nullopt : std::optional(child->pid);
}

bool ProcessGroup::Signal(const std::string& name, int signal_number) const {
  const auto pid = Find(name);
  return pid && kill(-*pid, signal_number) == 0;
}

std::vector<ProcessExit> ProcessGroup::StopAll(Duration grace) {
  std::vector<ProcessExit> exits;
  const auto collect_until = [&](Clock::time_point deadline) {
    std::optional<ProcessExit> exit;
    do {
      exit = children_.empty() ? std::nullopt : ReapUntil(deadline, /*heed_stop=*/false);
      if (exit) {
        exits.push_back(*exit);
      }
    } while (exit);
  };
  if (grace > Duration::zero()) {
    SignalAll(SIGTERM);
    SignalAll(SIGCONT);  // a suspended program could not act on the request
    collect_until(Clock::now() + grace);
  }
  SignalAll(SIGKILL);
  collect_until(Clock::time_point::max());
  return exits;
}

bool ProcessGroup::StopRequested() {
  return g_stop_requested;
}

std::optional<ProcessExit> ProcessGroup::ReapUntil(Clock::time_point deadline, bool heed_stop) {
  while (true) {
    // Emptied before looking: whatever ends after the look leaves the descriptor readable.
    uint64_t count = 0;
    [[maybe_unused]] const ssize_t received = read(g_wake_fd, &count, sizeof(count));
    std::optional<ProcessExit> exit = ReapOne();
    const Duration remaining = deadline - Clock::now();
    if (exit || (heed_stop && StopRequested()) || remaining <= Duration::zero()) {
      return exit;
    }
    pollfd wake = {.fd = g_wake_fd, .events = POLLIN, .revents = 0};
    const timespec wait = {.tv_sec = remaining / std::chrono::seconds(1),
                           .tv_nsec = (remaining % std::chrono::seconds(1)).count()};
    ppoll(&wake, 1, &wait, nullptr);
  }
}

std::optional<ProcessExit> ProcessGroup::ReapOne() {
  for (auto child = children_.begin(); child != children_.end(); ++child) {
    // WNOWAIT keeps the pid ours, so that the group's remains can be killed without hitting a stranger.
    siginfo_t info{};
    if (waitid(P_PID, static_cast<id_t>(child->pid), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
        info.si_pid == 0) {
      continue;
    }
    kill(-child->pid, SIGKILL);
    ProcessExit exit{child->name, child->log_path, child->pid, 0};
    waitpid(child->pid, &exit.wait_status, 0);
    children_.erase(child);
    return exit;
  }
  return std::nullopt;
}

void ProcessGroup::SignalAll(int signal_number) const {
  for (const Child& child : children_) {
    kill(-child.pid, signal_number);
  }
}

}  // namespace armada
