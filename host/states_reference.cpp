#include "host/states_reference.h"

#include <ostream>

#include "firmware/app/config/markdown_cell.h"
#include "firmware/core/supervisor.h"

namespace armada {
namespace {

const char* TorqueIn(ControllerState state) {
  switch (state) {
    case ControllerState::kInit:
      return "none, drives disabled: not all are found and configured";
    case ControllerState::kMonitor:
      return "none, drives disabled; estimator and messages run";
    case ControllerState::kArming:
      return "drives are being enabled; each that is holds its joint";
    case ControllerState::kRun:
      return "the whole law, limited; after an operator's start it takes over from damping and gravity in "
             "`law_ramp_s`";
    case ControllerState::kDegraded:
      return "the law with its parameters as they are; half of K_s and K_x where samples or torques come "
             "late";
    case ControllerState::kHold:
      return "to rest in joint space within `stop_ramp_s`, then the posture is held: K_s and gravity, no "
             "network, no Jacobian";
    case ControllerState::kSafeStop:
      return "`safe_stop_damping` of K_s on the joints' speed, and gravity; until at rest";
    case ControllerState::kFault:
      break;
  }
  return "none: the drives stop in their own way, then are disabled; latched";
}

}  // namespace

void WriteStatesReference(std::ostream& out) {
  out << "# States of an arm's controller\n\n"
         "Written by `armada states > docs/states.md` from the tables that the supervisor runs on\n"
         "(`firmware/core/supervisor.h`, `firmware/core/cause.h`). Times are parameters of\n"
         "`control.supervisor`, see [parameters.md](parameters.md).\n\n"
         "```mermaid\nstateDiagram-v2\n  [*] --> INIT\n";
  for (const Transition& transition : kTransitions) {
    out << "  " << NameOf(transition.from) << " --> " << NameOf(transition.to) << ": "
        << TextOf(transition.trigger) << '\n';
  }
  out << "```\n\n| state | torque |\n|---|---|\n";
  for (int i = 0; i < kControllerStates; ++i) {
    const auto state = static_cast<ControllerState>(i);
    out << "| " << NameOf(state) << " | " << TorqueIn(state) << " |\n";
  }
  out << "\n## Transitions\n\nOf those that are possible in a tick the first is taken.\n\n"
         "| from | when | to |\n|---|---|---|\n";
  for (const Transition& transition : kTransitions) {
    out << "| " << NameOf(transition.from) << " | " << TextOf(transition.trigger) << " | "
        << NameOf(transition.to) << " |\n";
  }
  out << "\n## Causes\n\nThe worst active cause wins. An arm without torque has none but an e-stop.\n\n"
         "| cause | active when | reaction |\n|---|---|---|\n";
  for (const CauseRule& rule : kCauseRules) {
    out << "| " << rule.name << " | " << MarkdownCell(rule.active) << " | " << NameOf(rule.reaction)
        << (rule.halves_gains ? ", half the gains" : "") << " |\n";
  }
  out << "\n## Requests\n\nWhat `armada ctl` may be refused for: ";
  for (int i = 0; i < kRefusals; ++i) {
    out << (i > 0 ? "; " : "") << TextOf(static_cast<Refusal>(i));
  }
  out << ".\n";
}

}  // namespace armada
