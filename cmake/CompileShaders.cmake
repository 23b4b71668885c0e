# vkmesh_compile_shaders(TARGET NAMESPACE FILE... [DEFINES NAME[=TEXT]...]): compiles shaders with glslangValidator and embeds
# them in TARGET, which includes "NAMESPACE.h". That header declares vkmesh::NAMESPACE::NAME for each NAME.comp, NAME_frag for
# each NAME.frag, and kernels(), the table of all .comp. Shaders find includes in shaders/ and beside themselves.
find_program(VKMESH_GLSLANG glslangValidator REQUIRED)

function(vkmesh_compile_shaders target namespace)
  cmake_parse_arguments(PARSE_ARGV 2 arg "" "" DEFINES)
  list(TRANSFORM arg_DEFINES PREPEND -D)
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/${namespace})
  set(headers)
  foreach(text includes declarations definitions table)
    set(${text} "")
  endforeach()
  foreach(source IN LISTS arg_UNPARSED_ARGUMENTS)
    get_filename_component(source ${source} ABSOLUTE)
    get_filename_component(name ${source} NAME)
    string(REGEX REPLACE "\\.comp$" "" name ${name})
    string(REPLACE "." "_" name ${name})
    set(header ${folder}/${name}.spv.h)
    add_custom_command(
      OUTPUT ${header}
      COMMAND ${VKMESH_GLSLANG} --quiet --target-env vulkan1.2 -I${PROJECT_SOURCE_DIR}/shaders
              -I${PROJECT_SOURCE_DIR}/host/include ${arg_DEFINES} --depfile ${header}.d --vn k_${name} -o ${header} ${source}
      DEPENDS ${source}
      DEPFILE ${header}.d
      COMMENT "Compiling shader ${name}"
      VERBATIM)
    list(APPEND headers ${header})
    string(APPEND includes "#include \"${header}\"\n")
    string(APPEND declarations "extern const KernelSource ${name};\n")
    string(APPEND definitions "constexpr KernelSource ${name}{\"${name}\", k_${name}};\n")
    if(source MATCHES "\\.comp$")
      string(APPEND table "${name}, ")
    endif()
  endforeach()
  file(MAKE_DIRECTORY ${folder})
  set(opening "// Made by cmake/CompileShaders.cmake.\n")
  file(CONFIGURE OUTPUT ${folder}.h @ONLY CONTENT "${opening}#pragma once
#include <vkmesh/engine/core/kernel.h>
namespace vkmesh::${namespace} {
${declarations}std::span<const KernelSource> kernels();
}\n")
  file(CONFIGURE OUTPUT ${folder}.cpp @ONLY CONTENT "${opening}#include <cstdint>
#include \"${folder}.h\"
namespace vkmesh::${namespace} {
namespace {
using std::uint32_t;
${includes}}
${definitions}std::span<const KernelSource> kernels() {
  static constexpr KernelSource kAll[] = {${table}};
  return kAll;
}
}\n")
  target_sources(${target} PRIVATE ${folder}.cpp ${headers})
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR})
endfunction()
