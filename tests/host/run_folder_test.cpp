#include "host/run/run_folder.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "firmware/app/realtime.h"
#include "hil/live_faults.h"
#include "tests/support/temp_dir.h"

namespace armada {
namespace {

namespace fs = std::filesystem;

class RunFolderTest : public testing::Test {
 protected:
  RunFolderTest() : folder_((temp_.path() / "a run's folder").string()) {}

  std::unique_ptr<RunFolder> Take() { return RunFolder::Take(folder_, &in_use_, &error_); }
  bool Has(const char* name) const { return fs::exists(fs::path(folder_) / name); }

  TempDir temp_;
  std::string folder_;
  bool in_use_ = false;
  std::string error_;
};

TEST_F(RunFolderTest, AFolderIsOnesOwnUntilTheObjectEnds) {
  auto first = Take();
  ASSERT_NE(first, nullptr) << error_;
  std::ofstream(folder_ + "/result") << "of the first";
  EXPECT_EQ(Take(), nullptr);
  EXPECT_TRUE(in_use_);
  EXPECT_EQ(error_, folder_ + " is in use by another run (process " + std::to_string(getpid()) +
                        "): wait for its end, or give this one another folder (--out)");
  EXPECT_TRUE(Has("result"));

  first.reset();
  EXPECT_FALSE(Has(RunFolder::kLock));
  EXPECT_TRUE(Has("result"));
  EXPECT_NE(Take(), nullptr) << error_;
}

TEST_F(RunFolderTest, NothingStaysBehindOfAProcessThatIsKilled) {
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  if (child == 0) {
    const auto folder = Take();
    const auto faults = LiveFaults::Create(folder_, LiveFaults::kOfProcesses, &error_);
    const char done = folder != nullptr && faults != nullptr ? 1 : 0;
    [[maybe_unused]] const ssize_t written = write(ready[1], &done, 1);
    pause();
    _exit(1);
  }
  char done = 0;
  ASSERT_EQ(read(ready[0], &done, 1), 1);
  ASSERT_EQ(done, 1);
  ASSERT_TRUE(Has(LiveFaults::kOfProcesses));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);

  // At once: what still cleans up is waited for.
  const auto next = Take();
  ASSERT_NE(next, nullptr) << error_;
  EXPECT_FALSE(Has(LiveFaults::kOfProcesses));
  EXPECT_TRUE(Has(RunFolder::kLock)) << "of the next one";
  close(ready[0]);
  close(ready[1]);
}

TEST_F(RunFolderTest, WhoMovesAFolderTakesItFromItsRun) {
  const auto folder = Take();
  ASSERT_NE(folder, nullptr) << error_;
  EXPECT_TRUE(folder->IsThere());
  fs::rename(folder_, folder_ + " elsewhere");
  EXPECT_FALSE(folder->IsThere());
  const auto next = Take();
  ASSERT_NE(next, nullptr) << error_;
  EXPECT_FALSE(folder->IsThere()) << "another's, of the same path";
  EXPECT_TRUE(next->IsThere());
}

// A shell's cd looks elsewhere first when CDPATH says so, and takes "-" for the folder before.
TEST_F(RunFolderTest, WhatIsRemovedAtTheEndIsNeverInAnotherFolder) {
  const fs::path elsewhere = temp_.path() / "elsewhere";
  const fs::path here = fs::current_path();
  for (const std::string name : {"run", "-"}) {
    fs::create_directories(elsewhere / name);
    std::ofstream(elsewhere / name / RunFolder::kLock) << "of another run";
    fs::create_directories(temp_.path() / "here");
    fs::current_path(temp_.path() / "here");
    setenv("CDPATH", elsewhere.c_str(), 1);
    setenv("OLDPWD", (elsewhere / name).c_str(), 1);
    folder_ = name;
    auto folder = Take();
    unsetenv("CDPATH");
    ASSERT_NE(folder, nullptr) << error_;
    folder.reset();
    EXPECT_TRUE(fs::exists(elsewhere / name / RunFolder::kLock)) << name;
    EXPECT_FALSE(Has(RunFolder::kLock)) << name;
    fs::current_path(here);
  }
}

TEST_F(RunFolderTest, AFolderThatCannotBeMadeIsNotInUse) {
  std::ofstream(temp_.path() / "file") << "no folder";
  folder_ = (temp_.path() / "file" / "run").string();
  EXPECT_EQ(Take(), nullptr);
  EXPECT_FALSE(in_use_);
  EXPECT_NE(error_.find("cannot create " + folder_), std::string::npos) << error_;
}

}  // namespace
}  // namespace armada
