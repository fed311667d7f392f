#pragma once

#include <memory>
#include <string>
#include <vector>

#include "firmware/clock/clock.h"
#include "firmware/link/lcm_url.h"

namespace armada {

/// What `--stepped-clock` is, for the help of the programs that take it.
inline constexpr const char* kSteppedClockHelp =
    "FD:SLOT: take the time of a run in stepped time, as `armada run --time stepped` passes it on. "
    "Emulation "
    "only: refused beside a bus of the kernel or a network beyond this host";

/// The clock of a program: the machine's, or that of a run in stepped time, `stepped` being the value of
/// --stepped-clock. Then it returns when it is the program's turn: call it before sockets are opened. A
/// stepped clock is refused with a bus that is not of user space, or a link or bus that reaches beyond this
/// host: there time does not wait. Null, and the reason in `error`, on failure.
std::unique_ptr<Clock> OpenProgramClock(const std::string& stepped, const LcmUrl& url,
                                        const std::vector<std::string>& buses, std::string* error);

}  // namespace armada
