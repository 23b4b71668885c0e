# vkmesh_target(TARGET): what every target of the project is compiled with.
function(vkmesh_target target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wshadow -Wconversion)
  # g++ 12 sees overlaps, overruns and uninitialised values where std::string and std::variant have none, once inlined (its bugs
  # 105329, 105562 and 105651, mended in 13); clang and the sanitizers watch over both.
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(${target} PRIVATE -Wno-restrict -Wno-maybe-uninitialized -Wno-array-bounds
      -Wno-stringop-overflow)
  endif()
  # Exactness (docs/exactness.md), whatever the project around asks for: nothing that changes results, and no fused multiply-add
  # that the source does not spell. The linker would make programs and libraries flush subnormal numbers.
  target_compile_options(${target} PRIVATE -fno-fast-math -fno-unsafe-math-optimizations -fno-associative-math -fno-reciprocal-math
    -fno-finite-math-only -fsigned-zeros -ffp-contract=off)
  target_link_options(${target} PRIVATE -fno-fast-math -fno-unsafe-math-optimizations)
  # Errors become values where exceptions end, so there must be some.
  target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-fexceptions -frtti>)
  if(VKMESH_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(VKMESH_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${VKMESH_SANITIZE} -fno-omit-frame-pointer)
    if(VKMESH_SANITIZE MATCHES address)
      target_compile_definitions(${target} PRIVATE VKMESH_ADDRESS_SANITIZER) # g++ and clang tell it in different ways
    endif()
    if(VKMESH_SANITIZE MATCHES thread)
      target_compile_definitions(${target} PRIVATE VKMESH_THREAD_SANITIZER)
      target_compile_options(${target} PRIVATE
        -fsanitize-ignorelist=${PROJECT_SOURCE_DIR}/cmake/thread_sanitizer_ignored.txt) # clang's alone
    endif()
    if(VKMESH_SANITIZE MATCHES undefined)
      target_compile_options(${target} PRIVATE -fno-sanitize-recover=undefined)
    endif()
    target_link_options(${target} PUBLIC -fsanitize=${VKMESH_SANITIZE})
  endif()
endfunction()

# vkmesh_library(TARGET): what every installed library is, besides: it exports what VKMESH_API marks (base/api.h), and nothing else.
function(vkmesh_library target)
  vkmesh_target(${target})
  string(REPLACE vkmesh_ "" name ${target})
  add_library(vkmesh::${name} ALIAS ${target})
  # Before 1.0 each minor version may change the binary interface.
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name}
    VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
    C_VISIBILITY_PRESET hidden CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  target_include_directories(${target}
    PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:include>)
  get_target_property(type ${target} TYPE)
  if(type STREQUAL SHARED_LIBRARY)
    target_compile_definitions(${target} PUBLIC VKMESH_SHARED)
    if(UNIX AND NOT APPLE) # Instances of the standard library's templates are visible by themselves.
      target_link_options(${target} PRIVATE LINKER:--version-script=${PROJECT_SOURCE_DIR}/cmake/exports.map)
      set_property(TARGET ${target} APPEND PROPERTY LINK_DEPENDS ${PROJECT_SOURCE_DIR}/cmake/exports.map)
    endif()
  endif()
endfunction()

# vkmesh_precompile(TARGET HEADER...): compiles once the headers of others that most C++ files of a library include, and HEADER...
# Not under the thread sanitizer: there each file shows that it includes what it needs.
function(vkmesh_precompile target)
  if(VKMESH_SANITIZE MATCHES thread)
    return()
  endif()
  set(headers algorithm array cmath cstdint cstring filesystem functional limits map memory optional span string string_view
    utility variant vector glm/geometric.hpp glm/vec2.hpp glm/vec3.hpp glm/vec4.hpp tl/expected.hpp ${ARGN})
  list(TRANSFORM headers REPLACE "(.+)" "$<$<COMPILE_LANGUAGE:CXX>:<\\1$<ANGLE-R>>")
  target_precompile_headers(${target} PRIVATE ${headers})
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(${target} PRIVATE -Wno-stringop-overread) # as above, and of strings in precompiled headers alone
  endif()
endfunction()
