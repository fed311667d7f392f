#include "host/campaign/coverage.h"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <ostream>

#include "hil/fault_meaning.h"

namespace armada {

Coverage::Coverage() {
  for (const auto& [kind, name] : EnumNames(FaultKind{})) {
    if (kind != FaultKind::kDrive && MeaningOf(kind).maker != FaultMaker::kRunOnly)
      cells_.push_back({kind, FaultSignal::kNone, FaultWay::kNone});
  }
  for (const auto& [signal, signal_name] : EnumNames(FaultSignal{})) {
    for (const auto& [way, way_name] : EnumNames(FaultWay{})) {
      if (signal == FaultSignal::kNone || way == FaultWay::kNone) continue;
      cells_.push_back({FaultKind::kDrive, signal, way});
    }
  }
}

std::string Coverage::Cell::Name() const {
  if (kind != FaultKind::kDrive) return std::string(NameOf(kind));
  return std::string(NameOf(signal)) + " " + std::string(NameOf(way));
}

void Coverage::Add(const ScenarioConfig& trial, const TrialResult& result) {
  for (size_t i = 0; i < trial.faults.size(); ++i) {
    const FaultConfig& fault = trial.faults[i];
    const auto cell = std::find_if(cells_.begin(), cells_.end(), [&](const Cell& candidate) {
      return candidate.kind == fault.kind && candidate.signal == fault.signal && candidate.way == fault.way;
    });
    ++cell->trials;
    if (i < result.met.size() && result.met[i]) ++cell->met[static_cast<size_t>(*result.met[i])];
  }
  for (size_t i = 0; i < taken_.size(); ++i) taken_[i] += (result.transitions >> i) & 1u;
}

size_t Coverage::cells_tried() const {
  return static_cast<size_t>(
      std::count_if(cells_.begin(), cells_.end(), [](const Cell& cell) { return cell.trials > 0; }));
}

size_t Coverage::transitions_taken() const {
  return taken_.size() - static_cast<size_t>(std::count(taken_.begin(), taken_.end(), 0));
}

void Coverage::Print(std::ostream& out) const {
  char line[256];
  std::snprintf(line, sizeof line, "%-22s %6s  met its arm in", "fault", "trials");
  out << line;
  for (int i = 0; i < kControllerStates; ++i) {
    std::snprintf(line, sizeof line, " %9s", NameOf(static_cast<ControllerState>(i)));
    out << line;
  }
  out << '\n';
  for (const Cell& cell : cells_) {
    std::snprintf(line, sizeof line, "%-22s %6lld                ", cell.Name().c_str(),
                  static_cast<long long>(cell.trials));
    out << line;
    for (const int64_t met : cell.met) {
      std::snprintf(line, sizeof line, " %9lld", static_cast<long long>(met));
      out << line;
    }
    out << '\n';
  }
  std::snprintf(line, sizeof line, "\n%-10s %-38s %-10s %6s\n", "from", "when", "to", "trials");
  out << line;
  for (size_t i = 0; i < kTransitions.size(); ++i) {
    const Transition& transition = kTransitions[i];
    std::snprintf(line, sizeof line, "%-10s %-38s %-10s %6lld\n", NameOf(transition.from),
                  TextOf(transition.trigger), NameOf(transition.to), static_cast<long long>(taken_[i]));
    out << line;
  }
}

void Coverage::WriteTo(nlohmann::ordered_json* json) const {
  auto& cells = (*json)["cells"] = nlohmann::ordered_json::array();
  for (const Cell& cell : cells_) {
    nlohmann::ordered_json met = nlohmann::ordered_json::object();
    for (size_t i = 0; i < cell.met.size(); ++i) met[NameOf(static_cast<ControllerState>(i))] = cell.met[i];
    cells.push_back({{"fault", cell.Name()}, {"trials", cell.trials}, {"met", met}});
  }
  auto& transitions = (*json)["transitions"] = nlohmann::ordered_json::array();
  for (size_t i = 0; i < kTransitions.size(); ++i) {
    transitions.push_back({{"from", NameOf(kTransitions[i].from)},
                           {"when", TextOf(kTransitions[i].trigger)},
                           {"to", NameOf(kTransitions[i].to)},
                           {"trials", taken_[i]}});
  }
}

}  // namespace armada
