#include "host/spy/spy_command.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <optional>

#include "firmware/app/config/fleet_file.h"
#include "firmware/app/config/toml_parser.h"
#include "firmware/app/exit_codes.h"
#include "firmware/link/lcm_url.h"
#include "hil/scenario_file.h"
#include "host/private_network.h"
#include "host/spy/java_packages.h"
#include "host/spy/type_jar.h"

namespace armada {
namespace {

constexpr const char* kNoRoute =
    "no multicast route here. Make one as root, before the fleet starts:\n"
    "  ip link set lo up multicast on; ip route add 224.0.0.0/4 dev lo\n"
    "A run that started without one has a network of its own; to watch it, start the spy in there:\n"
    "  nsenter --target $(pgrep -o armada-hil) --net armada spy                     (as root)\n"
    "  nsenter --target $(pgrep -o armada-hil) --user --net --preserve-credentials armada spy";

int Fail(const std::string& message, int code = kExitFailed) {
  std::cerr << "armada spy: " << message << '\n';
  return code;
}

// link.lcm_url of a fleet file, or of the fleet that a scenario file names.
std::optional<std::string> FleetUrl(const std::string& path) {
  std::vector<ConfigError> errors;
  std::optional<std::string> url;
  if (const auto root = LoadToml(path, &errors)) {
    if (root->Find("fleet") != nullptr) {
      if (const auto scenario = LoadScenario(path, {}, &errors)) url = scenario->fleet.link.lcm_url;
    } else if (const auto fleet = LoadFleet(path, {}, &errors)) {
      url = fleet->link.lcm_url;
    }
  }
  PrintErrors(errors, std::cerr);
  return url;
}

std::string InstallCommand(const std::vector<std::string>& packages) {
  std::string command = "Debian packages are missing; as root: apt-get install";
  for (const std::string& package : packages) command += ' ' + package;
  return command;
}

// `value` before what the environment has under this name already.
void Prepend(const char* name, const std::string& value, char separator) {
  const char* present = getenv(name);
  const bool alone = present == nullptr || *present == '\0';
  setenv(name, (alone ? value : value + separator + present).c_str(), 1);
}

int BecomeLcmSpy(const std::string& jar, const std::string& url) {
  Prepend("CLASSPATH", jar, ':');
  // Debian's script asks for a garbage collector that newer Java does not have, and would not start without
  // it.
  Prepend("JDK_JAVA_OPTIONS", "-XX:+IgnoreUnrecognizedVMOptions", ' ');
  // The script hands its arguments through a shell unquoted, and a url has a '?'.
  setenv("LCM_DEFAULT_URL", url.c_str(), 1);
  execl(kLcmSpy, kLcmSpy, nullptr);
  return Fail(std::string("cannot start ") + kLcmSpy + ": " + strerror(errno));
}

}  // namespace

int RunSpyCommand(const SpyOptions& options) {
  std::string url = options.lcm_url.empty() ? LcmLinkConfig{}.lcm_url : options.lcm_url;
  if (!options.file.empty()) {
    const auto found = FleetUrl(options.file);
    if (!found) return kExitBadConfig;
    url = *found;
  }
  std::string error;
  if (!ParseLcmUrl(url, &error)) return Fail(error, kExitUsage);

  const auto types = EmbeddedTypes();
  const auto cache = CacheDirectory(&error);
  if (!cache) return Fail(error);
  const std::string jar = TypeJarPath(types, *cache);
  const bool have_jar = std::filesystem::exists(jar);

  auto missing = options.jar_only ? std::vector<std::string>{} : PackagesMissingForSpy();
  if (!have_jar) {
    for (const std::string& package : PackagesMissingForJar()) {
      if (std::find(missing.begin(), missing.end(), package) == missing.end()) missing.push_back(package);
    }
  }
  if (!missing.empty()) return Fail(InstallCommand(missing));
  const char* display = getenv("DISPLAY");
  if (!options.jar_only && (display == nullptr || *display == '\0')) {
    return Fail("no display: DISPLAY is not set. Start it on a desktop, with `ssh -X`, or below `xvfb-run`");
  }
  if (!options.jar_only && !HasMulticastRoute()) return Fail(kNoRoute);

  if (!have_jar && !MakeTypeJar(types, *cache, &error)) return Fail(error);
  if (options.jar_only) {
    std::cout << jar << '\n';
    return kExitOk;
  }
  return BecomeLcmSpy(jar, url);
}

}  // namespace armada
