# `cmake --install`: the libraries, their headers, and a package that find_package(vkmesh) finds.
include(CMakePackageConfigHelpers)

set(vkmesh_package ${CMAKE_INSTALL_LIBDIR}/cmake/vkmesh)
set(vkmesh_targets vkmesh_host vkmesh_picture)
install(DIRECTORY host/include/ picture/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
if(VKMESH_VULKAN)
  list(APPEND vkmesh_targets vkmesh_engine)
  install(DIRECTORY engine/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
endif()
install(TARGETS ${vkmesh_targets} EXPORT vkmesh-targets)
install(EXPORT vkmesh-targets NAMESPACE vkmesh:: DESTINATION ${vkmesh_package})
# A static library hands its own needs on.
get_target_property(type vkmesh_host TYPE)
find_package(meshoptimizer CONFIG QUIET)
set(VKMESH_MESHOPTIMIZER OFF)
if(TARGET meshoptimizer::meshoptimizer AND type STREQUAL STATIC_LIBRARY)
  set(VKMESH_MESHOPTIMIZER ON)
endif()
configure_package_config_file(cmake/vkmesh-config.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/vkmesh-config.cmake
  INSTALL_DESTINATION ${vkmesh_package})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/vkmesh-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/vkmesh-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/vkmesh-config-version.cmake
  DESTINATION ${vkmesh_package})
