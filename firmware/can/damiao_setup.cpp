#include "firmware/can/damiao_setup.h"

#include <bit>
#include <cmath>
#include <cstdio>

namespace armada {
namespace {

using damiao::Access;
using damiao::Register;

uint32_t FloatBits(double value) {
  return std::bit_cast<uint32_t>(static_cast<float>(value));
}

std::string Text(uint32_t raw, bool is_float) {
  char text[32];
  if (is_float) {
    std::snprintf(text, sizeof text, "%.9g", static_cast<double>(std::bit_cast<float>(raw)));
  } else {
    std::snprintf(text, sizeof text, "%u", raw);
  }
  return text;
}

}  // namespace

DamiaoSetup::DamiaoSetup(const JointDriveConfig& joint)
    : joint_(joint),
      steps_{{{Register::kPositionMax, "PMAX", FloatBits(joint.mit.position_max_rad), true, false},
              {Register::kVelocityMax, "VMAX", FloatBits(joint.mit.velocity_max_rad_s), true, false},
              {Register::kTorqueMax, "TMAX", FloatBits(joint.mit.torque_max_Nm), true, false},
              {Register::kControlMode, "CTRL_MODE", damiao::kMitMode, false, true},
              {Register::kTimeout, "TIMEOUT",
               static_cast<uint32_t>(std::lround(joint.watchdog_s / damiao::kTimeoutUnit_s)), false, true}}} {
}

void DamiaoSetup::Step(FrameList* out) {
  if (done() || refused_) return;
  const Setting& setting = steps_[step_];
  if (differs_) {
    out->Push(damiao::EncodeRequest(joint_, {Access::kWrite, setting.reg, setting.raw}));
    ++writes_;
    differs_ = false;
  }
  out->Push(damiao::EncodeRequest(joint_, {Access::kRead, setting.reg, 0}));
}

void DamiaoSetup::OnAnswer(const damiao::RegisterAccess& answer) {
  // What a write is answered with is not proof enough: the value is read back on its own.
  if (done() || refused_ || answer.access != Access::kRead || answer.reg != steps_[step_].reg) return;
  const Setting& setting = steps_[step_];
  if (answer.raw == setting.raw) {
    ++step_;
    writes_ = 0;
    return;
  }
  differs_ = true;
  found_ = answer.raw;
  refused_ = !setting.may_write || writes_ == joint_.bring_up_attempts;
}

std::string DamiaoSetup::Explain() const {
  if (done()) return "";
  const Setting& setting = steps_[step_];
  const std::string name =
      std::string(setting.name) + " (register " + std::to_string(static_cast<unsigned>(setting.reg)) + ")";
  if (!refused_) return "no answer yet for " + name;
  return name + " of the drive is " + Text(found_, setting.is_float) + ", " +
         (setting.may_write ? "written was " : "the fleet file says ") + Text(setting.raw, setting.is_float);
}

}  // namespace armada
