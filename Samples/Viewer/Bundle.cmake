# Bundles pages from npm packages (package-lock.json says which), once for all build folders in node_modules beside this file,
# which git ignores; in the build folder where this one is not to be written.
find_program(FULCRUM_NODE NAMES node nodejs)
find_program(FULCRUM_NPM NAMES npm)
mark_as_advanced(FULCRUM_NODE FULCRUM_NPM)
if(NOT FULCRUM_NODE OR NOT FULCRUM_NPM)
  message(FATAL_ERROR
    "The samples' viewer is bundled with node (18 or later) and npm, which are not installed. "
    "Install them (Debian: apt install nodejs npm, or ./fulcrum setup), "
    "or configure with -DFULCRUM_BUILD_SAMPLES=OFF -DFULCRUM_BUILD_BENCHMARKS=OFF.")
endif()

set(FULCRUM_PAGE_FOLDER ${CMAKE_CURRENT_LIST_DIR} CACHE INTERNAL "Where build.mjs and its packages are")
execute_process(COMMAND ${CMAKE_COMMAND} -E make_directory ${FULCRUM_PAGE_FOLDER}/node_modules
  COMMAND ${CMAKE_COMMAND} -E touch ${FULCRUM_PAGE_FOLDER}/node_modules/.written RESULT_VARIABLE failed ERROR_QUIET)
if(failed)
  set(FULCRUM_PAGE_FOLDER ${CMAKE_BINARY_DIR}/pages CACHE INTERNAL "")
  foreach(file build.mjs package.json package-lock.json .npmrc)
    configure_file(${CMAKE_CURRENT_LIST_DIR}/${file} ${FULCRUM_PAGE_FOLDER}/${file} COPYONLY)
  endforeach()
endif()
add_custom_command(
  OUTPUT ${FULCRUM_PAGE_FOLDER}/node_modules/.package-lock.json
  COMMAND ${FULCRUM_NPM} ci
  COMMAND ${CMAKE_COMMAND} -E touch ${FULCRUM_PAGE_FOLDER}/node_modules/.package-lock.json
  DEPENDS ${FULCRUM_PAGE_FOLDER}/package.json ${FULCRUM_PAGE_FOLDER}/package-lock.json ${FULCRUM_PAGE_FOLDER}/.npmrc
  WORKING_DIRECTORY ${FULCRUM_PAGE_FOLDER}
  COMMENT "Installing the pages' npm packages"
  VERBATIM)
add_custom_target(FulcrumPagePackages DEPENDS ${FULCRUM_PAGE_FOLDER}/node_modules/.package-lock.json)

# Bundles the files of a folder into one page; further arguments: other folders whose files they include.
function(fulcrum_bundle_page target folder page)
  list(TRANSFORM ARGN APPEND /* OUTPUT_VARIABLE others)
  file(GLOB sources CONFIGURE_DEPENDS ${folder}/* ${others})
  add_custom_command(
    OUTPUT ${page}
    COMMAND ${FULCRUM_NODE} build.mjs ${folder} ${page}
    DEPENDS ${FULCRUM_PAGE_FOLDER}/build.mjs ${FULCRUM_PAGE_FOLDER}/package-lock.json ${sources} FulcrumPagePackages
    WORKING_DIRECTORY ${FULCRUM_PAGE_FOLDER}
    COMMENT "Bundling the page of ${folder}"
    VERBATIM)
  add_custom_target(${target} DEPENDS ${page})
endfunction()
