#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "firmware/can/canopen_sdo.h"
#include "firmware/can/frame_list.h"
#include "firmware/can/joint_drive_config.h"

namespace armada {

/// Configures a CiA 402 drive over SDO for cyclic synchronous torque and reads everything back: one request a
/// tick, the next when the last was answered, the same again when it was not. The drive is to be
/// pre-operational.
class Cia402Setup {
 public:
  enum class Result {
    kRunning,
    kDone,     ///< all written, read back and found equal
    kSilent,   ///< a request was not answered, bring_up_attempts times
    kRefused,  ///< the drive aborted a request, or an object is not what it should be
  };

  explicit Cia402Setup(const JointDriveConfig& joint);

  /// From the first request again.
  void Restart();

  void Tick(int64_t now_ns, FrameList* out);
  void OnReply(const canopen::Sdo& reply);

  Result result() const { return result_; }

  /// True when the drive refused to watch the master's silence, or did not keep what was written for it.
  bool NoWatchdog() const;

  /// What is missing, for people; empty when done.
  std::string Explain() const;

  /// Exchanges of a full configuration.
  size_t size() const { return steps_.size(); }

 private:
  /// One request: a write, or a read whose answer must equal `value` in the bits of `mask`.
  struct Step {
    canopen::Entry entry;
    bool write = false;
    bool optional = false;  ///< nothing is amiss when the drive has no such object
    uint8_t bytes = 4;      ///< of a write
    uint32_t value = 0;
    uint32_t mask = 0;
    const char* source = nullptr;  ///< of a read: where the wanted value comes from when not from us
  };

  void Write(canopen::Entry entry, uint32_t value, bool read_back = true);
  void Require(canopen::Entry entry, uint32_t value, uint32_t mask, const char* source);
  template <class Fields>
  void MapPdo(uint16_t pdo, uint32_t cob_id, uint32_t type, const Fields& fields);
  void DisablePdo(uint16_t pdo, uint32_t cob_id);
  void Refuse(const canopen::Sdo& reply);

  int node_;
  int max_attempts_;
  int64_t timeout_ns_;
  std::vector<Step> steps_;
  std::vector<Step> checks_;  ///< go to the end of `steps_` when it is complete

  Result result_ = Result::kRunning;
  size_t at_ = 0;
  int attempts_ = 0;  ///< to do step `at_`
  int64_t asked_ns_ = 0;
  canopen::Sdo answer_;  ///< the one that was refused
};

}  // namespace armada
