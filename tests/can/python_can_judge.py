"""python-can as the judge of the user-space bus. Reads questions from standard input, answers on standard output.

A frame is a line of words: id extended remote error fd bitrate_switch error_state_indicator length hex-or-minus.

  judge.py codec            pack <timestamp> <frame>   the datagram python-can sends, in hex
                            widths <frame>             number of datagrams that mean the same, then each in hex:
                                                       other widths, other key order, further keys
                            unpack <hex>               the frame python-can reads from a datagram
  judge.py bus GROUP PORT   send <frame>               send it
                            receive                    wait for the next frame, print it
"""

import struct
import sys

import msgpack
from can import Message
from can.interfaces.udp_multicast.bus import UdpMulticastBus
from can.interfaces.udp_multicast.utils import pack_message, unpack_message


def to_message(words, timestamp=0.0):
    numbers = [int(word) for word in words[:8]]
    data = None if numbers[2] or words[8] == "-" else bytes.fromhex(words[8])
    return Message(
        timestamp=timestamp,
        arbitration_id=numbers[0],
        is_extended_id=bool(numbers[1]),
        is_remote_frame=bool(numbers[2]),
        is_error_frame=bool(numbers[3]),
        is_fd=bool(numbers[4]),
        bitrate_switch=bool(numbers[5]),
        error_state_indicator=bool(numbers[6]),
        dlc=numbers[7],
        data=data,
        check=True,
    )


def to_words(message):
    flags = (
        message.is_extended_id,
        message.is_remote_frame,
        message.is_error_frame,
        message.is_fd,
        message.bitrate_switch,
        message.error_state_indicator,
    )
    flags_text = " ".join(str(int(flag)) for flag in flags)
    return f"{message.arbitration_id} {flags_text} {message.dlc} {message.data.hex() or '-'}"


def wide_integers(value):
    """Every way MessagePack has to write a number that is not negative."""
    forms = [(0xCC, "B"), (0xCD, "H"), (0xCE, "I"), (0xCF, "Q"), (0xD0, "b"), (0xD1, "h"), (0xD2, "i"), (0xD3, "q")]
    for tag, code in forms:
        try:
            yield struct.pack(">B" + code, tag, value)
        except struct.error:
            pass  # does not fit


def wide_strings(text):
    for tag, code in ((0xD9, "B"), (0xDA, "H"), (0xDB, "I")):
        yield struct.pack(">B" + code, tag, len(text)) + text.encode()


def wide_binaries(data):
    for tag, code in ((0xC4, "B"), (0xC5, "H"), (0xC6, "I")):
        yield struct.pack(">B" + code, tag, len(data)) + data


def join(pairs, header=None):
    header = header or struct.pack("B", 0x80 | len(pairs))
    return header + b"".join(key + value for key, value in pairs)


def widths(message):
    fields = msgpack.unpackb(pack_message(message), raw=False)
    plain = [(msgpack.packb(key), msgpack.packb(value)) for key, value in fields.items()]
    order = list(fields)

    def with_value(name, value):
        at = order.index(name)
        return plain[:at] + [(plain[at][0], value)] + plain[at + 1 :]

    yield join(plain[::-1])
    yield join(plain, struct.pack(">BH", 0xDE, len(plain)))
    yield join(plain, struct.pack(">BI", 0xDF, len(plain)))
    for name in ("arbitration_id", "dlc"):
        for value in wide_integers(fields[name]):
            yield join(with_value(name, value))
    for value in wide_binaries(bytes(fields["data"])):
        yield join(with_value("data", value))
    for at, name in enumerate(order):
        for key in wide_strings(name):
            yield join(plain[:at] + [(key, plain[at][1])] + plain[at + 1 :])
    yield join(with_value("timestamp", msgpack.packb(1.5, use_single_float=True)))
    yield join(with_value("timestamp", msgpack.packb(1700000000)))
    yield join(with_value("timestamp", msgpack.packb(-3)))
    yield join(with_value("channel", msgpack.packb("vcan0")))
    yield join(with_value("channel", msgpack.packb(70000)))
    yield join(with_value("is_fd", msgpack.packb(int(fields["is_fd"]))))
    strange = {"a": [1, {"b": None}, -70000, 1e300], "c": msgpack.ExtType(5, b"12345678"), "d": "x" * 300}
    values = [strange, [[]] * 20, msgpack.ExtType(1, b"x" * 300), -1, -200, 2**63, b"y" * 300, 2.5]
    for value in values:
        yield join(plain[:3] + [(msgpack.packb("is_rx"), msgpack.packb(value))] + plain[3:])


def codec():
    for line in sys.stdin:
        question, *words = line.split()
        if question == "pack":
            yield pack_message(to_message(words[1:], float(words[0]))).hex()
        elif question == "widths":
            datagrams = list(widths(to_message(words)))
            yield len(datagrams)
            yield from (datagram.hex() for datagram in datagrams)
        elif question == "unpack":
            yield to_words(unpack_message(bytes.fromhex(words[0]), check=True))


def bus(group, port):
    channel = UdpMulticastBus(channel=group, port=int(port))
    yield "ready"
    for line in sys.stdin:
        question, *words = line.split()
        if question == "send":
            channel.send(to_message(words))
        elif question == "receive":
            message = channel.recv(timeout=10.0)
            yield to_words(message) if message else "nothing"
    channel.shutdown()


for answer in codec() if sys.argv[1] == "codec" else bus(*sys.argv[2:4]):
    print(answer, flush=True)
