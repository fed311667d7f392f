"""Prints the frames of a CAN log as python-can reads them, one a line:
microseconds channel id flags length data."""

import sys

from can.io import CanutilsLogReader


def describe(message):
    flags = [
        ("x", message.is_extended_id),
        ("r", message.is_remote_frame),
        ("e", message.is_error_frame),
        ("f", message.is_fd),
        ("b", message.bitrate_switch),
        ("i", message.error_state_indicator),
    ]
    return "%d %s %X %s %d %s" % (
        round(message.timestamp * 1e6),
        message.channel,
        message.arbitration_id,
        "".join(letter for letter, is_set in flags if is_set) or "-",
        message.dlc,
        bytes(message.data).hex() or "-",
    )


for line in CanutilsLogReader(sys.argv[1]):
    print(describe(line))
