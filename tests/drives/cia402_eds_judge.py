"""Checks an EDS file against the rules of CiA 306-1; says what is wrong, exit code 1."""
import configparser
import re
import sys

BITS = {1: 1, 2: 8, 3: 16, 4: 32, 5: 8, 6: 16, 7: 32}
SIGNED = {2, 3, 4}
ACCESS = {"ro", "wo", "rw", "rww", "rwr", "const"}
# Data types that CiA 301 and CiA 402-2 give to these objects.
TYPES = {"1000": 7, "1001": 5, "1017": 6, "1016sub1": 7, "1018sub1": 7, "1400sub1": 7, "1400sub2": 5, "1400sub5": 6,
         "1600sub1": 7, "6007": 3, "603F": 6, "6040": 6, "6041": 6, "605A": 3, "605E": 3, "6060": 2, "6061": 2,
         "6064": 4, "606C": 4, "6071": 3, "6072": 6, "6076": 7, "6077": 3, "6502": 7}

errors = []


def check(condition, text):
    if not condition:
        errors.append(text)


def number(text, node=1):
    if text.upper().startswith("$NODEID+"):
        return node + int(text[8:], 0)
    return int(text, 0)


eds = configparser.RawConfigParser(strict=True)
eds.optionxform = str
with open(sys.argv[1], encoding="ascii") as file:
    eds.read_file(file)

for section in ("FileInfo", "DeviceInfo", "DummyUsage", "Comments", "MandatoryObjects", "OptionalObjects",
                "ManufacturerObjects"):
    check(eds.has_section(section), f"[{section}] is missing")

listed = []
for section, low, high in (("MandatoryObjects", 0x1000, 0x1FFF), ("OptionalObjects", 0x1000, 0xFFFF),
                           ("ManufacturerObjects", 0x2000, 0x5FFF)):
    count = int(eds[section]["SupportedObjects"])
    check(set(eds[section]) == {"SupportedObjects"} | {str(i + 1) for i in range(count)}, f"[{section}]: numbering")
    for i in range(count):
        index = number(eds[section][str(i + 1)])
        check(low <= index <= high, f"[{section}]: {index:04X} does not belong there")
        listed.append(f"{index:X}")
check(len(set(listed)) == len(listed), "an object is listed twice")
for index in ("1000", "1001", "1018"):
    check(index in listed[:3], f"{index} is mandatory")

objects = {s for s in eds.sections() if re.fullmatch(r"[0-9A-F]{4}", s)}
check(objects == set(listed), f"listed and described differ: {objects ^ set(listed)}")
for name in eds.sections():
    match = re.fullmatch(r"([0-9A-F]{4})(?:sub([0-9A-F]+))?", name)
    if not match:
        continue
    entry = eds[name]
    check(0 < len(entry["ParameterName"]) <= 241, f"[{name}] has no name")
    code = number(entry["ObjectType"])
    if code in (8, 9):
        subs = [s for s in eds.sections() if s.startswith(name + "sub")]
        check(int(entry["SubNumber"]) == len(subs), f"[{name}] SubNumber is not {len(subs)}")
        highest = number(eds[name + "sub0"]["DefaultValue"])
        present = max(int(s.split("sub")[1], 16) for s in subs)
        mapping = name.startswith(("16", "1A"))
        check(highest <= present if mapping else highest == present, f"[{name}] highest sub-index")
        continue
    check(code == 7, f"[{name}] object type {code}")
    kind = number(entry["DataType"])
    check(kind in BITS, f"[{name}] data type {kind}")
    check(TYPES.get(name, kind) == kind, f"[{name}] data type {kind}, CiA has {TYPES.get(name)}")
    check(entry["AccessType"] in ACCESS, f"[{name}] access {entry['AccessType']}")
    check(entry["PDOMapping"] in "01", f"[{name}] PDOMapping")
    value = number(entry["DefaultValue"])
    low = -(1 << (BITS[kind] - 1)) if kind in SIGNED else 0
    check(low <= value < low + (1 << BITS[kind]), f"[{name}] default {value} does not fit")
    if "LowLimit" in entry:
        check(number(entry["LowLimit"]) <= value <= number(entry["HighLimit"]), f"[{name}] default out of limits")

# Default mappings name mappable objects of the file, with their lengths, in at most eight bytes.
for pdo in ("1600", "1A00", "1A01"):
    bits = 0
    for sub in range(1, number(eds[pdo + "sub0"]["DefaultValue"]) + 1):
        what = number(eds[f"{pdo}sub{sub:X}"]["DefaultValue"])
        target = eds[f"{what >> 16:X}"]
        check(target["PDOMapping"] == "1", f"{pdo}: {what >> 16:X} is not mappable")
        check(BITS[number(target["DataType"])] == what & 0xFF, f"{pdo}: length of {what >> 16:X}")
        bits += what & 0xFF
    check(bits <= 64, f"{pdo} is too long")
ids = [number(eds[s]["DefaultValue"], 3) & 0x7FF for s in ("1400sub1", "1800sub1", "1801sub1", "1014", "1200sub1")]
check(ids == [0x203, 0x183, 0x283, 0x083, 0x603], f"pre-defined connection set: {ids}")

print("\n".join(errors))
sys.exit(1 if errors else 0)
