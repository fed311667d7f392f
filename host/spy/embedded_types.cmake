# Makes ${armada_embedded_types}: a source file with the texts of the message types, so that `armada spy`
# works where no source tree is, too.
file(GLOB armada_lcm_files CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/lcmtypes/*.lcm)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${armada_lcm_files})
set(armada_embedded_source "#include \"host/spy/message_types.h\"

namespace armada {

std::vector<MessageType> EmbeddedTypes() {
  return {
")
foreach(lcm_file ${armada_lcm_files})
  get_filename_component(lcm_name ${lcm_file} NAME)
  file(READ ${lcm_file} lcm_text)
  string(APPEND armada_embedded_source "      {\"${lcm_name}\", R\"lcm(${lcm_text})lcm\"},\n")
endforeach()
string(APPEND armada_embedded_source "  };
}

}  // namespace armada
")
set(armada_embedded_types ${CMAKE_CURRENT_BINARY_DIR}/embedded_types.cpp)
file(CONFIGURE OUTPUT ${armada_embedded_types} CONTENT "@armada_embedded_source@" @ONLY)
