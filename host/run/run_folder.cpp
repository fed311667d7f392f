#include "host/run/run_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <filesystem>

#include "firmware/app/realtime.h"
#include "hil/live_faults.h"
#include "host/shell_quote.h"

namespace armada {
namespace {

namespace fs = std::filesystem;

constexpr int64_t kJanitorPatience_ns = 5'000'000'000;
constexpr int64_t kRetry_ns = 10'000'000;

// Waits for the end of its input, which comes when this process has closed it or has ended in whatever way.
// It inherits the lock: nobody takes the folder before it is clean. In a session of its own: what ends our
// process group must not end it.
std::string JanitorOf(const std::string& directory) {
  std::string command = "exec setsid sh -c 'unset CDPATH && cd -P -- \"$1\" && cat >/dev/null && rm -f";
  for (const char* name : {LiveFaults::kOfProcesses, LiveFaults::kOfEmulation, RunFolder::kLock})
    command.append(" ").append(name);
  return command + "' janitor " + ShellQuoted(fs::absolute(directory).string()) + " 2>/dev/null";
}

void SetInherited(int descriptor, bool inherited) {
  fcntl(descriptor, F_SETFD, inherited ? 0 : FD_CLOEXEC);
}

// Whether the file of that name is still the one that is open: its last owner removes it.
bool IsNamed(int descriptor, const std::string& path) {
  struct stat opened {};
  struct stat named {};
  return fstat(descriptor, &opened) == 0 && stat(path.c_str(), &named) == 0 &&
         opened.st_ino == named.st_ino && opened.st_dev == named.st_dev;
}

pid_t OwnerOf(int descriptor) {
  std::array<char, 32> text{};
  const ssize_t size = pread(descriptor, text.data(), text.size(), 0);
  pid_t owner = 0;
  if (size > 0) std::from_chars(text.data(), text.data() + size, owner);
  return owner;
}

// On a full disk there is a lock without an owner.
void WriteOwner(int descriptor) {
  const std::string text = std::to_string(getpid()) + "\n";
  if (ftruncate(descriptor, 0) == 0) [[maybe_unused]]
    const ssize_t written = pwrite(descriptor, text.data(), text.size(), 0);
}

bool IsDead(pid_t process) {
  return process > 0 && kill(process, 0) != 0 && errno == ESRCH;
}

std::string InUse(const std::string& directory, pid_t owner) {
  return directory + " is in use by another run" +
         (owner > 0 ? " (process " + std::to_string(owner) + ")" : "") +
         ": wait for its end, or give this one another folder (--out)";
}

// The file, locked; invalid with *error set when somebody else has it.
UniqueFd LockOf(const std::string& directory, const std::string& path, bool* in_use, std::string* error) {
  const int64_t patience_ends_ns = MonotonicNow() + kJanitorPatience_ns;
  while (true) {
    UniqueFd lock(open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644));
    if (lock.valid() && flock(lock.get(), LOCK_EX | LOCK_NB) == 0) {
      if (IsNamed(lock.get(), path)) return lock;
    } else if (lock.valid() && errno == EWOULDBLOCK) {
      const pid_t owner = OwnerOf(lock.get());
      if (!IsDead(owner) || MonotonicNow() > patience_ends_ns) {
        *in_use = true;
        *error = InUse(directory, owner);
        return {};
      }
      SleepUntil(MonotonicNow() + kRetry_ns);  // a run that was killed: its janitor is still at work
    } else {
      *error = "cannot write " + path + ": " + std::strerror(errno);
      return {};
    }
  }
}

}  // namespace

std::unique_ptr<RunFolder> RunFolder::Take(const std::string& directory, bool* in_use, std::string* error) {
  *in_use = false;
  std::error_code code;
  fs::create_directories(directory, code);
  if (code) {
    *error = "cannot create " + directory + ": " + code.message();
    return nullptr;
  }
  const std::string path = (fs::path(directory) / kLock).string();
  UniqueFd lock = LockOf(directory, path, in_use, error);
  if (!lock.valid()) return nullptr;
  WriteOwner(lock.get());
  SetInherited(lock.get(), true);
  FILE* const janitor = popen(JanitorOf(directory).c_str(), "we");
  SetInherited(lock.get(), false);
  if (janitor == nullptr) {
    *error = "cannot start sh, which cleans " + directory + " after the run";
    unlink(path.c_str());
    return nullptr;
  }
  return std::unique_ptr<RunFolder>(new RunFolder(path, std::move(lock), janitor));
}

RunFolder::~RunFolder() {
  pclose(janitor_);
}

bool RunFolder::IsThere() const {
  return IsNamed(lock_.get(), path_);
}

void RunFolder::KeepAcrossExec() {
  SetInherited(lock_.get(), true);
  SetInherited(fileno(janitor_), true);
}

void EmptyRunFolder(const std::string& directory) {
  const fs::path folder = directory;
  std::error_code ignored;
  for (const char* name : {"metrics.json", "hil.json", "report.html", "timing.csv", "leader.csv", "lcm.log",
                           "report", "without_subtask", "fleet.key", "state", "learned"}) {
    fs::remove_all(folder / name, ignored);
  }
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("arm_") || name.starts_with("can_") || name.starts_with("initial_"))
      fs::remove(entry.path(), ignored);
  }
}

}  // namespace armada
