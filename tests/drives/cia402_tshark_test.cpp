#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/drives/cia402_bench.h"

namespace armada {
namespace {

void Put32(uint32_t value, bool big_endian, std::ofstream* file) {
  for (int i = 0; i < 4; ++i) file->put(static_cast<char>(value >> 8 * (big_endian ? 3 - i : i)));
}

/// Capture file of classic data frames, link type CAN_SOCKETCAN (tcpdump.org/linktypes.html): identifier
/// big-endian, length, three bytes of padding, eight of data.
void WritePcap(const std::vector<CanFrame>& frames, const std::string& path) {
  constexpr uint32_t kLinkType = 227;
  constexpr uint32_t kPacket = 16;
  std::ofstream file(path, std::ios::binary);
  for (const uint32_t word : {0xA1B2C3D4u, 4u << 16 | 2u, 0u, 0u, 65535u, kLinkType})
    Put32(word, false, &file);
  for (const CanFrame& frame : frames) {
    Put32(static_cast<uint32_t>(frame.stamp_ns / 1'000'000'000), false, &file);
    Put32(static_cast<uint32_t>(frame.stamp_ns % 1'000'000'000 / 1000), false, &file);
    Put32(kPacket, false, &file);
    Put32(kPacket, false, &file);
    Put32(frame.id, true, &file);
    Put32(frame.length, false, &file);
    for (size_t i = 0; i < 8; ++i) file.put(static_cast<char>(frame.data[i]));
  }
}

/// A life of two drives: up, torque, silence that trips them, fault, a person's reset, torque, quick stop.
std::vector<CanFrame> LifeOfTwoDrives() {
  Cia402Bench bench({Cia402Joint(1), Cia402Joint(2)});
  EXPECT_LE(bench.BringUpTicks(100), 100);
  for (int i = 0; i < 30; ++i) bench.Command(i);
  bench.truth[0].velocity_rad_s = 1.0;
  bench.Wait(0.05);
  bench.truth[0].velocity_rad_s = 0.0;
  for (int i = 0; i < 5; ++i) bench.Command(1.0);
  for (const auto& master : bench.masters) master->Reset();
  EXPECT_LE(bench.BringUpTicks(100), 100);
  for (int i = 0; i < 30; ++i) bench.Command(-i);
  FrameList out;
  bench.truth[1].velocity_rad_s = 1.0;
  for (const auto& master : bench.masters) master->QuickStop(&out);
  bench.Exchange(out);
  for (int i = 0; i < 5; ++i) bench.Command(1.0);
  bench.truth[1].velocity_rad_s = 0.0;
  for (int i = 0; i < 5; ++i) bench.Command(1.0);
  return bench.log;
}

// The judge knows CiA 301 and 402 from Wireshark and from its own tables.
TEST(Cia402Tshark, FindsTheServicesAndTheStateMachineInARun) {
  const std::string path = testing::TempDir() + "cia402_" + std::to_string(getpid()) + ".pcap";
  WritePcap(LifeOfTwoDrives(), path);
  const std::string judge =
      std::string(ARMADA_PYTHON) + " " ARMADA_DRIVE_TESTS "/cia402_tshark_judge.py " + path + " 1 2";
  EXPECT_EQ(std::system(judge.c_str()), 0);
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace armada
