#pragma once

#include <optional>
#include <vector>

#include "firmware/app/arm_node.h"
#include "hil/scenario.h"

namespace armada {

/// The scenario's operator in virtual time: real commands, each quoting what the board has just sent. A board
/// that is dead when one comes never gets it.
class VirtualOperator {
 public:
  VirtualOperator(const ScenarioConfig& scenario, int64_t fleet_digest,
                  const std::optional<LinkIdentity>& identity);

  /// Hands over what the operator asks of this board between the last tick and the one at `t_s`, the board's
  /// `tick_ns`.
  void Deliver(double t_s, int64_t tick_ns, ArmNode* node);

 private:
  std::vector<OperatorConfig> operations_;
  double period_s_;
  int64_t fleet_digest_;
  std::optional<Sealer> sealer_;
  int64_t sent_ = 0;
};

}  // namespace armada
