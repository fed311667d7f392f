#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "firmware/can/bus.h"
#include "firmware/can/frame_list.h"
#include "firmware/can/make_drive.h"
#include "hil/emulated_drive.h"

namespace armada {

/// A bus in virtual time with emulated drives on it. Everything sent is kept.
class EmulatedBus final : public CanBus {
 public:
  explicit EmulatedBus(std::span<const JointDriveConfig> joints) {
    for (const JointDriveConfig& joint : joints) drives.push_back(MakeEmulatedDrive(joint, {}, 1));
  }

  BusStatus Send(const CanFrame& frame) override {
    sent.push_back(frame);
    FrameList out;
    for (const auto& drive : drives) drive->OnFrame(t_s_, frame, truth, &out);
    waiting_.insert(waiting_.end(), out.begin(), out.end());
    return BusStatus::kOk;
  }
  BusStatus Flush(int64_t) override { return BusStatus::kOk; }
  void DropWaiting() override {}
  BusStatus Receive(int64_t deadline_ns, CanFrame* frame) override {
    const double deadline_s = 1e-9 * static_cast<double>(deadline_ns);
    while (waiting_.empty()) {
      double next_s = std::numeric_limits<double>::infinity();
      for (const auto& drive : drives) next_s = std::min(next_s, drive->NextEvent(t_s_));
      if (next_s > deadline_s) {
        t_s_ = std::max(t_s_, deadline_s);
        return BusStatus::kTimeout;
      }
      t_s_ = next_s;
      FrameList out;
      for (const auto& drive : drives) drive->OnTime(t_s_, truth, &out);
      waiting_.insert(waiting_.end(), out.begin(), out.end());
    }
    *frame = waiting_.front();
    frame->stamp_ns = std::llround(1e9 * t_s_);
    waiting_.erase(waiting_.begin());
    return BusStatus::kOk;
  }
  int descriptor() const override { return -1; }

  /// Somebody's frame, that the next Receive gives.
  void Inject(const CanFrame& frame) { waiting_.push_back(frame); }

  JointTruth truth{0.7, -1.3};
  std::vector<std::unique_ptr<EmulatedDrive>> drives;
  std::vector<CanFrame> sent;

 private:
  double t_s_ = 0.0;
  std::vector<CanFrame> waiting_;
};

/// Every frame, either way, of a master that brings the joints' drives up and then commands a few torques.
inline std::vector<CanFrame> Conversation(std::span<const JointDriveConfig> joints) {
  EmulatedBus bus(joints);
  const auto masters = MakeDrives(joints);
  std::vector<CanFrame> frames;
  constexpr int kBringUpTicks = 150;
  constexpr int kTorqueTicks = 50;
  for (int tick = 0; tick < kBringUpTicks + kTorqueTicks; ++tick) {
    FrameList out;
    const int64_t now_ns = int64_t{10'000'000} * tick;
    for (const auto& master : masters) {
      if (tick < kBringUpTicks) master->BringUp(now_ns, &out);
      master->RequestSample(now_ns, &out);
      if (tick >= kBringUpTicks) master->CommandTorque(0.5 * (tick % 7) - 1.5, &out);
    }
    for (const CanFrame& frame : out) {
      frames.push_back(frame);
      (void)bus.Send(frame);
    }
    CanFrame frame;
    while (bus.Receive(now_ns + 10'000'000, &frame) == BusStatus::kOk) {
      frames.push_back(frame);
      for (const auto& master : masters) master->OnFrame(frame);
    }
  }
  return frames;
}

}  // namespace armada
