# The engine neither defines nor uses a global symbol of Vulkan's or volk's, so that a program may link its own.
execute_process(COMMAND ${NM} -g ${LIBRARY} OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
if(NOT symbols MATCHES "vkmesh_open_loader")
  message(FATAL_ERROR "${LIBRARY} does not hold what the engine takes from volk")
endif()
string(REGEX MATCHALL "[A-Za-z] (vk[A-Z]|volk)[A-Za-z0-9_]*" foreign "${symbols}")
if(foreign)
  message(FATAL_ERROR "${LIBRARY} has symbols that are Vulkan's or volk's: ${foreign}")
endif()
