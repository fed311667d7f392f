#pragma once

#include <optional>
#include <string>

#include "firmware/app/fleet.h"
#include "firmware/link/seal.h"

namespace armada {

/// Where this process keeps what must survive its restarts, unless told otherwise: $STATE_DIRECTORY, as
/// systemd sets it, $XDG_STATE_HOME/armada, ~/.local/state/armada, or /var/lib/armada without a home.
std::string DefaultStateFolder();

/// Who a sender of the fleet is on the link, in a new epoch: one more than the last one in
/// `<state_folder>/epoch_<sender>`, on the disk when this returns, so that no message of an earlier start
/// is newer than one of this. False with *error set. `*identity` stays empty in a fleet without a key.
bool TakeIdentity(const LcmLinkConfig& link, int sender, const std::string& state_folder,
                  std::optional<LinkIdentity>* identity, std::string* error);

/// What to tell people about a fleet without a key; empty when it has one.
std::string WarningOf(const LcmLinkConfig& link);

/// What speaks against a program that is not of a run in stepped time having this identity; empty if nothing.
std::string WhyNotReal(const std::optional<LinkIdentity>& identity, const LcmLinkConfig& link);

}  // namespace armada
