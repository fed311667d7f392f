#include "host/fleet/generate_fleet.h"

#include <algorithm>
#include <cmath>

#include "firmware/app/config/fleet_file.h"
#include "firmware/app/config/value_text.h"
#include "hil/random.h"
#include "host/fleet/toml_text.h"

namespace armada {
namespace {

using Kind = ConfigNode::Kind;

constexpr int kDrawsOfAnArm = 1000;

ConfigNode Value(const std::string& key, Kind kind, std::variant<bool, int64_t, double, std::string> value) {
  ConfigNode node;
  node.kind = kind;
  node.key = key;
  node.value = std::move(value);
  return node;
}
ConfigNode Integer(const std::string& key, int64_t value) {
  return Value(key, Kind::kInteger, value);
}
ConfigNode Real(const std::string& key, double value) {
  return Value(key, Kind::kReal, value);
}
ConfigNode Text(const std::string& key, const std::string& value) {
  return Value(key, Kind::kText, value);
}
ConfigNode Parent(const std::string& key, Kind kind, std::vector<ConfigNode> children) {
  ConfigNode node;
  node.kind = kind;
  node.key = key;
  node.children = std::move(children);
  return node;
}

/// Replaces a value of a table, or adds it.
void Set(ConfigNode* table, ConfigNode value) {
  if (ConfigNode* old = table->Find(value.key)) {
    *old = std::move(value);
  } else {
    table->children.push_back(std::move(value));
  }
}

double Rounded(double value, double per_unit) {
  return std::round(value * per_unit) / per_unit;
}

/// Random numbers of one plan, in the order in which they are asked for.
class Draw {
 public:
  explicit Draw(uint64_t seed) : seed_(seed) {}

  double In(double low, double high) { return Uniform(RandomBits(seed_, kFleetStream, draws_++), low, high); }
  /// 1 .. count.
  int Of(int count) { return 1 + static_cast<int>(In(0.0, count)); }

 private:
  uint64_t seed_;
  uint64_t draws_ = 0;
};

class Generator {
 public:
  Generator(const FleetPlan& plan, LoadedFleet like)
      : plan_(plan), like_(std::move(like)), draw_(plan.seed), graph_(plan.arms) {}

  std::optional<ConfigNode> Fleet(std::vector<ConfigError>* errors) {
    std::vector<ConfigNode> arms;
    for (int id = 1; id <= plan_.arms; ++id) {
      auto arm = Arm(id, errors);
      if (!arm) return std::nullopt;
      arms.push_back(std::move(*arm));
    }
    ConfigNode fleet = like_.tree;
    Set(&fleet, Text("name", plan_.name));
    Set(&fleet, Parent("arm", Kind::kArray, std::move(arms)));
    Set(&fleet, Parent("graph", Kind::kArray, {Graph()}));
    if (fleet.Find("topology_period_s") != nullptr) Set(&fleet, Integer("topology_period_s", 0));
    MakeRoomForItsDepth(&fleet);
    if (!FleetFromTree(fleet, plan_.like, errors)) return std::nullopt;
    return fleet;
  }

 private:
  /// Arm `id`, drawn until it keeps the rules.
  std::optional<ConfigNode> Arm(int id, std::vector<ConfigError>* errors) {
    const std::vector<ConfigNode>& models = like_.tree.Find("arm")->children;
    const auto index = static_cast<size_t>(id - 1);
    std::vector<ConfigError> broken;
    for (int attempt = 0; attempt < kDrawsOfAnArm; ++attempt) {
      ConfigNode arm = models[index % models.size()];
      Set(&arm, Integer("id", id));
      if (index >= models.size())
        Set(&arm, Text("bus", "udp:239.74.163." + std::to_string(10 + id) + ":43113"));
      if (plan_.vary > 0.0) Vary(&arm);
      broken.clear();
      if (FleetFromTree(Alone(arm, id), plan_.like, &broken)) return arm;
    }
    errors->insert(errors->end(), broken.begin(), broken.end());
    return std::nullopt;
  }

  /// Of each link its length, with the centre of mass, its mass and its inertia.
  void Vary(ConfigNode* arm) {
    const auto factor = [&] { return draw_.In(1.0 - plan_.vary, 1.0 + plan_.vary); };
    for (ConfigNode& link : arm->Find("link")->children) {
      const double length = factor();
      const double mass = factor();
      const double inertia = factor();
      for (const auto& [key, share] :
           {std::pair{"m_kg", mass}, {"l_m", length}, {"r_m", length}, {"I_kgm2", inertia}}) {
        const ConfigNode& given = *link.Find(key);
        const double value = given.kind == Kind::kReal ? std::get<double>(given.value)
                                                       : static_cast<double>(std::get<int64_t>(given.value));
        Set(&link, Real(key, Rounded(value * share, 1e3)));
      }
    }
  }

