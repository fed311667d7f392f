#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <utility>

#include "firmware/can/joint_drive.h"
#include "hil/emulated_drive.h"

namespace armada {

/// A master and an emulated drive on a bus of their own, in virtual time, one tick every 10 ms. Frames take
/// 0.2 ms each; those that `lost` says so do not arrive.
class DriveBench {
 public:
  static constexpr double kPeriod_s = 0.01;
  static constexpr double kFrame_s = 0.0002;

  DriveBench(std::unique_ptr<JointDrive> joint_drive, std::unique_ptr<EmulatedDrive> emulated)
      : master(std::move(joint_drive)), drive(std::move(emulated)) {}

  /// A tick before the first torque.
  void BringUp() {
    sent.Clear();
    master->BringUp(now_ns(), &sent);
    master->RequestSample(now_ns(), &sent);
    Exchange();
  }

  /// A tick after the first torque.
  void Command(double tau_Nm) {
    sent.Clear();
    master->RequestSample(now_ns(), &sent);
    master->CommandTorque(tau_Nm, &sent);
    Exchange();
  }

  /// Ticks until torque mode, `limit` when it is not reached.
  int BringUpTicks(int limit) {
    for (int tick = 1; tick <= limit; ++tick) {
      BringUp();
      if (master->state() == DriveState::kTorque) return tick;
    }
    return limit;
  }

  /// Time passes, with all that the drive does by itself.
  void Wait(double dt_s) {
    const double end_s = t_s + dt_s;
    for (double next_s = drive->NextEvent(t_s); next_s <= end_s; next_s = drive->NextEvent(t_s)) {
      t_s = next_s;
      received.Clear();
      drive->OnTime(t_s, truth, &received);
    }
    t_s = end_s;
  }

  /// One frame to the drive, from whomever.
  void Send(const CanFrame& frame) {
    Wait(kFrame_s);
    received.Clear();
    drive->OnFrame(t_s, frame, truth, &received);
  }

  int64_t now_ns() const { return std::llround(1e9 * t_s); }

  std::unique_ptr<JointDrive> master;
  std::unique_ptr<EmulatedDrive> drive;
  JointTruth truth;
  double t_s = 1.0;
  FrameList sent;      ///< by the master in the last tick
  FrameList received;  ///< from the drive, last
  std::function<bool(const CanFrame&)> lost = [](const CanFrame&) { return false; };

 private:
  void Exchange() {
    const double tick_end_s = t_s + kPeriod_s;
    for (const CanFrame& frame : sent) {
      if (lost(frame)) continue;
      Send(frame);
      const double answered_s = t_s;
      for (const CanFrame& answer : received) {
        if (lost(answer)) continue;
        CanFrame stamped = answer;
        stamped.stamp_ns = std::llround(1e9 * answered_s);
        master->OnFrame(stamped);
      }
    }
    Wait(tick_end_s - t_s);
  }
};

}  // namespace armada
