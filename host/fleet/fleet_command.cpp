#include "host/fleet/fleet_command.h"

#include <iostream>
#include <map>
#include <memory>

#include "firmware/app/command_line.h"
#include "firmware/app/config/value_text.h"
#include "firmware/app/exit_codes.h"
#include "firmware/core/types.h"
#include "host/fleet/generate_fleet.h"

namespace armada {
namespace {

const std::map<std::string, GraphShape> kShapes = {{"ring", GraphShape::kRing},
                                                   {"line", GraphShape::kLine},
                                                   {"tree", GraphShape::kTree},
                                                   {"random", GraphShape::kRandom}};

std::vector<std::string> ShapeNames() {
  std::vector<std::string> names;
  for (const auto& [name, shape] : kShapes) names.push_back(name);
  return names;
}

struct FleetOptions {
  std::string shape;
  FleetPlan plan;
};

int Run(FleetOptions options) {
  FleetPlan& plan = options.plan;
  if (plan.pins > plan.arms) {
    std::cerr << "armada fleet: --pins " << plan.pins << ": there are " << plan.arms << " arms\n";
    return kExitUsage;
  }
  plan.graph = kShapes.at(options.shape);
  if (plan.name.empty()) plan.name = options.shape + "_" + std::to_string(plan.arms);
  plan.command = "armada fleet " + options.shape + " " + plan.like + " --name " + plan.name + " --arms " +
                 std::to_string(plan.arms) + " --pins " + std::to_string(plan.pins);
  if (plan.vary > 0.0) plan.command += " --vary " + ValueText(plan.vary);
  plan.command += " --seed " + std::to_string(plan.seed);

  std::vector<ConfigError> errors;
  const auto text = GenerateFleet(plan, &errors);
  if (!text) {
    PrintErrors(errors, std::cerr);
    return kExitBadConfig;
  }
  std::cout << *text;
  return kExitOk;
}

}  // namespace

void AddFleetCommand(Command* app, int* code) {
  auto options = std::make_shared<FleetOptions>();
  FleetPlan& plan = options->plan;
  Command* command =
      app->add_subcommand("fleet", "print a fleet file: a ring, line, tree or random digraph of arms");
  command->add_option("SHAPE", options->shape, "ring, line, tree, random")->required()->one_of(ShapeNames());
  command->add_option("LIKE", plan.like, "fleet file: its arms in turn, and all else")->required();
  command->add_option("--arms", plan.arms, "number of arms")->range(1, kMaxArms)->capture_default_str();
  command->add_option("--pins", plan.pins, "the first so many arms hear the leader")
      ->range(1, kMaxArms)
      ->capture_default_str();
  command
      ->add_option("--vary", plan.vary,
                   "vary lengths, masses and inertias of links at random by up to this share")
      ->range(0.0, 0.5)
      ->capture_default_str();
  command->add_option("--seed", plan.seed, "seed of what is random")->capture_default_str();
  command->add_option("--name", plan.name, "name of the fleet; default: SHAPE_<number of arms>");
  command->callback([options, code] { *code = Run(*options); });
}

}  // namespace armada
