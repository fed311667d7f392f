#pragma once

namespace armada {

/// Exit codes of every Armada program.
enum ExitCode : int {
  kExitOk = 0,
  kExitFailed = 1,         ///< ran, and failed its own criterion; or the world refused (no bus, no multicast)
  kExitUsage = 2,          ///< the command line is wrong
  kExitInterrupted = 130,  ///< what has an end was stopped before it, by Ctrl-C or SIGTERM; as shells have it
  kExitBadConfig = 78,     ///< EX_CONFIG of sysexits.h: every error has been listed
};

}  // namespace armada
