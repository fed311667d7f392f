#include "host/check/bus_load.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "firmware/can/frame_time.h"
#include "firmware/can/make_drive.h"

namespace armada {
namespace {

constexpr double kMeasured_s = 1.0;

/// One arm's drives and their master, with nothing between them.
class Conversation {
 public:
  Conversation(const ArmEntry& entry, double period_s, const EmulatedDriveConfig& config)
      : can_(entry.can), period_s_(period_s), masters_(MakeDrives(entry.joints)) {
    for (const JointDriveConfig& joint : entry.joints) drives_.push_back(MakeEmulatedDrive(joint, config, 0));
  }

  /// True once every drive is in torque mode.
  bool BringUpTick() {
    for (const auto& master : masters_) master->BringUp(Now_ns(), &to_drives_);
    Exchange();
    EndTick();
    return std::all_of(masters_.begin(), masters_.end(),
                       [](const auto& master) { return master->state() == DriveState::kTorque; });
  }

  void ControlTick() {
    for (const auto& master : masters_) master->RequestSample(Now_ns(), &to_drives_);
    Exchange();
    for (const auto& master : masters_) master->CommandTorque(0.0, &to_drives_);
    Exchange();
    EndTick();
  }

  double time_s() const { return t_s_; }
  double on_wire_s() const { return on_wire_s_; }

 private:
  int64_t Now_ns() const { return std::llround(t_s_ * 1e9); }

  void Exchange() {
    for (const CanFrame& frame : to_drives_) {
      on_wire_s_ += WorstFrameTime_s(frame, can_);
      for (const auto& drive : drives_) drive->OnFrame(t_s_, frame, {}, &to_master_);
    }
    to_drives_.Clear();
    Deliver();
  }

  void EndTick() {
    t_s_ += period_s_;
    for (const auto& drive : drives_) drive->OnTime(t_s_, {}, &to_master_);
    Deliver();
  }

  void Deliver() {
    for (CanFrame frame : to_master_) {
      on_wire_s_ += WorstFrameTime_s(frame, can_);
      frame.stamp_ns = Now_ns();
      for (const auto& master : masters_) master->OnFrame(frame);
    }
    to_master_.Clear();
  }

  CanBusConfig can_;
  double period_s_;
  std::vector<std::unique_ptr<JointDrive>> masters_;
  std::vector<std::unique_ptr<EmulatedDrive>> drives_;
  double t_s_ = 0.0;
  double on_wire_s_ = 0.0;
  FrameList to_drives_;
  FrameList to_master_;
};

}  // namespace

double ArmBusLoad(const ArmEntry& entry, const TimingConfig& timing, const EmulatedDriveConfig& drive) {
  Conversation conversation(entry, timing.period_s, drive);
  while (!conversation.BringUpTick()) {
    if (conversation.time_s() > timing.bring_up_s) return std::numeric_limits<double>::infinity();
  }
  const double begin_s = conversation.time_s();
  const double before_s = conversation.on_wire_s();
  while (conversation.time_s() < begin_s + kMeasured_s) conversation.ControlTick();
  return (conversation.on_wire_s() - before_s) / (conversation.time_s() - begin_s);
}

}  // namespace armada
