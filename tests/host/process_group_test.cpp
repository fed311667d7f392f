#include "host/process_group.h"

#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace armada {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

// Far beyond what any step takes: reached only when something hangs.
constexpr seconds kDeadline{20};

class ProcessGroupTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = testing::TempDir() + "process_group_XXXXXX";
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string LogPath(const std::string& name) const { return folder_ / (name + ".log"); }

  ProcessSpec Spec(const std::string& name, std::vector<std::string> argv) const {
    return {.name = name, .argv = std::move(argv), .environment = {}, .log_path = LogPath(name)};
  }
  ProcessSpec Shell(const std::string& name, const std::string& script) const {
    return Spec(name, {"/bin/sh", "-c", script});
  }

  std::string Log(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(LogPath(name)).rdbuf();
    return text.str();
  }

  /// The log's text once it holds a whole line: the script has come as far as its echo.
  std::string AwaitLog(const std::string& name) const {
    EXPECT_TRUE(Await([&] { return Log(name).ends_with('\n'); })) << "nothing in the log of " << name;
    return Log(name);
  }

  static bool Await(const std::function<bool()>& condition) {
    const auto deadline = std::chrono::steady_clock::now() + kDeadline;
    while (!condition()) {
      if (std::chrono::steady_clock::now() > deadline) {
        return false;
      }
      std::this_thread::sleep_for(milliseconds(1));
    }
    return true;
  }

  std::filesystem::path folder_;
  std::string error_;
};

TEST_F(ProcessGroupTest, ReportsEachExitOnceWithItsCode) {
  ProcessGroup group;
  ASSERT_TRUE(group.Start(Shell("good", "exit 0"), &error_)) << error_;
  ASSERT_TRUE(group.Start(Shell("bad", "exit 3"), &error_)) << error_;

  std::vector<std::string> succeeded;
  std::vector<std::string> failed;
  for (int i = 0; i < 2; ++i) {
    const std::optional<ProcessExit> exit = group.Poll(kDeadline);
    ASSERT_TRUE(exit.has_value());
    (exit->Succeeded() ? succeeded : failed).push_back(exit->name);
  }
  EXPECT_EQ(succeeded, std::vector<std::string>{"good"});
  EXPECT_EQ(failed, std::vector<std::string>{"bad"});
  EXPECT_FALSE(group.Poll().has_value());
}

TEST_F(ProcessGroupTest, PollReturnsAtOnceWhileAllRun) {
  ProcessGroup group;
  ASSERT_TRUE(group.Start(Spec("sleeper", {"/bin/sleep", "1000"}), &error_)) << error_;
  EXPECT_FALSE(group.Poll().has_value());
}

TEST_F(ProcessGroupTest, DescribesAFailureByNameCodeAndTheEndOfTheLog) {
  ProcessGroup group;
  ASSERT_TRUE(group.Start(Shell("arm 3", "seq 1 30; echo 'no torque' >&2; exit 78"), &error_)) << error_;
  const std::optional<ProcessExit> exit = group.Poll(kDeadline);
  ASSERT_TRUE(exit.has_value());

  const std::string expected = "arm 3 (pid " + std::to_string(exit->pid) +
                               ") exited with code 78; the end of " + LogPath("arm 3") +
                               ":\n  22\n  23\n  24\n  25\n  26\n  27\n  28\n  29\n  30\n" + "  no torque";
  EXPECT_EQ(exit->Describe(), expected);
}

TEST_F(ProcessGroupTest, DescribesACrashByItsSignal) {
  ProcessGroup group;
  ASSERT_TRUE(group.Start(Shell("plant", "kill -SEGV $$"), &error_)) << error_;
  const std::optional<ProcessExit> exit = group.Poll(kDeadline);
  ASSERT_TRUE(exit.has_value());
  EXPECT_FALSE(exit->Succeeded());
  EXPECT_EQ(exit->Describe(), "plant (pid " + std::to_string(exit->pid) +
                                  ") was ended by signal 11 (SIGSEGV); its log " + LogPath("plant") +
                                  " is empty");
}

TEST_F(ProcessGroupTest, RefusesAnExecutableThatIsNotThere) {
  ProcessGroup group;
  EXPECT_FALSE(group.Start(Spec("arm 1", {"/nonexistent/armada-arm"}), &error_));
  EXPECT_EQ(error_, "cannot start arm 1: /nonexistent/armada-arm: No such file or directory");
  EXPECT_TRUE(group.StopAll(seconds(0)).empty());
}

TEST_F(ProcessGroupTest, RefusesALogThatCannotBeWritten) {
  ProcessGroup group;
  ProcessSpec spec = Shell("arm 1", "exit 0");
  spec.log_path = folder_ / "absent" / "arm.log";
  EXPECT_FALSE(group.Start(spec, &error_));
  EXPECT_EQ(error_, "cannot start arm 1: its log " + spec.log_path + ": No such file or directory");
}

TEST_F(ProcessGroupTest, RefusesAnEmptyCommand) {
  ProcessGroup group;
  EXPECT_FALSE(group.Start(Spec("arm 1", {}), &error_));
  EXPECT_EQ(error_, "cannot start arm 1: no executable given");
}

