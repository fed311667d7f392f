# A network namespace with multicast, for hosts that have no route for it: `armada run` and tests.
add_library(armada_private_network STATIC ${CMAKE_CURRENT_LIST_DIR}/private_network.cpp)
target_link_libraries(armada_private_network PUBLIC armada_options)
