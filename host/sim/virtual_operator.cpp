#include "host/sim/virtual_operator.h"

#include "hil/same_instant.h"

namespace armada {

VirtualOperator::VirtualOperator(const ScenarioConfig& scenario, int64_t fleet_digest,
                                 const std::optional<LinkIdentity>& identity)
    : operations_(scenario.operations),
      period_s_(scenario.fleet.timing.period_s),
      fleet_digest_(fleet_digest) {
  if (identity) sealer_.emplace(*identity, kOperatorSender);
}

void VirtualOperator::Deliver(double t_s, int64_t tick_ns, ArmNode* node) {
  for (const OperatorConfig& operation : operations_) {
    const double age_s = t_s - operation.at_s;
    const bool now = age_s > -kSameInstant_s && age_s < period_s_ - kSameInstant_s;
    if (!now || (operation.arm != 0 && operation.arm != node->id())) continue;
    command_t command{};
    command.stamp_ns = tick_ns;
    command.sequence = ++sent_;
    command.arm_id = static_cast<int8_t>(node->id());
    command.request = static_cast<int8_t>(operation.request);
    command.heard_stamp_ns = tick_ns;  // of the estimate that the board has sent in this tick
    command.fleet_digest = fleet_digest_;
    MessageBuffer buffer;
    node->OnMessage(
        {kCommandChannel, SealIfKeyed(sealer_, kCommandChannel, Encode(command, &buffer), &buffer), tick_ns});
  }
}

}  // namespace armada