TEST_F(ProcessGroupTest, RefusesToStartFromAThreadWhoseEndWouldKillTheProgram) {
  ProcessGroup group;
  bool started = true;
  std::thread([&] { started = group.Start(Shell("arm 1", "exit 0"), &error_); }).join();
  EXPECT_FALSE(started);
  EXPECT_NE(error_.find("main thread"), std::string::npos) << error_;
}

TEST_F(ProcessGroupTest, TwoAtATimeAreRefused) {
  ProcessGroup group;
  EXPECT_THROW(ProcessGroup(), std::logic_error);
}

TEST_F(ProcessGroupTest, AddsAndReplacesEnvironmentVariables) {
  setenv("ARMADA_TEST_KEPT", "kept", 1);
  setenv("ARMADA_TEST_CHANGED", "before", 1);
  ProcessGroup group;
  ProcessSpec spec = Shell("env", "echo $ARMADA_TEST_KEPT $ARMADA_TEST_CHANGED $ARMADA_TEST_NEW");
  spec.environment = {"ARMADA_TEST_CHANGED=after", "ARMADA_TEST_NEW=new"};
  ASSERT_TRUE(group.Start(spec, &error_)) << error_;
  ASSERT_TRUE(group.Poll(kDeadline).has_value());
  EXPECT_EQ(Log("env"), "kept after new\n");
}

TEST_F(ProcessGroupTest, ProgramsInheritNoDescriptorAndNoBlockedOrIgnoredSignal) {
  const int leak = dup(STDERR_FILENO);  // without close-on-exec, as a library might leave it
  signal(SIGPIPE, SIG_IGN);
  ProcessGroup group;
  // ls itself opens the folder it lists as 3.
  ASSERT_TRUE(group.Start(Spec("fds", {"/bin/ls", "/proc/self/fd"}), &error_)) << error_;
  ASSERT_TRUE(
      group.Start(Spec("signals", {"/bin/grep", "-E", "^Sig(Blk|Ign)", "/proc/self/status"}), &error_))
      << error_;
  ASSERT_TRUE(group.Poll(kDeadline).has_value());
  ASSERT_TRUE(group.Poll(kDeadline).has_value());
  signal(SIGPIPE, SIG_DFL);
  close(leak);
  EXPECT_EQ(Log("fds"), "0\n1\n2\n3\n");
  EXPECT_EQ(Log("signals"), "SigBlk:\t0000000000000000\nSigIgn:\t0000000000000000\n");
}

TEST_F(ProcessGroupTest, StopAllLetsAProgramCleanUp) {
  ProcessGroup group;
  ASSERT_TRUE(group.Start(
      Shell("polite", "trap 'echo bye; exit 5' TERM; echo ready; while :; do sleep 0.01; done"), &error_))
      << error_;
  AwaitLog("polite");
  const std::vector<ProcessExit> exits = group.StopAll(kDeadline);
  ASSERT_EQ(exits.size(), 1U);
  EXPECT_EQ(WEXITSTATUS(exits[0].wait_status), 5);
  EXPECT_TRUE(Log("polite").ends_with("bye\n")) << Log("polite");
}

TEST_F(ProcessGroupTest, StopAllKillsAProgramThatIgnoresTheRequest) {
  ProcessGroup group;
  ASSERT_TRUE(group.Start(Shell("stubborn", "trap '' TERM; echo ready; while :; do sleep 1; done"), &error_))
      << error_;
  AwaitLog("stubborn");
  const std::vector<ProcessExit> exits = group.StopAll(milliseconds(50));
  ASSERT_EQ(exits.size(), 1U);
  ASSERT_TRUE(WIFSIGNALED(exits[0].wait_status));
  EXPECT_EQ(WTERMSIG(exits[0].wait_status), SIGKILL);
}

TEST_F(ProcessGroupTest, WithoutGraceNobodyGetsAWord) {
  ProcessGroup group;
  ASSERT_TRUE(group.Start(
      Shell("polite", "trap 'echo bye; exit 5' TERM; echo ready; while :; do sleep 0.01; done"), &error_))
      << error_;
  AwaitLog("polite");
  const std::vector<ProcessExit> exits = group.StopAll(seconds(0));
  ASSERT_EQ(exits.size(), 1U);
  EXPECT_EQ(exits[0].Code(), std::nullopt);
  EXPECT_EQ(Log("polite"), "ready\n");
}

TEST_F(ProcessGroupTest, StopAllWakesASuspendedProgram) {
  ProcessGroup group;
  ASSERT_TRUE(group.Start(Shell("suspended", "trap 'exit 6' TERM; echo $$; kill -STOP $$; exit 7"), &error_))
      << error_;
  const std::string pid = AwaitLog("suspended").substr(0, Log("suspended").find('\n'));
  ASSERT_TRUE(Await([&] {
    std::string field;
    std::ifstream stat("/proc/" + pid + "/stat");
    stat >> field >> field >> field;
    return field == "T";
  })) << "never suspended";
  const std::vector<ProcessExit> exits = group.StopAll(kDeadline);
  ASSERT_EQ(exits.size(), 1U);
  EXPECT_TRUE(WIFEXITED(exits[0].wait_status)) << exits[0].Describe();
  EXPECT_EQ(WEXITSTATUS(exits[0].wait_status), 6);
}