  /// The fleet with this arm only.
  ConfigNode Alone(const ConfigNode& arm, int id) const {
    ConfigNode fleet = like_.tree;
    Set(&fleet, Integer("topology_period_s", 0));
    Set(&fleet, Parent("arm", Kind::kArray, {arm}));
    Set(&fleet, Parent("graph", Kind::kArray, {Topology({Integer("", id)}, {})}));
    return fleet;
  }

  static ConfigNode Topology(std::vector<ConfigNode> pins, std::vector<ConfigNode> edges) {
    std::vector<ConfigNode> parts = {Parent("pins", Kind::kArray, std::move(pins))};
    if (!edges.empty()) parts.push_back(Parent("edges", Kind::kArray, std::move(edges)));
    return Parent("", Kind::kTable, std::move(parts));
  }

  ConfigNode Graph() {
    std::vector<ConfigNode> pins;
    for (int id = 1; id <= plan_.pins; ++id) {
      pins.push_back(Integer("", id));
      graph_.SetPin(id - 1, 1.0);
    }
    if (plan_.graph == GraphShape::kRing && plan_.arms > 1) Hear(1, plan_.arms);
    for (int id = 2; id <= plan_.arms; ++id) {
      if (plan_.graph == GraphShape::kRandom) {
        if (id > plan_.pins) Hear(id, draw_.Of(id - 1));
        Hear(id, draw_.Of(plan_.arms));
      } else {
        Hear(id, plan_.graph == GraphShape::kTree ? id / 2 : id - 1);
      }
    }
    return Topology(std::move(pins), std::move(edges_));
  }

  /// A link, unless there is one already or it would lead from an arm to itself.
  void Hear(int to, int from) {
    if (to == from || graph_.weight(to - 1, from - 1) > 0.0) return;
    std::vector<ConfigNode> edge = {Integer("from", from), Integer("to", to)};
    if (plan_.graph == GraphShape::kRandom) edge.push_back(Real("weight", Rounded(draw_.In(0.5, 2.0), 1e2)));
    edges_.push_back(Parent("", Kind::kTable, std::move(edge)));
    graph_.SetWeight(to - 1, from - 1, 1.0);
  }

  /// Agreement counts past the deepest arm, and news live twice as long as they take to it, or as the file
  /// says.
  void MakeRoomForItsDepth(ConfigNode* fleet) const {
    const auto depth = graph_.DepthFromLeader();
    const int deepest = *std::max_element(depth.begin(), depth.begin() + plan_.arms);
    const EstimatorConfig& given = like_.fleet.estimator;
    const double age_s = Rounded(2.0 * deepest * like_.fleet.timing.period_s, 1e3);
    if (fleet->Find("estimator") == nullptr) Set(fleet, Parent("estimator", Kind::kTable, {}));
    ConfigNode* estimator = fleet->Find("estimator");
    if (given.sync_ticks <= deepest) Set(estimator, Integer("sync_ticks", deepest + 2));
    if (given.age_max_s < age_s) Set(estimator, Real("age_max_s", age_s));
  }

  const FleetPlan& plan_;
  LoadedFleet like_;
  Draw draw_;
  Digraph graph_;
  std::vector<ConfigNode> edges_;
};

const char* Title(GraphShape graph) {
  switch (graph) {
    case GraphShape::kRing:
      return "A ring";
    case GraphShape::kLine:
      return "A line";
    case GraphShape::kTree:
      return "A tree";
    case GraphShape::kRandom:
      break;
  }
  return "A random digraph";
}

}  // namespace

std::optional<std::string> GenerateFleet(const FleetPlan& plan, std::vector<ConfigError>* errors) {
  auto like = LoadFleetTree(plan.like, {}, errors);
  if (!like) return std::nullopt;
  const auto fleet = Generator(plan, std::move(*like)).Fleet(errors);
  if (!fleet) return std::nullopt;
  const std::string varied =
      plan.vary > 0.0 ? ", their links varied by up to " + ValueText(1e2 * plan.vary) + " %" : "";
  return std::string("# ") + Title(plan.graph) + " of " + std::to_string(plan.arms) +
         " arms, made by\n#\n#   " + plan.command + "\n#\n# The arms are those of that file in turn" +
         varied + ".\n# What is left out has the default of docs/parameters.md.\n\n" + TomlText(*fleet);
}

}  // namespace armada
