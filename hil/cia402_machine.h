#pragma once

#include <cstdint>

#include "firmware/can/cia402_messages.h"

namespace armada {

/// State machine of an emulated power drive system, CiA 402-2 4.1, 8.4. Transitions are numbered as there.
class Cia402Machine {
 public:
  cia402::PowerState state() const { return state_; }
  uint16_t StatusBits() const;

  bool PowerOn() const;  ///< enabled, or braking
  bool Braking() const;  ///< in quick stop or in fault reaction, and not at rest

  /// Self-test passed: transitions 0 and 1.
  void Boot();

  /// The controlword is `word`. A fault is reset by the rising edge of its bit 7 only.
  void Control(uint16_t word, int64_t quick_stop_option);

  void DisableVoltage();                 ///< transitions 7, 9, 10, 12
  void QuickStop();                      ///< transition 11
  void Fail();                           ///< transitions 13 and, with the power off, 14
  void Rest(int64_t quick_stop_option);  ///< the drive has braked to rest: transition 12 or 14, or none

 private:
  bool Step(uint16_t word, int64_t quick_stop_option);

  cia402::PowerState state_ = cia402::PowerState::kNotReady;
  uint16_t word_ = 0;
  bool at_rest_ = false;
};

}  // namespace armada
