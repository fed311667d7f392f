#include "hil/cia402_machine.h"

namespace armada {

using cia402::PowerState;

namespace {

// Bits of the controlword.
constexpr uint16_t kSwitchOnBit = 0x01;
constexpr uint16_t kVoltageBit = 0x02;
constexpr uint16_t kNoQuickStopBit = 0x04;
constexpr uint16_t kEnableBit = 0x08;
constexpr uint16_t kFaultResetBit = 0x80;

/// Option codes of 605Ah from here on end in quick stop active.
constexpr int64_t kStayInQuickStop = 5;

}  // namespace

uint16_t Cia402Machine::StatusBits() const {
  switch (state_) {
    case PowerState::kNotReady:
      return 0x00;
    case PowerState::kSwitchOnDisabled:
      return 0x40;
    case PowerState::kReady:
      return 0x21;
    case PowerState::kSwitchedOn:
      return 0x23;
    case PowerState::kEnabled:
      return 0x27;
    case PowerState::kQuickStop:
      return 0x07;
    case PowerState::kFaultReaction:
      return 0x0F;
    case PowerState::kFault:
      break;
  }
  return 0x08;
}

bool Cia402Machine::PowerOn() const {
  return state_ == PowerState::kEnabled || state_ == PowerState::kQuickStop ||
         state_ == PowerState::kFaultReaction;
}

bool Cia402Machine::Braking() const {
  return (state_ == PowerState::kQuickStop || state_ == PowerState::kFaultReaction) && !at_rest_;
}

void Cia402Machine::Boot() {
  if (state_ == PowerState::kNotReady) state_ = PowerState::kSwitchOnDisabled;
}

void Cia402Machine::Control(uint16_t word, int64_t quick_stop_option) {
  const bool rising = (word & ~word_ & kFaultResetBit) != 0;
  word_ = word;
  if (rising && state_ == PowerState::kFault) state_ = PowerState::kSwitchOnDisabled;  // 15
  if ((word & kFaultResetBit) != 0) return;
  while (Step(word, quick_stop_option)) {
  }
}

bool Cia402Machine::Step(uint16_t word, int64_t quick_stop_option) {
  const bool disable_voltage = (word & kVoltageBit) == 0;
  const bool quick_stop = !disable_voltage && (word & kNoQuickStopBit) == 0;
  const bool runs = !disable_voltage && !quick_stop;
  const bool switch_on = runs && (word & kSwitchOnBit) != 0;
  const bool shut_down = runs && !switch_on;
  const bool enable = switch_on && (word & kEnableBit) != 0;
  const PowerState before = state_;
  switch (state_) {
    case PowerState::kSwitchOnDisabled:
      if (shut_down) state_ = PowerState::kReady;  // 2
      break;
    case PowerState::kReady:
      if (!runs) state_ = PowerState::kSwitchOnDisabled;  // 7
      if (switch_on) state_ = PowerState::kSwitchedOn;    // 3
      break;
    case PowerState::kSwitchedOn:
      if (!runs) state_ = PowerState::kSwitchOnDisabled;  // 10
      if (shut_down) state_ = PowerState::kReady;         // 6
      if (enable) state_ = PowerState::kEnabled;          // 4
      break;
    case PowerState::kEnabled:
      if (quick_stop) QuickStop();
      if (disable_voltage) DisableVoltage();
      if (shut_down) state_ = PowerState::kReady;                  // 8
      if (switch_on && !enable) state_ = PowerState::kSwitchedOn;  // 5
      break;
    case PowerState::kQuickStop:
      if (disable_voltage) DisableVoltage();
      if (enable && quick_stop_option >= kStayInQuickStop) state_ = PowerState::kEnabled;  // 16
      break;
    case PowerState::kNotReady:
    case PowerState::kFaultReaction:
    case PowerState::kFault:
      break;
  }
  return state_ != before;
}

void Cia402Machine::DisableVoltage() {
  const bool may = state_ == PowerState::kReady || state_ == PowerState::kSwitchedOn ||
                   state_ == PowerState::kEnabled || state_ == PowerState::kQuickStop;
  if (may) state_ = PowerState::kSwitchOnDisabled;
}

void Cia402Machine::QuickStop() {
  if (state_ != PowerState::kEnabled) return;
  state_ = PowerState::kQuickStop;
  at_rest_ = false;
}

void Cia402Machine::Fail() {
  if (state_ == PowerState::kFault || state_ == PowerState::kFaultReaction) return;
  at_rest_ = !PowerOn();
  state_ = PowerOn() ? PowerState::kFaultReaction : PowerState::kFault;
}

void Cia402Machine::Rest(int64_t quick_stop_option) {
  at_rest_ = true;
  if (state_ == PowerState::kFaultReaction) {
    state_ = PowerState::kFault;
  } else if (state_ == PowerState::kQuickStop && quick_stop_option < kStayInQuickStop) {
    state_ = PowerState::kSwitchOnDisabled;
  }
}

}  // namespace armada
