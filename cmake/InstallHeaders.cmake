# Installs the public headers: Fulcrum.h and those of components, what they include, and what those include. Included by the installation, with
# FULCRUM_SOURCE, FULCRUM_COMPONENT_HEADERS and FULCRUM_HEADERS (the folder to put them in, relative to the prefix or absolute).
# Scripts of installations know no policies of the project.
cmake_policy(VERSION 3.22)

set(headers Fulcrum.h ${FULCRUM_COMPONENT_HEADERS})
set(position 0)
list(LENGTH headers count)
while(position LESS count)
  list(GET headers ${position} header)
  file(STRINGS "${FULCRUM_SOURCE}/${header}" includes REGEX "^ *# *include *<Fulcrum/[^>]*>")
  foreach(line IN LISTS includes)
    string(REGEX REPLACE "^ *# *include *<Fulcrum/([^>]*)>.*" "\\1" included "${line}")
    if(NOT included IN_LIST headers)
      list(APPEND headers "${included}")
    endif()
  endforeach()
  math(EXPR position "${position} + 1")
  list(LENGTH headers count)
endwhile()

if(NOT IS_ABSOLUTE "${FULCRUM_HEADERS}")
  set(FULCRUM_HEADERS "${CMAKE_INSTALL_PREFIX}/${FULCRUM_HEADERS}")
endif()
foreach(header IN LISTS headers)
  get_filename_component(folder "${header}" DIRECTORY)
  file(INSTALL "${FULCRUM_SOURCE}/${header}" DESTINATION "${FULCRUM_HEADERS}/${folder}")
endforeach()
