// How long somebody waits for a program, with processes that work, sleep and are stopped.

#include "host/run/watched_program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "tests/support/numbers.h"

namespace armada {
namespace {

using testing::HasSubstr;

class WatchedProgramTest : public testing::Test {
 protected:
  void Start(bool works) {
    pid_ = fork();
    if (pid_ != 0) return;
    for (volatile bool on = works; on;) {
    }
    pause();
    _exit(0);
  }
  ~WatchedProgramTest() override {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  void AwaitThatItIs(Doing doing) const {
    while (DoingOf(pid_) != doing) usleep(1000);
  }

  pid_t pid_ = 0;
};

TEST_F(WatchedProgramTest, OnlyTimeInWhichItCouldHaveGoneOnCounts) {
  Start(false);
  AwaitThatItIs(Doing::kAsleep);
  Patience patience(0);
  EXPECT_EQ(patience.Look(pid_, 50 * kMs), 50 * kMs);
  EXPECT_EQ(patience.Look(pid_, 100 * kMs), 100 * kMs);
  kill(pid_, SIGSTOP);
  AwaitThatItIs(Doing::kStopped);
  EXPECT_EQ(patience.Look(pid_, 250 * kMs), 100 * kMs);
  kill(pid_, SIGCONT);
  AwaitThatItIs(Doing::kAsleep);
  EXPECT_EQ(patience.Look(pid_, 300 * kMs), 150 * kMs);
}

TEST_F(WatchedProgramTest, WhoDidNotLookHasNotWaited) {
  Start(false);
  AwaitThatItIs(Doing::kAsleep);
  Patience patience(0);
  EXPECT_EQ(patience.Look(pid_, 50 * kMs), 50 * kMs);
  EXPECT_EQ(patience.Look(pid_, 100'000 * kMs), 250 * kMs);
}

TEST_F(WatchedProgramTest, WhatItDoesIsTold) {
  Start(true);
  AwaitThatItIs(Doing::kWork);
  EXPECT_THAT(Describe("arm 3", pid_), HasSubstr("arm 3 (pid " + std::to_string(pid_) + ", at work"));
  kill(pid_, SIGSTOP);
  AwaitThatItIs(Doing::kStopped);
  EXPECT_THAT(Describe("arm 3", pid_), HasSubstr(", stopped by a signal)"));
  kill(pid_, SIGKILL);
  AwaitThatItIs(Doing::kDead);
  EXPECT_THAT(Describe("arm 3", pid_), HasSubstr(", dead)"));
}

}  // namespace
}  // namespace armada
