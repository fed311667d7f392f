# An object library: an archive's member that replaces malloc would be left out where libc already provides it.
add_library(armada_heap_counter OBJECT ${CMAKE_CURRENT_LIST_DIR}/heap_counter.cpp)
target_link_libraries(armada_heap_counter PUBLIC armada_options)
