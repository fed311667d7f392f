#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>

#include "firmware/can/canopen_messages.h"
#include "firmware/can/frame_list.h"
#include "hil/cia402_dictionary.h"

namespace armada {

/// The CANopen side of an emulated CiA 402 drive (CiA 301): NMT states, SDO server, heartbeat both ways,
/// SYNC, PDOs as mapped, EMCY, timeout of the RPDO. Time as in EmulatedDrive.
///
/// Event-driven TPDOs are sent on entering operational only. There is one RPDO and two TPDOs; no segmented
/// SDO.
class Cia402Node {
 public:
  static constexpr double kBoot_s = 0.02;  ///< from power-up or a reset to the boot-up message

  explicit Cia402Node(const JointDriveConfig& joint);

  void OnFrame(double t_s, const CanFrame& frame, FrameList* out);
  void OnTime(double t_s, FrameList* out);
  double NextEvent() const;

  /// When the connection to the master is lost unless something comes.
  double Deadline() const;

  /// True when the answer to the frame may hold what the drive measures.
  bool Reads(const CanFrame& frame) const;

  /// The connection was lost since the last call: its error code, 0 when the master ended it.
  std::optional<uint16_t> TakeLoss() { return std::exchange(loss_, std::nullopt); }
  /// The whole device was reset since the last call.
  bool TakeReset() { return std::exchange(reset_, false); }

  /// Sent where the NMT state allows it; the error register keeps the error in any case.
  void SendEmergency(const canopen::Emergency& emergency, FrameList* out);

  bool Booting() const { return booting_; }
  bool Operational() const { return !booting_ && state_ == canopen::NmtState::kOperational; }
  Cia402Dictionary& objects() { return objects_; }
  const Cia402Dictionary& objects() const { return objects_; }

 private:
  void OnCommand(double t_s, canopen::NmtCommand command, FrameList* out);
  void Enter(canopen::NmtState state, FrameList* out);
  void Reset(double t_s, uint16_t last_object);
  void OnSync(FrameList* out);
  void OnRequest(double t_s, const canopen::Sdo& request, FrameList* out);
  void OnRpdo(double t_s, const CanFrame& frame, FrameList* out);
  void Receive(const CanFrame& frame);
  void Transmit(uint16_t pdo, FrameList* out) const;
  uint32_t LengthOf(uint16_t pdo) const;
  void Lose(uint16_t error_code);

  int node_;
  Cia402Dictionary objects_;
  bool booting_ = true;
  canopen::NmtState state_ = canopen::NmtState::kPreOperational;  ///< once it has booted
  double boot_s_ = kBoot_s;
  double heartbeat_s_;      ///< next
  double rpdo_deadline_s_;  ///< these two: infinity while not watched
  double heartbeat_deadline_s_;
  std::array<uint32_t, 2> syncs_{};     ///< heard since TPDO 1, 2 were sent
  std::optional<CanFrame> to_receive_;  ///< RPDO that waits for SYNC
  std::optional<uint16_t> loss_;
  bool reset_ = false;
};

}  // namespace armada
