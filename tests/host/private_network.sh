#!/usr/bin/env bash
# Runs a command in a network of its own, whose loopback carries multicast.
# usage: private_network.sh COMMAND [ARGUMENT...]
set -eu
network=(unshare --net)
((EUID == 0)) || network+=(--user --map-root-user)
# shellcheck disable=SC2016  # expanded by the inner shell
exec "${network[@]}" sh -c \
  'ip link set lo up multicast on && ip route add 224.0.0.0/4 dev lo && exec "$@"' sh "$@"
