#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include "firmware/can/make_drive.h"
#include "hil/cia402_emulator.h"

namespace armada {

inline JointDriveConfig Cia402Joint(int node) {
  JointDriveConfig joint;
  joint.profile = DriveProfile::kCia402;
  joint.node_id = node;
  joint.gear_ratio = 10.0;
  joint.direction = -1.0;
  joint.offset_rad = 0.5;
  joint.torque_limit_Nm = 120.0;
  joint.watchdog_s = 0.03;
  joint.cia402.rated_torque_Nm = 10.0;
  return joint;
}

/// Masters and emulated drives of one bus in virtual time, a tick every 10 ms, 0.2 ms a frame. All nodes hear
/// all frames but those that `lost` names. `log` holds what was on the bus.
class Cia402Bench {
 public:
  static constexpr double kPeriod_s = 0.01;
  static constexpr double kFrame_s = 0.0002;

  explicit Cia402Bench(const std::vector<JointDriveConfig>& joints, const EmulatedDriveConfig& config = {})
      : masters(MakeDrives(joints)), truth(joints.size()) {
    for (const JointDriveConfig& joint : joints) {
      drives.push_back(std::make_unique<Cia402Emulator>(joint, config, 1));
    }
    log.reserve(1u << 16);
  }

  void BringUp() {
    FrameList out;
    for (const auto& master : masters) {
      master->BringUp(now_ns(), &out);
    }
    Exchange(out);
  }

  void Command(double tau_Nm) {
    FrameList out;
    for (const auto& master : masters) master->RequestSample(now_ns(), &out);
    for (const auto& master : masters) master->CommandTorque(tau_Nm, &out);
    Exchange(out);
  }

  /// Ticks until all are in torque mode; `limit` + 1 when that does not come.
  int BringUpTicks(int limit) {
    for (int tick = 1; tick <= limit; ++tick) {
      BringUp();
      bool all = true;
      for (const auto& master : masters) all = all && master->state() == DriveState::kTorque;
      if (all) return tick;
    }
    return limit + 1;
  }

  /// Frames of one tick, then the rest of it.
  void Exchange(const FrameList& out) {
    const double end_s = t_s + kPeriod_s;
    most_frames_a_tick = std::max(most_frames_a_tick, out.size());
    for (const CanFrame& frame : out) {
      Wait(kFrame_s);
      Send(frame);
    }
    Wait(end_s - t_s);
  }

  /// Time passes, with all that the drives do by themselves.
  void Wait(double dt_s) {
    const double end_s = t_s + dt_s;
    for (double next_s = NextEvent(); next_s <= end_s; next_s = NextEvent()) {
      t_s = next_s;
      for (size_t i = 0; i < drives.size(); ++i) {
        FrameList answers;
        drives[i]->OnTime(t_s, truth[i], &answers);
        Deliver(answers);
      }
    }
    t_s = std::max(t_s, end_s);
  }

  /// One frame on the bus, from a master or from whomever.
  void Send(const CanFrame& frame) {
    if (lost(frame)) return;
    Note(frame);
    for (size_t i = 0; i < drives.size(); ++i) {
      FrameList answers;
      drives[i]->OnFrame(t_s, frame, truth[i], &answers);
      Deliver(answers);
    }
  }

  /// Frames of drives, to the masters.
  void Deliver(const FrameList& frames) {
    for (CanFrame frame : frames) {
      if (lost(frame)) continue;
      t_s += kFrame_s;
      Note(frame);
      frame.stamp_ns = now_ns();
      for (const auto& master : masters) {
        const Reception reception = master->OnFrame(frame);
        if (reception == Reception::kMalformed) ++malformed;
        if (reception != Reception::kNotMine) break;
      }
    }
  }

  int64_t now_ns() const { return std::llround(1e9 * t_s); }

  std::vector<std::unique_ptr<JointDrive>> masters;
  std::vector<std::unique_ptr<Cia402Emulator>> drives;
  std::vector<JointTruth> truth;
  std::vector<CanFrame> log;  ///< stamped with the bus's time
  std::function<bool(const CanFrame&)> lost = [](const CanFrame&) { return false; };
  double t_s = 0.0;
  size_t most_frames_a_tick = 0;
  int malformed = 0;

 private:
  void Note(CanFrame frame) {
    frame.stamp_ns = now_ns();
    log.push_back(frame);
  }
  double NextEvent() const {
    double next_s = std::numeric_limits<double>::infinity();
    for (const auto& drive : drives) next_s = std::min(next_s, drive->NextEvent(t_s));
    return next_s;
  }
};

}  // namespace armada
