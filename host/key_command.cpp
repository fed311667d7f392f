#include "host/key_command.h"

#include <filesystem>
#include <iostream>
#include <memory>
#include <string>

#include "firmware/app/command_line.h"
#include "firmware/app/exit_codes.h"
#include "firmware/link/fleet_key.h"

namespace armada {
namespace {

int MakeKey(const std::string& path) {
  std::string error;
  if (!MakeFleetKey(path, &error)) {
    std::cerr << "armada key new: " << error << '\n';
    return kExitFailed;
  }
  // A relative name in a fleet file is relative to that file, not to where the user is.
  std::cout << path
            << ": a new key, for the owner only. Copy it to every board of the fleet and name it in the "
            << "fleet file:\n\n[link]\nkey_file = \"" << std::filesystem::absolute(path).string() << "\"\n";
  return kExitOk;
}

}  // namespace

void AddKeyCommand(Command* app, int* code) {
  Command* command = app->add_subcommand("key", "the secret that a fleet's messages are sealed with");
  command->require_subcommand(1);
  auto path = std::make_shared<std::string>();
  Command* create = command->add_subcommand("new", "make a file with a new key, mode 0600");
  create->add_option("FILE", *path, "where; never over an existing file")->required();
  create->callback([=] { *code = MakeKey(*path); });
}

}  // namespace armada