// From here on this process adopts its descendants' orphans, so that "vanished" is a fact it can wait for: it
// reaps them itself.
class ProcessGroupOrphanTest : public ProcessGroupTest {
 protected:
  void SetUp() override {
    ProcessGroupTest::SetUp();
    ASSERT_EQ(prctl(PR_SET_CHILD_SUBREAPER, 1), 0);
  }
  void TearDown() override {
    prctl(PR_SET_CHILD_SUBREAPER, 0);
    ProcessGroupTest::TearDown();
  }

  /// The wait status of `pid`, which is or becomes this process's child; -1 if it still runs at the deadline.
  static int AwaitEnd(pid_t pid) {
    int status = -1;
    const bool ended = Await([&] { return waitpid(pid, &status, WNOHANG) == pid; });
    return ended ? status : -1;
  }

  /// Runs `supervise` in a child of this process, as the `armada run` of a test.
  template <typename Function>
  static pid_t Fork(Function supervise) {
    const pid_t pid = fork();
    if (pid == 0) {
      _exit(supervise());
    }
    return pid;
  }

  /// A supervisor with two programs that prints their pids and runs until asked to stop.
  int SuperviseTwo() {
    ProcessGroup group;
    for (const char* name : {"first", "second"}) {
      if (!group.Start(Shell(name, "echo $$; exec sleep 1000"), &error_)) {
        return 1;
      }
    }
    while (!ProcessGroup::StopRequested()) {
      if (group.Poll(kDeadline)) {
        return 2;
      }
    }
    return group.StopAll(kDeadline).size() == 2 ? 0 : 3;
  }

  std::array<pid_t, 2> AwaitTwo() const {
    return {std::stoi(AwaitLog("first")), std::stoi(AwaitLog("second"))};
  }
};

TEST_F(ProcessGroupOrphanTest, AKilledSupervisorTakesItsProgramsAlong) {
  const pid_t supervisor = Fork([&] { return SuperviseTwo(); });
  const std::array<pid_t, 2> programs = AwaitTwo();
  kill(supervisor, SIGKILL);
  EXPECT_EQ(WTERMSIG(AwaitEnd(supervisor)), SIGKILL);
  for (const pid_t program : programs) {
    const int status = AwaitEnd(program);
    EXPECT_TRUE(WIFSIGNALED(status));
    EXPECT_EQ(WTERMSIG(status), SIGKILL);
  }
}

TEST_F(ProcessGroupOrphanTest, AStopSignalIsSeenAndTheProgramsAreReaped) {
  for (const int signal_number : {SIGINT, SIGTERM, SIGHUP}) {
    const pid_t supervisor = Fork([&] { return SuperviseTwo(); });
    const std::array<pid_t, 2> programs = AwaitTwo();
    kill(supervisor, signal_number);
    const int status = AwaitEnd(supervisor);
    EXPECT_TRUE(WIFEXITED(status)) << strsignal(signal_number);
    EXPECT_EQ(WEXITSTATUS(status), 0) << strsignal(signal_number);
    for (const pid_t program : programs) {
      EXPECT_EQ(kill(program, 0), -1);
      EXPECT_EQ(errno, ESRCH);
    }
    std::filesystem::remove(LogPath("first"));
    std::filesystem::remove(LogPath("second"));
  }
}

TEST_F(ProcessGroupOrphanTest, AHangupIgnoredByNohupStaysIgnored) {
  signal(SIGHUP, SIG_IGN);
  {
    const ProcessGroup group;
    raise(SIGHUP);
    EXPECT_FALSE(ProcessGroup::StopRequested());
  }
  signal(SIGHUP, SIG_DFL);
}

TEST_F(ProcessGroupOrphanTest, TheDescendantsOfACrashedProgramGoWithIt) {
  ProcessGroup group;
  ASSERT_TRUE(group.Start(Shell("parent", "sleep 1000 & echo $!; kill -SEGV $$"), &error_)) << error_;
  ASSERT_TRUE(group.Poll(kDeadline).has_value());
  const int status = AwaitEnd(std::stoi(Log("parent")));
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(WTERMSIG(status), SIGKILL);
}

TEST_F(ProcessGroupOrphanTest, TheDestructorLeavesNothingBehindAndRestoresTheHandlers) {
  const auto own_handler = +[](int) {};
  signal(SIGTERM, own_handler);
  pid_t program = 0;
  {
    ProcessGroup group;
    ASSERT_TRUE(group.Start(Shell("sleeper", "echo $$; exec sleep 1000"), &error_)) << error_;
    program = std::stoi(AwaitLog("sleeper"));
  }
  EXPECT_EQ(waitpid(program, nullptr, WNOHANG), -1);
  EXPECT_EQ(errno, ECHILD);
  EXPECT_EQ(signal(SIGTERM, SIG_DFL), own_handler);
  EXPECT_EQ(signal(SIGINT, SIG_DFL), SIG_DFL);
}

}  // namespace
}  // namespace armada
