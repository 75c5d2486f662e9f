# Files of tests and of kernels, several of which are compiled as one: reading the headers is half of what one takes. Each keeps its
# names to itself, by a namespace around its unnamed one, so that helpers of different files may have one name.

# fulcrum_units(TARGET SOURCES): with FULCRUM_UNITY, puts units in the place of those files of the list SOURCES that take part: all of
# such a file is within one unnamed namespace.
function(fulcrum_units target sources_variable)
  if(NOT FULCRUM_UNITY)
    return()
  endif()
  set(alone "")
  set(units "")
  set(batch "")
  set(bytes 0)
  foreach(source IN LISTS ${sources_variable})
    file(READ ${source} text)
    string(LENGTH "${text}" size)
    string(SUBSTRING "${text}" 0 4096 start)
    string(REGEX MATCH "\n}  // namespace\n}  // namespace [a-z_:]+\n$" end "${text}")
    if(NOT end OR NOT start MATCHES "^(//[^\n]*\n|#[^\n]*\n|\n)*namespace [a-z_:]+ {\nnamespace {\n")
      list(APPEND alone ${source})
      continue()
    endif()
    list(APPEND batch ${source})
    math(EXPR bytes "${bytes} + ${size}")
    # About ten files of the middle size: half a minute at most.
    if(bytes GREATER 80000)
      fulcrum_unit(${target} "${batch}" units)
      set(batch "")
      set(bytes 0)
    endif()
  endforeach()
  if(batch)
    fulcrum_unit(${target} "${batch}" units)
  endif()
  if(NOT units)
    return()
  endif()
  # Apart, so that they do not wait for the libraries of the program.
  add_custom_target(${target}Units DEPENDS ${units})
  set(${sources_variable} ${alone} ${units} PARENT_SCOPE)
endfunction()

function(fulcrum_unit target batch units_variable)
  list(LENGTH ${units_variable} number)
  set(unit ${CMAKE_CURRENT_BINARY_DIR}/Units/${target}${number}.cpp)
  add_custom_command(OUTPUT ${unit}
    COMMAND ${CMAKE_COMMAND} "-DSOURCES=${batch}" -DUNIT=${unit} -P ${CMAKE_CURRENT_FUNCTION_LIST_FILE}
    DEPENDS ${batch} ${CMAKE_CURRENT_FUNCTION_LIST_FILE}
    COMMENT "Joining files to ${target}${number}.cpp" VERBATIM)
  set(${units_variable} ${${units_variable}} ${unit} PARENT_SCOPE)
endfunction()

# For the target of these units.
function(fulcrum_add_units target)
  if(TARGET ${target}Units)
    add_dependencies(${target} ${target}Units)
    # A local name may shadow one that another file of the same unit has at namespace scope.
    target_compile_options(${target} PRIVATE -Wno-shadow)
  endif()
endfunction()

# As a script: writes UNIT from SOURCES.
if(CMAKE_SCRIPT_MODE_FILE STREQUAL CMAKE_CURRENT_LIST_FILE)
  set(number 0)
  file(WRITE ${UNIT} "")
  foreach(source IN LISTS SOURCES)
    file(READ ${source} text)
    set(text "#line 1 \"${source}\"\n${text}")
    get_filename_component(folder ${source} DIRECTORY)
    string(REGEX REPLACE "\n#include \"" "\n#include \"${folder}/" text "${text}")
    string(REGEX REPLACE "\nnamespace {\n" "\nnamespace File${number} { namespace {\n" text "${text}")
    string(REGEX REPLACE "\n}  // namespace\n" "\n}}  // namespace\n" text "${text}")
    file(APPEND ${UNIT} "${text}")
    math(EXPR number "${number} + 1")
  endforeach()
endif()
