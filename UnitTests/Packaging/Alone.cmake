# remove_included_first(HEADERS FOLDER): removes from the list HEADERS, of names as in #include <Fulcrum/...> and files below FOLDER,
# those that another one includes before all else: compiling that one compiles them by themselves.
function(remove_included_first headers_variable folder)
  set(first "")
  foreach(header IN LISTS ${headers_variable})
    file(STRINGS ${folder}/${header} line REGEX "^#include " LIMIT_COUNT 1)
    if(line MATCHES "<Fulcrum/([^>]+)>")
      list(APPEND first ${CMAKE_MATCH_1})
    endif()
  endforeach()
  list(REMOVE_ITEM ${headers_variable} ${first})
  set(${headers_variable} ${${headers_variable}} PARENT_SCOPE)
endfunction()
