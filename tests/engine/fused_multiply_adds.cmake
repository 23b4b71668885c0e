# AMD's compiler in Mesa (RADV) makes the machine code of every kernel, for hardware that need not be there, and fuses no
# multiplication with an addition: the shaders' "precise" forbids it. That it would without, is checked as well.
# Mesa's environment variables: RADV_FORCE_FAMILY names the hardware, RADV_DEBUG=shaders prints the code.
#   cmake -DPROGRAM=vkmesh_compile_kernels -DICD=radeon_icd.json -DFAMILY=NAVI21 -P fused_multiply_adds.cmake

# count(RESULT PATTERN TEXT): how often the pattern is found.
function(count result pattern text)
  string(REGEX MATCHALL "${pattern}" found "${text}")
  list(LENGTH found number)
  set(${result} ${number} PARENT_SCOPE)
endfunction()

# machine_code(RESULT [contractible]): what the driver prints of all kernels.
function(machine_code result)
  execute_process(
    COMMAND ${CMAKE_COMMAND} -E env RADV_FORCE_FAMILY=${FAMILY} RADV_DEBUG=shaders,nocache VK_DRIVER_FILES=${ICD} VK_ICD_FILENAMES=${ICD}
      ${PROGRAM} 0 ${ARGN}
    OUTPUT_VARIABLE said ERROR_VARIABLE code RESULT_VARIABLE status)
  string(TOUPPER "${said}" upper)
  if(NOT status EQUAL 0 OR NOT upper MATCHES "\\(RADV ${FAMILY}\\)")
    string(LENGTH "${code}" length)
    math(EXPR from "${length} > 2000 ? ${length} - 2000 : 0")
    string(SUBSTRING "${code}" ${from} -1 last)
    message(FATAL_ERROR "RADV made no kernels for ${FAMILY} (${status}): ${said}${last}")
  endif()
  string(REGEX REPLACE ".*kernels: ([0-9]+).*" "\\1" kernels "${said}")
  count(listings "disasm:" "${code}")
  if(NOT listings EQUAL kernels)
    message(FATAL_ERROR "RADV printed the code of ${listings} kernels of ${kernels}")
  endif()
  set(${result} "${code}" PARENT_SCOPE)
  set(kernels ${kernels} PARENT_SCOPE)
endfunction()

# Instructions begin their lines, other than in the intermediate forms that are printed before: v_fma_f32, v_fmac_f32,
# v_dual_fmaak_f32, v_pk_fma_f16, v_mad_f32, v_mac_legacy_f32 and their kin.
set(fused "\n\tv_[a-z_]*(fma|mad|mac)[a-z_]*_f(16|32|64)")
set(multiplication "\n\tv_[a-z_]*mul_f32")

machine_code(code)
count(multiplications "${multiplication}" "${code}")
count(fused_operations "${fused}" "${code}")
machine_code(contractible_code contractible)
count(fused_when_allowed "${fused}" "${contractible_code}")
message("${FAMILY}: ${kernels} kernels compiled, ${multiplications} multiplications, ${fused_operations} fused with additions; "
  "${fused_when_allowed} without NoContraction")
if(multiplications EQUAL 0 OR fused_when_allowed EQUAL 0)
  message(FATAL_ERROR "the check sees nothing: is this the machine code that it knows?")
endif()
if(NOT fused_operations EQUAL 0)
  message(FATAL_ERROR "${fused_operations} multiplications are fused with additions: a result lacks \"precise\"")
endif()
