#include "hil/can_log.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "tests/hil/command_output.h"
#include "tests/support/limit_malloc.h"

namespace armada {
namespace {

constexpr int64_t kStamp_ns = 1'436'509'052'249'713'999;

std::string Line(const CanFrame& frame, int64_t time_ns = kStamp_ns, const char* channel = "can3") {
  std::array<char, kMaxCanLogLine> line{};
  return {line.data(), FormatCanLogLine(time_ns, channel, frame, line)};
}

CanFrame Data(uint32_t id, std::initializer_list<uint8_t> bytes) {
  CanFrame frame;
  frame.id = id;
  for (const uint8_t byte : bytes) frame.data[frame.length++] = byte;
  return frame;
}

CanFrame Remote(uint32_t id, uint8_t length) {
  CanFrame frame = Data(id, {});
  frame.remote = true;
  frame.length = length;
  return frame;
}

/// Any frame of a node, classic or FD.
CanFrame RandomFrame(std::mt19937_64* random) {
  constexpr std::array<uint8_t, 16> kFdLengths = {0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64};
  const uint64_t bits = (*random)();
  CanFrame frame;
  frame.extended = bits & 1;
  frame.fd = bits & 2;
  frame.remote = !frame.fd && (bits & 4);
  frame.bitrate_switch = frame.fd && (bits & 8);
  frame.error_state_indicator = frame.fd && (bits & 16);
  frame.id = static_cast<uint32_t>(bits >> 32) & (frame.extended ? 0x1FFF'FFFF : 0x7FF);
  frame.length = frame.fd ? kFdLengths[bits >> 8 & 15] : static_cast<uint8_t>((bits >> 8) % 9);
  if (frame.remote) return frame;
  for (size_t i = 0; i < frame.length; ++i) frame.data[i] = static_cast<uint8_t>((*random)());
  return frame;
}

/// As can_log_judge.py describes it.
std::string Describe(int64_t time_ns, const char* channel, const CanFrame& frame) {
  std::string flags;
  if (frame.extended) flags += 'x';
  if (frame.remote) flags += 'r';
  if (frame.fd) flags += 'f';
  if (frame.bitrate_switch) flags += 'b';
  if (frame.error_state_indicator) flags += 'i';
  std::ostringstream text;
  text << time_ns / 1000 << ' ' << channel << ' ' << std::hex << std::uppercase << frame.id << ' '
       << (flags.empty() ? "-" : flags) << ' ' << std::dec << int{frame.length} << ' ';
  if (frame.remote || frame.length == 0) return text.str() + "-";
  constexpr char kHex[] = "0123456789abcdef";
  for (size_t i = 0; i < frame.length; ++i) text << kHex[frame.data[i] >> 4] << kHex[frame.data[i] & 15];
  return text.str();
}

class CanLogFile : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = testing::TempDir() + "can_log_XXXXXX";
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    log_ = CanLog::Create(Path(), "can3", kOffset_ns, &error_);
    ASSERT_NE(log_, nullptr) << error_;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string Path() const { return folder_ / "can_3.log"; }
  std::vector<std::string> Lines() const {
    std::ifstream file(Path());
    std::vector<std::string> lines;
    for (std::string line; std::getline(file, line);) lines.push_back(line);
    return lines;
  }
  /// Frames with ids 0, 1, .. recorded at 1 us, 2 us, ..
  void RecordCounting(uint32_t count) {
    for (uint32_t i = 0; i < count; ++i) log_->Record(1000 * (int64_t{i} + 1), Data(i % 0x800, {1, 2, 3}));
  }

  static constexpr int64_t kOffset_ns = 1'700'000'000'000'000'000;
  std::filesystem::path folder_;
  std::string error_;
  std::unique_ptr<CanLog> log_;
};

TEST(CanLogLine, IsWhatCandumpWrites) {
  EXPECT_EQ(Line(Data(0x044, {0x2A, 0x36, 0x6C, 0x2B, 0xBA})), "(1436509052.249713) can3 044#2A366C2BBA\n");
  EXPECT_EQ(Line(Data(0x7FF, {})), "(1436509052.249713) can3 7FF#\n");
  EXPECT_EQ(Line(Data(1, {0}), 5'000'007'000), "(0000000005.000007) can3 001#00\n");
}

TEST(CanLogLine, AsksWithTheLengthOfARemoteFrame) {
  EXPECT_EQ(Line(Remote(0x029, 8)), "(1436509052.249713) can3 029#R8\n");
  EXPECT_EQ(Line(Remote(0x029, 0)), "(1436509052.249713) can3 029#R\n");
}

TEST(CanLogLine, TellsIdentifiersApartByTheirDigits) {
  CanFrame frame = Data(0x123, {0xAB});
  frame.extended = true;
  EXPECT_EQ(Line(frame), "(1436509052.249713) can3 00000123#AB\n");
  CanFrame bus_off = Data(0x40, {0, 0, 0, 0, 0, 0, 0, 0});
  bus_off.error = true;
  EXPECT_EQ(Line(bus_off), "(1436509052.249713) can3 20000040#0000000000000000\n");
}

TEST(CanLogLine, CarriesTheFlagsOfCanFd) {
  CanFrame frame = Data(0x123, {0x11, 0x22});
  frame.fd = true;
  EXPECT_EQ(Line(frame), "(1436509052.249713) can3 123##01122\n");
  frame.bitrate_switch = true;
  EXPECT_EQ(Line(frame), "(1436509052.249713) can3 123##11122\n");
  frame.error_state_indicator = true;
  EXPECT_EQ(Line(frame), "(1436509052.249713) can3 123##31122\n");
}

TEST(CanLogLine, FitsItsRoomAtItsLongest) {
  CanFrame frame;
  frame.id = 0x1FFF'FFFF;
  frame.extended = frame.fd = true;
  frame.length = 64;
  EXPECT_LT(Line(frame, INT64_MAX, "fifteen_letters").size(), kMaxCanLogLine);
}

TEST_F(CanLogFile, IsReadByPythonCanAsItWasRecorded) {
  std::mt19937_64 random(1);
  std::vector<std::string> expected;
  for (int64_t i = 0; i < 500; ++i) {
    const CanFrame frame = RandomFrame(&random);
    log_->Record(1'000'000 * i, frame);
    expected.push_back(Describe(kOffset_ns + 1'000'000 * i, "can3", frame));
  }
  log_->WriteOut();
  EXPECT_EQ(OutputLines(std::string(ARMADA_PYTHON) + " " + ARMADA_CAN_LOG_JUDGE + " " + Path()), expected);
}

TEST_F(CanLogFile, IsReadByCanUtils) {
  log_->Record(0, Data(0x021, {0, 0, 0, 0, 1}));
  log_->Record(1'500'000, Remote(0x029, 8));
  log_->WriteOut();
  const auto lines = OutputLines("log2asc -I " + Path() + " can3");
  ASSERT_EQ(lines.size(), 5u) << "log2asc (Debian: can-utils) writes three lines ahead of the frames";
  EXPECT_EQ(lines[3], "   0.000000 1  21              Rx   d 5 00 00 00 00 01");
  EXPECT_EQ(lines[4], "   0.001500 1  29              Rx   r 8");
}

TEST_F(CanLogFile, ThatIsNotWrittenOutDropsWhatIsNewAndCountsIt) {
  RecordCounting(CanLog::kCapacity + 10);
  EXPECT_EQ(log_->recorded(), CanLog::kCapacity);
  EXPECT_EQ(log_->dropped(), 10u);
  log_->WriteOut();
  ASSERT_EQ(Lines().size(), CanLog::kCapacity);
  EXPECT_EQ(Lines().back(), "(1700000000.008192) can3 7FF#010203");
  log_->Record(9'000'000, Data(5, {}));
  log_->WriteOut();
  EXPECT_EQ(Lines().back(), "(1700000000.009000) can3 005#");
}

TEST_F(CanLogFile, IsCompleteWhenTheWriterIsGone) {
  constexpr uint32_t kFrames = 5000;
  {
    const CanLogWriter writer({log_.get()});
    RecordCounting(kFrames);
  }
  const std::vector<std::string> lines = Lines();
  ASSERT_EQ(lines.size(), kFrames);
  for (uint32_t i = 0; i < kFrames; ++i) {
    ASSERT_EQ(lines[i] + '\n', Line(Data(i % 0x800, {1, 2, 3}), kOffset_ns + 1000 * (int64_t{i} + 1)));
  }
}

TEST_F(CanLogFile, AllocatesNothingOnItsWay) {
  const LimitMalloc guard;
  RecordCounting(CanLog::kCapacity);
  log_->WriteOut();
}

TEST(CanLog, ThatCannotBeCreatedSaysWhy) {
  std::string error;
  EXPECT_EQ(CanLog::Create("/nowhere/can_3.log", "can3", 0, &error), nullptr);
  EXPECT_EQ(error, "cannot write /nowhere/can_3.log: No such file or directory");
}

TEST(CanLog, OnAFullDiskGoesOnAndRemembersIt) {
  std::string error;
  const auto log = CanLog::Create("/dev/full", "can3", 0, &error);
  ASSERT_NE(log, nullptr) << error;
  for (int round = 0; round < 2; ++round) {
    for (size_t i = 0; i < CanLog::kCapacity; ++i) log->Record(0, Data(1, {}));
    log->WriteOut();
  }
  EXPECT_EQ(log->dropped(), 0u);
  EXPECT_EQ(log->error(), "cannot write /dev/full: No space left on device");
}

}  // namespace
}  // namespace armada
