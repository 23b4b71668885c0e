# Every function that a public header declares bears VKMESH_API, so that shared libraries export it.
file(GLOB_RECURSE headers ${CMAKE_CURRENT_LIST_DIR}/../host/include/*.h ${CMAKE_CURRENT_LIST_DIR}/../engine/include/*.h
  ${CMAKE_CURRENT_LIST_DIR}/../picture/include/*.h)
set(marked 0)
foreach(header IN LISTS headers)
  file(READ ${header} text)
  string(REPLACE ";" "<semicolon>" text "${text}")
  string(REPLACE "[" "<" text "${text}") # brackets would join elements of a list
  string(REPLACE "]" ">" text "${text}")
  string(REPLACE "\n" ";" lines "${text}")
  set(before "")
  foreach(line IN LISTS lines)
    if(line MATCHES "^(<<nodiscard>> )?VKMESH_API ")
      math(EXPR marked "${marked} + 1")
    elseif(line MATCHES "^(<<nodiscard>> |void )" AND NOT before MATCHES "^template"
        AND NOT line MATCHES "^<<nodiscard>> (inline|constexpr|VKMESH_EXACT_INLINE|auto) |^void [A-Za-z]+::")
      message(SEND_ERROR "${header}: a function without VKMESH_API: ${line}")
    endif()
    set(before "${line}")
  endforeach()
endforeach()
if(marked LESS 100)
  message(FATAL_ERROR "only ${marked} functions bear VKMESH_API")
endif()
