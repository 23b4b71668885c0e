# vkmesh_compile_shaders(TARGET SHADER... [DEFINES NAME[=TEXT]...]): compiles each shaders/SHADER.comp (a folder and a name) with glslangValidator into the header
# shaders/NAME.spv.h of the build tree, an array of 32-bit words named k_NAME_spirv, and lets TARGET include it.
# A name with an extension, SHADER.vert, is that file; its header is NAME_vert.spv.h, its array k_NAME_vert_spirv.
find_program(VKMESH_GLSLANG glslangValidator REQUIRED)

function(vkmesh_compile_shaders target)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" DEFINES)
  list(TRANSFORM arg_DEFINES PREPEND -D)
  set(source_dir ${PROJECT_SOURCE_DIR}/shaders)
  set(output_dir ${CMAKE_CURRENT_BINARY_DIR}/shaders)
  set(headers)
  foreach(name IN LISTS arg_UNPARSED_ARGUMENTS)
    get_filename_component(shader ${name} NAME)
    get_filename_component(extension ${name} EXT)
    string(REPLACE "." "_" shader ${shader})
    set(source ${source_dir}/${name})
    if(NOT extension)
      string(APPEND source .comp)
    endif()
    set(header ${output_dir}/${shader}.spv.h)
    add_custom_command(
      OUTPUT ${header}
      COMMAND ${CMAKE_COMMAND} -E make_directory ${output_dir}
      COMMAND ${VKMESH_GLSLANG} --quiet --target-env vulkan1.2 -I${source_dir} -I${PROJECT_SOURCE_DIR}/host/include
              ${arg_DEFINES}
              --depfile ${header}.d --vn k_${shader}_spirv -o ${header} ${source}
      DEPENDS ${source}
      DEPFILE ${header}.d
      COMMENT "Compiling shader ${name}"
      VERBATIM)
    list(APPEND headers ${header})
  endforeach()
  target_sources(${target} PRIVATE ${headers})
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR})
endfunction()
