#include "host/can/eds.h"

#include <cstdarg>
#include <cstdio>
#include <vector>

#include "firmware/can/cia402_objects.h"

namespace armada {
namespace {

using cia402::Access;
using cia402::Object;

/// Format in the manner of printf; the lines of an EDS are short.
[[gnu::format(printf, 2, 3)]] void Append(std::string* text, const char* format, ...) {
  char line[160];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  *text += line;
}

// CiA 306-1: object codes.
constexpr unsigned kVariable = 0x7;
constexpr unsigned kArray = 0x8;
constexpr unsigned kRecord = 0x9;

bool IsMandatory(unsigned index) {
  return index == 0x1000 || index == 0x1001 || index == 0x1018;
}

unsigned ObjectCodeOf(unsigned index, bool has_subs) {
  if (!has_subs) return kVariable;
  return index == 0x1016 || index == 0x1029 ? kArray : kRecord;
}

/// Name of an object that has sub-indices: their own names tell only what they are within it.
const char* NameOf(unsigned index) {
  switch (index) {
    case 0x1016:
      return "Consumer heartbeat time";
    case 0x1018:
      return "Identity object";
    case 0x1029:
      return "Error behavior";
    case 0x1200:
      return "SDO server parameter";
    case 0x1400:
      return "RPDO 1 communication parameter";
    case 0x1600:
      return "RPDO 1 mapping parameter";
    case 0x1800:
      return "TPDO 1 communication parameter";
    case 0x1801:
      return "TPDO 2 communication parameter";
    case 0x1A00:
      return "TPDO 1 mapping parameter";
    case 0x1A01:
      return "TPDO 2 mapping parameter";
    default:
      return "";
  }
}

const char* AccessOf(const Object& object) {
  switch (object.access) {
    case Access::kConstant:
      return "const";
    case Access::kReadOnly:
      return "ro";
    case Access::kReadWrite:
      break;
  }
  return "rw";
}

void AppendVariable(const Object& object, const JointDriveConfig& joint, std::string* text) {
  Append(text, "ParameterName=%s\nObjectType=0x%X\nDataType=0x%04X\n", object.name, kVariable,
         static_cast<unsigned>(object.type));
  Append(text, "AccessType=%s\n", AccessOf(object));
  if (object.low != object.high) {
    Append(text, "LowLimit=%lld\nHighLimit=%lld\n", static_cast<long long>(object.low),
           static_cast<long long>(object.high));
  }
  if (object.add_node) {
    Append(text, "DefaultValue=$NODEID+0x%X\n", static_cast<unsigned>(object.default_value));
  } else if (cia402::IsSigned(object.type)) {
    Append(text, "DefaultValue=%lld\n",
           static_cast<long long>(cia402::ValueOf(object.type, object.default_value)));
  } else {
    Append(text, "DefaultValue=0x%X\n", static_cast<unsigned>(cia402::DefaultOf(object, joint)));
  }
  Append(text, "PDOMapping=%d\n\n", object.mappable ? 1 : 0);
}

void AppendObjects(const JointDriveConfig& joint, std::string* text) {
  const auto objects = cia402::Objects();
  for (size_t i = 0; i < objects.size();) {
    const unsigned index = objects[i].entry.index;
    size_t end = i;
    while (end < objects.size() && objects[end].entry.index == index) ++end;
    const bool has_subs = end - i > 1;
    Append(text, "[%X]\n", index);
    if (has_subs) {
      Append(text, "ParameterName=%s\nObjectType=0x%X\nSubNumber=%zu\n\n", NameOf(index),
             ObjectCodeOf(index, has_subs), end - i);
    } else {
      AppendVariable(objects[i], joint, text);
    }
    for (; has_subs && i < end; ++i) {
      Append(text, "[%Xsub%X]\n", index, static_cast<unsigned>(objects[i].entry.sub));
      AppendVariable(objects[i], joint, text);
    }
    i = end;
  }
}

void AppendList(const char* section, const std::vector<unsigned>& indices, std::string* text) {
  Append(text, "[%s]\nSupportedObjects=%zu\n", section, indices.size());
  for (size_t i = 0; i < indices.size(); ++i) Append(text, "%zu=0x%04X\n", i + 1, indices[i]);
  *text += '\n';
}

}  // namespace

std::string Eds(const JointDriveConfig& joint) {
  std::vector<unsigned> mandatory;
  std::vector<unsigned> optional;
  for (const Object& object : cia402::Objects()) {
    const unsigned index = object.entry.index;
    std::vector<unsigned>& list = IsMandatory(index) ? mandatory : optional;
    if (list.empty() || list.back() != index) list.push_back(index);
  }
  std::string text =
      "[FileInfo]\n"
      "FileName=cia402.eds\n"
      "FileVersion=1\n"
      "FileRevision=0\n"
      "EDSVersion=4.0\n"
      "Description=CiA 402 servo drive in cyclic synchronous torque, as Armada configures it\n"
      "CreationTime=12:00AM\n"
      "CreationDate=01-01-2026\n"
      "CreatedBy=Armada\n"
      "ModificationTime=12:00AM\n"
      "ModificationDate=01-01-2026\n"
      "ModifiedBy=Armada\n"
      "\n"
      "[DeviceInfo]\n"
      "VendorName=Armada\n"
      "VendorNumber=0\n"
      "ProductName=Emulated CiA 402 drive\n"
      "ProductNumber=0\n"
      "RevisionNumber=0\n"
      "OrderCode=none\n"
      "BaudRate_10=0\n"
      "BaudRate_20=0\n"
      "BaudRate_50=0\n"
      "BaudRate_125=0\n"
      "BaudRate_250=0\n"
      "BaudRate_500=0\n"
      "BaudRate_800=0\n"
      "BaudRate_1000=1\n"
      "SimpleBootUpMaster=0\n"
      "SimpleBootUpSlave=1\n"
      "Granularity=8\n"
      "DynamicChannelsSupported=0\n"
      "GroupMessaging=0\n"
      "NrOfRXPDO=1\n"
      "NrOfTXPDO=2\n"
      "LSS_Supported=0\n"
      "\n"
      "[DummyUsage]\n"
      "Dummy0001=0\n"
      "Dummy0002=0\n"
      "Dummy0003=0\n"
      "Dummy0004=0\n"
      "Dummy0005=0\n"
      "Dummy0006=0\n"
      "Dummy0007=0\n"
      "\n"
      "[Comments]\n"
      "Lines=0\n"
      "\n";
  AppendList("MandatoryObjects", mandatory, &text);
  AppendList("OptionalObjects", optional, &text);
  AppendList("ManufacturerObjects", {}, &text);
  AppendObjects(joint, &text);
  return text;
}

}  // namespace armada
